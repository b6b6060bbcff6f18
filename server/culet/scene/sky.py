"""The sky: what is infinitely far away in every direction, before the lamps among the emitters."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from culet.scene import atelier
from culet.scene.fields import Colour, Model
from culet.scene.stone import UploadId


class StudioEnvironment(Model):
    """A uniform ground behind the lamps."""

    kind: Literal["studio"] = "studio"
    ambient: Colour = atelier.AMBIENT


class DarkEnvironment(Model):
    """A vertical blend of two dark blues: the report's."""

    kind: Literal["dark"]


class LightEnvironment(Model):
    """A uniform pale blue: the report's."""

    kind: Literal["light"]


class ConstantEnvironment(Model):
    """The same radiance from everywhere: the white furnace of the tests."""

    kind: Literal["constant"]
    radiance: Colour = (1, 1, 1)


class HalfEnvironment(Model):
    """Radiance from above the horizon, nothing from below."""

    kind: Literal["half"]
    radiance: Colour = (1, 1, 1)


class GradientEnvironment(Model):
    """A vertical blend, linear in the direction's y, from `bottom` to `top`."""

    kind: Literal["gradient"]
    bottom: Colour = (0, 0, 0)
    top: Colour = (1, 1, 1)


class ImageEnvironment(Model):
    """A panorama of all directions: an uploaded picture, or one of the studio's own."""

    kind: Literal["image"]
    image: UploadId = Field(
        "light-box",
        description="light-box, ring-lights, aset or ideal-scope, or the id of an uploaded .exr, .hdr or .png.",
    )
    scale: Annotated[float, Field(ge=0, le=1e6)] = Field(1, description="Factor on its radiance.")
    head_degrees: Annotated[float, Field(ge=1, le=45)] | None = Field(
        None,
        description="Of aset and ideal-scope: half the angle of the cone that the observer's head fills. Without it "
        "15, and 10; other pictures have no head.",
    )
    turn_degrees: Annotated[float, Field(ge=-360, le=360)] = Field(0, description="About the vertical.")


Environment = Annotated[
    ImageEnvironment
    | StudioEnvironment
    | DarkEnvironment
    | LightEnvironment
    | ConstantEnvironment
    | HalfEnvironment
    | GradientEnvironment,
    Field(discriminator="kind"),
]

SKIES_WITHOUT_LAMPS = frozenset({"dark", "light"})
"""The report's skies stay bare: a switch to one hides the lamps, and back shows them again."""

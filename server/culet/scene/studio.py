"""The studio around the stone: its light, the observer's head, a backdrop, and a floor that stones stand on."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from culet.scene import atelier
from culet.scene.fields import Colour, Coordinate, Model, Part
from culet.scene.lamps import MOST_LAMPS, AnyLamp, BoxLamp, Lamp


class StudioEnvironment(Model):
    """Lamps before a uniform ground: small bright ones bring out the fire, wide ones the facets."""

    kind: Literal["studio"] = "studio"
    ambient: Colour = atelier.AMBIENT
    lamps: Annotated[tuple[AnyLamp, ...], Field(max_length=MOST_LAMPS)] = atelier.LAMPS


def round_lamps_of(environment: Model) -> tuple[Lamp, ...]:
    """A studio's round lamps; of another sky none."""
    lamps = environment.lamps if isinstance(environment, StudioEnvironment) else ()
    return tuple(lamp for lamp in lamps if isinstance(lamp, Lamp))


def boxes_of(environment: Model) -> tuple[BoxLamp, ...]:
    """A studio's soft boxes; of another sky none."""
    lamps = environment.lamps if isinstance(environment, StudioEnvironment) else ()
    return tuple(lamp for lamp in lamps if isinstance(lamp, BoxLamp))


class Head(Model):
    """The observer's head around the camera, wherever that goes: it hides the sky from stones alone. Floor and walls
    neither see it nor are shaded by it. The dark arrows of a brilliant are its reflection."""

    half_angle_degrees: Annotated[float, Field(ge=0.1, le=90)] = 12
    radiance: Colour = (0.015, 0.015, 0.015)
    softness: Annotated[float, Field(ge=0.02, le=1)] = Field(0.3, description="Part of the radius over which it fades.")


class NoBackdrop(Model):
    """The camera sees the sky."""

    kind: Literal["none"] = "none"


class PlainBackdrop(Model):
    """One colour behind everything, for the camera alone: lamps are not seen."""

    kind: Literal["plain"]
    colour: Colour = (0.05, 0.05, 0.05)


class GradientBackdrop(Model):
    """A smooth blend from a place in the picture to its edge, for the camera alone: lamps are not seen."""

    kind: Literal["gradient"]
    centre: Colour = (0.16, 0.165, 0.18)
    edge: Colour = (0.012, 0.013, 0.016)
    focus: tuple[Coordinate, Coordinate] = Field(
        (0, 0.15), description="Of the centre: right and up from the picture's middle, in heights of the picture."
    )
    size: tuple[Annotated[float, Field(ge=0.01, le=100)], Annotated[float, Field(ge=0.01, le=100)]] = Field(
        (1, 0.7), description="How far from the focus the edge is, across and up, in heights of the picture."
    )


Backdrop = Annotated[NoBackdrop | PlainBackdrop | GradientBackdrop, Field(discriminator="kind")]


class StudioFloor(Model):
    """A smooth floor without a horizon, on which stones stand: plain, or the backdrop where there is one.

    Stones see its colour. The camera also sees stones softly reflected in it, and below them a contact shadow: the
    shadow under an even sky of an ellipsoid that is spread as the stone is; light that goes through the stone is left
    out of it.
    """

    kind: Literal["studio"]
    colour: Colour = Field(
        (0.05, 0.05, 0.05),
        description="Radiance that stones see; the camera too, unless there is a backdrop.",
    )
    reflectance: Part = Field(0.16, description="Of a stone where it touches the floor.")
    fade: Annotated[float, Field(ge=0.01, le=1e6)] = Field(
        1.1, description="Height in R at which the reflection has faded to 1/e."
    )
    roughness: Part = Field(0.008, description="Largest tilt of the reflecting floor, from sample to sample.")
    shadow: Part = Field(0.9, description="Part of the floor's light that the contact shadow takes.")

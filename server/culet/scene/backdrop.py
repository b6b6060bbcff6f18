"""What the camera sees in place of the sky."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from culet.scene.fields import Colour, Coordinate, Model


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

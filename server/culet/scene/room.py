"""The room about the stones: a floor and three walls, for the renderer and the simulation alike."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from culet.scene.fields import Colour, Model, Part, said

FLOOR_Y = -1.0
"""Height of the floor, R."""
WALL_DISTANCE = 8.0
"""Of the walls from the world's origin, R."""
WALL_NORMALS = ((0.0, 0.0, 1.0), (math.sqrt(0.75), 0.0, 0.5), (-math.sqrt(0.75), 0.0, 0.5))
"""Inward: a hexagon's three far sides."""


class Plane(Model):
    """The floor, or the three walls at distance 8: absent, matte (checkered, lit, shadowed) or a mirror."""

    kind: Literal["none", "matte", "mirror"] = "none"


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


def _form_of_floor(value: object) -> str | None:
    kind = said(value, "kind", "none")
    if kind == "studio":
        return "<studio>"
    return "<matte>" if kind in ("none", "matte", "mirror") else None


Floor = Annotated[
    Annotated[Plane, Tag("<matte>")] | Annotated[StudioFloor, Tag("<studio>")],
    Discriminator(
        _form_of_floor,
        custom_error_type="floor",
        custom_error_context={"discriminator": "'kind'"},
        custom_error_message="Input should be a floor of kind 'none', 'matte', 'mirror' or 'studio'",
    ),
]

"""The room about the stones: a floor and three walls, for the renderer and the simulation alike."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from culet.scene.fields import Colour, Fraction, Model, said

FLOOR_Y = -1.0
"""Height of the floor, R."""
WALL_DISTANCE = 8.0
"""Of the walls from the world's origin, R."""
WALL_NORMALS = ((0.0, 0.0, 1.0), (math.sqrt(0.75), 0.0, 0.5), (-math.sqrt(0.75), 0.0, 0.5))
"""Inward: a hexagon's three far sides."""

MIRROR_REFLECTANCE = 0.8
MIRROR_SHARE = 0.2
"""Of a mirror's own light in what it shows."""
MIRROR_ALBEDOS = 0.05, 0.1
"""Of the odd and even cells of a mirror's checker, of which each is 1 R wide."""

Albedo = tuple[Fraction, Fraction, Fraction]
"""By channel: the part of the light that a matte surface returns."""


class Checker(Model):
    """Square cells that differ from their neighbours, counted from the world's origin."""

    albedo: Albedo = Field((0.6, 0.6, 0.6), description="Of every other cell.")
    cell: Annotated[float, Field(ge=1e-3, le=1e6)] = Field(1, description="Side of a cell, R.")


def _form_of_checker(value: object) -> str | None:
    if value == "off":
        return "<off>"
    return "<checker>" if isinstance(value, dict | Checker) else None


class Plane(Model):
    """The floor, or the three walls at distance 8: absent, matte or a mirror.

    A matte surface is lit by all emitters, and stones throw shadows and caustics onto it. A mirror has a checker of its
    own, and no use for albedo and checker.
    """

    kind: Literal["none", "matte", "mirror"] = "none"
    albedo: Albedo = Field((0.9, 0.9, 0.9), description="Of a matte surface.")
    checker: Annotated[
        Annotated[Literal["off"], Tag("<off>")] | Annotated[Checker, Tag("<checker>")],
        Discriminator(
            _form_of_checker,
            custom_error_type="checker",
            custom_error_message="Input should be 'off' or a checker's `albedo` and `cell`",
        ),
    ] = Field(Checker(), description="Of a matte surface; `off` makes it plain.")

    @property
    def albedos(self) -> tuple[Albedo, Albedo]:
        """Of a matte surface's odd and even cells."""
        return self.albedo, self.albedo if self.checker == "off" else self.checker.albedo


class StudioFloor(Model):
    """A smooth floor without a horizon, on which stones stand: plain, or the backdrop where there is one.

    Stones see its colour. The camera also sees stones softly reflected in it, and below them a contact shadow: the
    shadow under an even sky of an ellipsoid that is spread as the stone is; light that goes through the stone is left
    out of it. Points, and lamps of at most 1 degree, throw shadows and caustics of their own onto it instead: its
    colour is what it shows where all their light and that of the sky arrives.
    """

    kind: Literal["studio"]
    colour: Colour = Field(
        (0.05, 0.05, 0.05),
        description="Radiance that stones see; the camera too, unless there is a backdrop.",
    )
    reflectance: Fraction = Field(0.16, description="Of a stone where it touches the floor.")
    fade: Annotated[float, Field(ge=0.01, le=1e6)] = Field(
        1.1, description="Height in R at which the reflection has faded to 1/e."
    )
    roughness: Fraction = Field(0.008, description="Largest tilt of the reflecting floor, from sample to sample.")
    shadow: Fraction = Field(0.9, description="Part of the floor's light that the contact shadow takes.")


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

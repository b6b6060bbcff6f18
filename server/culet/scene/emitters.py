"""What gives light: lamps in the sky, round, square or a sun, and point lights in the room."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, field_validator

from culet.remembered import remembered
from culet.scene.fields import Colour, Fraction, Model, Vector, said

MOST_LAMPS = 24
"""In the sky: round ones, boxes and suns together."""
MOST_POINTS = 8

SUN_DEGREES = 0.2666
"""Half of the sun's mean apparent diameter of 31'59": its radius of 695,700 km at one astronomical unit."""


class _Lamp(Model):
    """In the sky, infinitely far away. Stones see it, and it lights floor and walls where none of them is before it."""

    direction: Vector = Field(description="Towards it; of any length but 0.")
    softness: Annotated[float, Field(ge=0.02, le=1)] = Field(
        0.25, description="Part of the radius, or of a box's half width and height, over which it fades."
    )

    @field_validator("direction")
    @classmethod
    def _points_somewhere(cls, direction: Vector) -> Vector:
        if not any(direction):
            raise ValueError("a direction of length 0 points nowhere")
        return direction


class RoundLamp(_Lamp):
    """A disc."""

    shape: Literal["round"] = "round"
    radiance: Colour
    half_angle_degrees: Annotated[float, Field(ge=0.1, le=90)]


class BoxLamp(_Lamp):
    """A soft box: a rectangle that faces the stone, upright but for `turn_degrees`."""

    shape: Literal["box"] = "box"
    radiance: Colour
    half_width_degrees: Annotated[float, Field(ge=0.1, le=85)]
    half_height_degrees: Annotated[float, Field(ge=0.1, le=85)]
    turn_degrees: Annotated[float, Field(ge=-360, le=360)] = Field(0, description="About its own axis.")
    fade: Fraction = Field(0, description="Part of the radiance that is lost from the upper edge to the lower.")


class Sun(_Lamp):
    """A disc whose brightness is said by what it does: `colour` is the radiance of a white matte surface that faces it.

    Its irradiance there is pi times that, whatever its size.
    """

    shape: Literal["sun"] = "sun"
    colour: Colour
    half_angle_degrees: Annotated[float, Field(ge=0.1, le=10)] = SUN_DEGREES

    @property
    def disc(self) -> RoundLamp:
        """The same as a round lamp.

        One of radiance 1 has the irradiance 2 pi (x0 - x0^2 / 2 + D ((1 - x1) / 2 + 7 D / 20)), the integral of its
        smoothstep over x = 1 - cosine, times the cosine: full up to x0, 0 from x1, D = x1 - x0.
        """
        x0, x1 = (
            2 * math.sin(math.radians(self.half_angle_degrees * part) / 2) ** 2 for part in (1 - self.softness, 1)
        )
        width = x1 - x0
        # Over pi; the first part is the full disc's, the second the faded rim's.
        irradiance = 2 * (x0 - x0 * x0 / 2 + width * ((1 - x1) / 2 + 7 * width / 20))
        red, green, blue = (component / irradiance for component in self.colour)
        return RoundLamp.model_construct(
            direction=self.direction,
            softness=self.softness,
            radiance=(red, green, blue),
            half_angle_degrees=self.half_angle_degrees,
        )


class PointLight(Model):
    """A point without falloff: a matte surface shows its albedo times `colour` times the cosine to the point, however
    far that is. So the irradiance of what faces the point is pi times its colour, at the stones as everywhere. Stones
    throw shadows and caustics of it, and do not see it.
    """

    shape: Literal["point"] = "point"
    position: Vector
    colour: Colour


def _form(value: object) -> str | None:
    shape = said(value, "shape")
    return f"<{shape}>" if shape in ("round", "box", "sun", "point") else None


Emitter = Annotated[
    Annotated[RoundLamp, Tag("<round>")]
    | Annotated[BoxLamp, Tag("<box>")]
    | Annotated[Sun, Tag("<sun>")]
    | Annotated[PointLight, Tag("<point>")],
    Discriminator(
        _form,
        custom_error_type="emitter",
        custom_error_context={"discriminator": "'shape'"},
        custom_error_message="Input should be an emitter of shape 'round', 'box', 'sun' or 'point'",
    ),
]
AnyEmitter = RoundLamp | BoxLamp | Sun | PointLight


@remembered
def points(emitters: tuple[AnyEmitter, ...]) -> tuple[PointLight, ...]:
    """The point lights among them."""
    return tuple(emitter for emitter in emitters if isinstance(emitter, PointLight))


@remembered
def lamps(emitters: tuple[AnyEmitter, ...]) -> tuple[RoundLamp | BoxLamp | Sun, ...]:
    """Those in the sky."""
    return tuple(emitter for emitter in emitters if not isinstance(emitter, PointLight))


@remembered
def discs(emitters: tuple[AnyEmitter, ...]) -> tuple[RoundLamp, ...]:
    """The round ones in the sky, suns among them."""
    return tuple(
        emitter.disc if isinstance(emitter, Sun) else emitter
        for emitter in emitters
        if isinstance(emitter, RoundLamp | Sun)
    )


@remembered
def boxes(emitters: tuple[AnyEmitter, ...]) -> tuple[BoxLamp, ...]:
    """The soft boxes."""
    return tuple(emitter for emitter in emitters if isinstance(emitter, BoxLamp))


def check_counts(emitters: tuple[AnyEmitter, ...]) -> tuple[AnyEmitter, ...]:
    """The same; ValueError if there are more than the renderer takes."""
    for kind, most, found in (
        ("lamps in the sky (round, box, sun)", MOST_LAMPS, len(lamps(emitters))),
        ("point lights", MOST_POINTS, len(points(emitters))),
    ):
        if found > most:
            raise ValueError(f"expected at most {most} {kind}, got {found}")
    return emitters

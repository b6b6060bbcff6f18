"""The studio's lamps: lights in the sky, infinitely far away, which stones see and which light no floor."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, field_validator

from culet.scene.fields import Colour, Coordinate, Model, Part, Vector

MOST_LAMPS = 24


class _Lamp(Model):
    direction: Vector
    radiance: Colour
    softness: Annotated[float, Field(ge=0.02, le=1)] = Field(
        0.25, description="Part of the radius, or of a box's half width and height, over which it fades."
    )

    @field_validator("direction")
    @classmethod
    def _points_somewhere(cls, direction: Vector) -> Vector:
        if not any(direction):
            raise ValueError("a direction of length 0 points nowhere")
        return direction


class Lamp(_Lamp):
    """A round lamp in the sky, infinitely far away."""

    shape: Literal["round"] = "round"
    half_angle_degrees: Annotated[float, Field(ge=0.1, le=90)]


class BoxLamp(_Lamp):
    """A soft box: a rectangle that faces the stone, upright but for `turn_degrees`, infinitely far away."""

    shape: Literal["box"]
    half_width_degrees: Annotated[float, Field(ge=0.1, le=85)]
    half_height_degrees: Annotated[float, Field(ge=0.1, le=85)]
    turn_degrees: Annotated[float, Field(ge=-360, le=360)] = Field(0, description="About its own axis.")
    fade: Part = Field(0, description="Part of the radiance that is lost from the upper edge to the lower.")


def _shape_of_lamp(value: object) -> str | None:
    shape = value.get("shape", "round") if isinstance(value, dict) else getattr(value, "shape", None)
    return f"<{shape}>" if shape in ("round", "box") else None


AnyLamp = Annotated[
    Annotated[Lamp, Tag("<round>")] | Annotated[BoxLamp, Tag("<box>")],
    Discriminator(
        _shape_of_lamp,
        custom_error_type="lamp",
        custom_error_message="Input should be a lamp of shape 'round' or 'box'",
    ),
]
"""One without a shape is round."""


class StudioEnvironment(Model):
    """Lamps before a uniform ground: small bright ones bring out the fire, wide ones the facets."""

    kind: Literal["studio"] = "studio"
    ambient: Colour = (0.03, 0.035, 0.05)
    lamps: Annotated[tuple[AnyLamp, ...], Field(max_length=MOST_LAMPS)] = (
        Lamp(direction=(-0.6, 1, 0.35), half_angle_degrees=24, radiance=(1.5, 1.45, 1.35)),
        Lamp(direction=(0.9, 0.75, -0.4), half_angle_degrees=16, radiance=(1.1, 1.3, 1.6)),
        Lamp(direction=(0.25, 0.9, 0.9), half_angle_degrees=6, radiance=(8, 8, 8)),
        Lamp(direction=(-0.9, 0.45, -0.9), half_angle_degrees=5, radiance=(9, 8, 7)),
        Lamp(direction=(0.7, 0.3, 1), half_angle_degrees=4, radiance=(10, 10, 11)),
        Lamp(direction=(-0.2, 1, -0.35), half_angle_degrees=5, radiance=(9, 9, 9)),
    )


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
    roughness: Part = Field(0.02, description="Largest tilt of the reflecting floor, from sample to sample.")
    shadow: Part = Field(0.9, description="Part of the floor's light that the contact shadow takes.")

"""The studio's lamps: lights in the sky, infinitely far away, which stones see and which light no floor."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, field_validator

from culet.scene.fields import Colour, Model, Part, Vector

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
        custom_error_context={"discriminator": "'shape'"},
        custom_error_message="Input should be a lamp of shape 'round' or 'box'",
    ),
]
"""One without a shape is round."""

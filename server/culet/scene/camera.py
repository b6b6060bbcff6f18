"""Who looks: the camera, and the observer's head around it."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from culet.scene.fields import Colour, Model, Vector


class Camera(Model):
    """A pinhole, or parallel rays as in the instruments of the trade."""

    kind: Literal["pinhole", "orthographic"] = Field(
        "pinhole",
        description="orthographic: parallel rays, from a plane through the position; one within 2 R of the stone's "
        "centre is moved back.",
    )
    position: Vector = (0, 8.146, 11.032)
    target: Vector = (0, -0.473, 0)
    up: Vector = (0, 1, 0)
    fov_degrees: Annotated[float, Field(ge=1e-3, le=170)] = Field(13.5, description="Vertical field of view (pinhole).")
    height: Annotated[float, Field(ge=1e-6, le=1e9)] = Field(
        3, description="R, of what the picture shows (orthographic)."
    )

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        forward = [t - p for t, p in zip(self.target, self.position, strict=True)]
        length, up = math.hypot(*forward), math.hypot(*self.up)
        if length == 0:
            raise ValueError("position and target are the same point: the camera looks nowhere")
        if up == 0:
            raise ValueError("up has length 0")
        f, u = [c / length for c in forward], [c / up for c in self.up]
        sine = math.hypot(f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0])
        if sine < 1e-6:
            raise ValueError("up is parallel to the line of sight")
        return self


class Head(Model):
    """The observer's head around the camera, wherever that goes: it hides the sky from stones alone. Floor and walls
    neither see it nor are shaded by it. The dark arrows of a brilliant are its reflection."""

    half_angle_degrees: Annotated[float, Field(ge=0.1, le=90)] = 12
    radiance: Colour = (0.015, 0.015, 0.015)
    softness: Annotated[float, Field(ge=0.02, le=1)] = Field(0.3, description="Part of the radius over which it fades.")

"""What the scene's parts are made of: numbers in range, and a base that refuses what it does not know."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

Coordinate = Annotated[float, Field(ge=-1e9, le=1e9)]
LARGEST_COMPONENT = 1e6
"""Radiance."""
Component = Annotated[float, Field(ge=0, le=LARGEST_COMPONENT)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Colour = tuple[Component, Component, Component]


def _normalised(q: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    length = math.sqrt(sum(c * c for c in q))
    if not length > 1e-6:
        raise ValueError("a quaternion of length 0 is no orientation")
    if abs(length - 1) < 1e-12:  # normalising again would change the last bit, and the scene with it
        return q
    w, x, y, z = (c / length for c in q)
    return w, x, y, z


Orientation = Annotated[tuple[Coordinate, Coordinate, Coordinate, Coordinate], AfterValidator(_normalised)]
"""A unit quaternion w, x, y, z, from a stone's own axes to those of the world."""
Pose = tuple[Vector, tuple[float, float, float, float]]
"""Where a stone's centre of mass is (R), and how the stone is turned: a unit quaternion w, x, y, z."""
Fraction = Annotated[float, Field(ge=0, le=1)]


class Model(BaseModel):
    """Immutable; unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def said(value: object, field: str, default: object = None) -> object:
    """What a document, or a model that was made of one, says in a field; `default` where a document says nothing."""
    return value.get(field, default) if isinstance(value, dict) else getattr(value, field, None)

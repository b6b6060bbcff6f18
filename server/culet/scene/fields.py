"""What the scene's parts are made of: numbers in range, and a base that refuses what it does not know."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Coordinate = Annotated[float, Field(ge=-1e9, le=1e9)]
Component = Annotated[float, Field(ge=0, le=1e6)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Colour = tuple[Component, Component, Component]
Part = Annotated[float, Field(ge=0, le=1)]


class Model(BaseModel):
    """Immutable; unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

"""What snapshots are made of: numbers in range, and a base that refuses what it does not know.

Python writes the shortest decimal that reads back as the same double, so nothing is lost on the way.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from culet.errors import InputError
from culet.scene.refusal import scene_error
from culet.simulation.bodies import BodyState
from culet.simulation.rigid_body.state import RigidState

BoundedNumber = Annotated[float, Field(strict=True, ge=-1e30, le=1e30)]
"""No scene reaches 1e30, and the square of what 1e30 leads to is still a double."""
Count = Annotated[int, Field(strict=True, ge=0, le=2**53)]
Time = Annotated[float, Field(strict=True, ge=0, le=1e30)]
"""s."""
Numbers = tuple[BoundedNumber, BoundedNumber, BoundedNumber]


def _unit(q: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    if abs(sum(c * c for c in q) - 1) > 1e-9:  # stepping keeps it to 1e-15
        raise ValueError("expected a unit quaternion")
    return q


Rotation = Annotated[tuple[BoundedNumber, BoundedNumber, BoundedNumber, BoundedNumber], AfterValidator(_unit)]
"""A unit quaternion w, x, y, z, as it came: normalising it would change the last bit."""


class SnapshotRecord(BaseModel):
    """Immutable; unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


AnyRecord = TypeVar("AnyRecord", bound=SnapshotRecord)


def read_record(kind: type[AnyRecord], data: Any) -> AnyRecord:  # noqa: ANN401 - whatever JSON held
    """InputError that names the first field that cannot be used."""
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        found = scene_error(error)
        raise InputError(f"simulation snapshot: {found}", found.field) from error


def plain(state: RigidState | BodyState) -> dict[str, Any]:
    """As JSON's types, field by field: each is a number, or a tuple of them. `asdict`, which copies each number, takes
    ten times as long, and a stone that moves is told of 20 times a second."""
    values = ((each.name, getattr(state, each.name)) for each in fields(state))
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values}

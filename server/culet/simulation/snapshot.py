"""A simulation's state as JSON, and back to the same bits; whatever came from outside is checked.

Python writes the shortest decimal that reads back as the same double, so nothing is lost on the way.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, StrictBool, ValidationError, model_validator

from culet.errors import InputError
from culet.scene.refusal import scene_error
from culet.simulation.state import RigidState

Number = Annotated[float, Field(strict=True, ge=-1e30, le=1e30)]
"""No scene reaches 1e30, and the square of what 1e30 leads to is still a double."""
Count = Annotated[int, Field(strict=True, ge=0, le=2**53)]


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _StateRecord(_Record):
    """A RigidState, field by field."""

    step: Count
    time: Annotated[float, Field(strict=True, ge=0, le=1e30)]
    position: tuple[Number, Number, Number]
    orientation: tuple[Number, Number, Number, Number]
    momentum: tuple[Number, Number, Number]
    angular_momentum: tuple[Number, Number, Number]
    impacts: Count
    asleep: StrictBool
    coarse: Count = 0

    @model_validator(mode="after")
    def _is_a_rotation(self) -> Self:
        if abs(sum(c * c for c in self.orientation) - 1) > 1e-9:  # stepping keeps it to 1e-15
            raise ValueError("orientation must be a unit quaternion")
        return self


class _SnapshotRecord(_Record):
    version: Literal[1]
    state: _StateRecord
    previous: _StateRecord

    @model_validator(mode="after")
    def _follow_each_other(self) -> Self:
        if self.previous.step not in (self.state.step, self.state.step - 1):
            raise ValueError("previous must be the state one step before, or the same")
        return self


def write_snapshot(state: RigidState, previous: RigidState) -> dict[str, Any]:
    """The two states that pictures lie between, as JSON's types."""
    return {"version": 1, "state": _plain(state), "previous": _plain(previous)}


def read_snapshot(data: Any) -> tuple[RigidState, RigidState]:  # noqa: ANN401 - whatever JSON held
    """State and previous state; InputError that names the first field that cannot be used."""
    try:
        record = _SnapshotRecord.model_validate(data)
    except ValidationError as error:
        found = scene_error(error)
        raise InputError(f"simulation snapshot: {found}", found.field) from error
    return RigidState(**record.state.model_dump()), RigidState(**record.previous.model_dump())


def _plain(state: RigidState) -> dict[str, Any]:
    return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(state).items()}

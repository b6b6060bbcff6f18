"""A simulation's state as JSON, and back to the same bits; whatever came from outside is checked."""

from __future__ import annotations

from typing import Any, Literal, Self

from pydantic import StrictBool, model_validator

from culet.simulation.records import Count, Numbers, Rotation, SnapshotRecord, Time, plain, read_record
from culet.simulation.rigid_body.state import RigidState


class _StateRecord(SnapshotRecord):
    """A RigidState, field by field."""

    step: Count
    time: Time
    position: Numbers
    orientation: Rotation
    momentum: Numbers
    angular_momentum: Numbers
    impacts: Count
    asleep: StrictBool
    coarse: Count = 0


class _SnapshotRecord(SnapshotRecord):
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
    return {"version": 1, "state": plain(state), "previous": plain(previous)}


def read_snapshot(data: Any) -> tuple[RigidState, RigidState]:  # noqa: ANN401 - whatever JSON held
    """State and previous state; InputError that names the first field that cannot be used."""
    record = read_record(_SnapshotRecord, data)
    return RigidState(**record.state.model_dump()), RigidState(**record.previous.model_dump())

"""A world's state as JSON, and back to the same bits; whatever came from outside is checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, Self

from pydantic import StrictBool, StrictStr, model_validator

from culet.errors import InputError
from culet.simulation.bodies import BodyState, WorldState
from culet.simulation.records import Count, Numbers, Rotation, SnapshotRecord, Time, plain, read_record


class _BodyRecord(SnapshotRecord):
    """A BodyState, field by field."""

    position: Numbers
    orientation: Rotation
    velocity: Numbers
    spin: Numbers
    asleep: StrictBool
    held: StrictBool


class _WorldRecord(SnapshotRecord):
    version: Literal[2]
    stones: tuple[StrictStr, ...]
    step: Count
    time: Time
    previous: tuple[_BodyRecord, ...]
    previous_step: Count
    previous_time: Time
    at_start: StrictBool
    saved: dict[str, Any] | StrictStr | None

    @model_validator(mode="after")
    def _agree(self) -> Self:
        if len(self.previous) != len(self.stones):
            raise ValueError("previous must have each of the stones")
        if self.previous_step not in (self.step, self.step - 1):
            raise ValueError("previous must be the state one step before, or the same")
        fits = {0: self.saved is None, 1: isinstance(self.saved, dict)}
        if not fits.get(len(self.stones), isinstance(self.saved, str)):
            raise ValueError(f"saved must be what {len(self.stones)} stones have")
        return self


class WorldSnapshot(NamedTuple):
    """What a snapshot says."""

    step: int
    time: float
    previous: WorldState
    at_start: bool
    saved: Any
    """As `Alone.save` or `Together.save` gave it."""


def write_world_snapshot(
    names: Sequence[str], state: WorldState, previous: WorldState, saved: object, *, at_start: bool
) -> dict[str, Any]:
    """The state that is, and the one before, which pictures lie between, as JSON's types."""
    return {
        "version": 2,
        "stones": list(names),
        "step": state.step,
        "time": state.time,
        "previous": [plain(body) for body in previous.bodies],
        "previous_step": previous.step,
        "previous_time": previous.time,
        "at_start": at_start,
        "saved": saved,
    }


def read_world_snapshot(data: Any, names: Sequence[str]) -> WorldSnapshot:  # noqa: ANN401 - whatever JSON held
    """Of a world of these stones in this order; InputError that names the first field that cannot be used."""
    record = read_record(_WorldRecord, data)
    if list(record.stones) != list(names):
        raise InputError(f"simulation snapshot: expected one of the stones {names}; got {record.stones}", "stones")
    bodies = tuple(BodyState(**body.model_dump()) for body in record.previous)
    previous = WorldState(record.previous_step, record.previous_time, bodies)
    return WorldSnapshot(record.step, record.time, previous, record.at_start, record.saved)

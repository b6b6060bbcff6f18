"""Stones that were removed from a session's scene, so that a removal can be taken back."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from culet.errors import InputError
from culet.scene import Scene, StoneSettings
from culet.scene.stone import new_id
from culet.simulation.bodies import BodyState

REMEMBERED = 64
"""Removals of one session that can be taken back, one after the other: each stone takes some 2 KiB."""


@dataclass(frozen=True)
class RemovedStone:
    """A stone as it was when it was removed."""

    place: int
    """Its place in the scene's list of stones."""
    settings: StoneSettings
    state: BodyState | None = None
    """Where it was and how it moved; None of a stone at its start."""


@dataclass(frozen=True)
class Removal:
    """What one event took away."""

    stones: tuple[RemovedStone, ...]
    """In the scene's order."""
    falling: bool = False
    """Time went on for the stones."""


class Removals:
    """The latest of a session, the last one first to be taken back."""

    def __init__(self) -> None:
        """Nothing was removed."""
        self._removals: deque[Removal] = deque(maxlen=REMEMBERED)

    def __len__(self) -> int:
        return len(self._removals)

    def add(self, removal: Removal) -> None:
        """An event took these stones away; if it took none, nothing changes."""
        if removal.stones:
            self._removals.append(removal)

    @property
    def last(self) -> Removal:
        """The removal that can be taken back now; InputError if there is none."""
        if not self._removals:
            raise InputError("expected a removal to take back: no stone was removed, or all are back")
        return self._removals[-1]

    def take_back(self) -> None:
        """The last removal has been taken back."""
        self._removals.pop()

    def clear(self) -> None:
        """Another scene is shown, which these stones were never in."""
        self._removals.clear()

    def meshes(self) -> set[str]:
        """Ids of the meshes that stones need which may come back."""
        stones = (stone.settings for removal in self._removals for stone in removal.stones)
        return {stone.mesh for stone in stones if stone.mesh is not None}


def removal_of(before: Scene, after: Scene, states: Mapping[str, BodyState], *, falling: bool = False) -> Removal:
    """The stones that a change of the scene takes away; `states` are those of before, by the ids of their stones."""
    kept = {stone.id for stone in after.stones}
    stones = tuple(
        RemovedStone(place, stone, states.get(stone.id))
        for place, stone in enumerate(before.stones)
        if stone.id not in kept
    )
    return Removal(stones, falling)


def with_returned(scene: Scene, removal: Removal) -> tuple[Scene, dict[str, BodyState]]:
    """The scene with those stones again, and how they move, by id.

    Each has its old place in the list as far as the list goes, and its old id unless another stone has it now.
    SceneError if there would be too many stones.
    """
    stones = list(scene.stones)
    states: dict[str, BodyState] = {}
    for removed in removal.stones:
        name = new_id((stone.id for stone in stones), removed.settings.id)
        stones.insert(removed.place, removed.settings.model_copy(update={"id": name}))
        if removed.state is not None:
            states[name] = removed.state
    return with_stones(scene, stones), states


def with_stones(scene: Scene, stones: Iterable[StoneSettings]) -> Scene:
    """The scene with these stones in place of its own; SceneError if they cannot be together."""
    return Scene.read(scene.model_dump(mode="json") | {"stones": [stone.model_dump(mode="json") for stone in stones]})

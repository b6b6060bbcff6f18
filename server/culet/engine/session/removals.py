"""Stones that were removed from a session's scene, so that a stone which is added again comes back as it was."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

from culet.scene import Scene, StoneSettings
from culet.simulation.bodies import BodyState

REMEMBERED = 256
"""Stones of one session, four scenes full; each takes some 2 KiB."""


@dataclass(frozen=True)
class RemovedStone:
    """A stone as it was when it was removed."""

    settings: StoneSettings
    state: BodyState
    """Where it was, and how it moved."""
    falling: bool
    """Time went on for the stones."""


class Removals:
    """Of one session. A stone is remembered by its id, until a stone of that id comes."""

    def __init__(self) -> None:
        """Nothing was removed."""
        self._stones: OrderedDict[str, RemovedStone] = OrderedDict()

    def __len__(self) -> int:
        return len(self._stones)

    def returning(self, before: Scene, after: Scene) -> dict[str, RemovedStone]:
        """The stones that a change of the scene brings back, by their ids: removed ones with the settings that they
        had. A stone of the same id with other settings is another stone."""
        there = {stone.id for stone in before.stones}
        coming = (stone for stone in after.stones if stone.id not in there)
        known = {stone.id: self._stones.get(stone.id) for stone in coming if self._settings(stone.id) == stone}
        return {name: stone for name, stone in known.items() if stone is not None}

    def changed(self, before: Scene, after: Scene, states: Mapping[str, BodyState], *, falling: bool) -> None:
        """The scene has changed; `states` are how the stones of before moved, by their ids, and `falling` whether."""
        kept = {stone.id for stone in after.stones}
        for name in kept:
            self._stones.pop(name, None)
        for stone in before.stones:
            if stone.id not in kept:
                self._stones[stone.id] = RemovedStone(stone, states[stone.id], falling)
        while len(self._stones) > REMEMBERED:
            self._stones.popitem(last=False)

    def clear(self) -> None:
        """Another scene is shown, which these stones were never in."""
        self._stones.clear()

    def meshes(self) -> set[str]:
        """Ids of the meshes that stones need which may come back."""
        return {stone.settings.mesh for stone in self._stones.values() if stone.settings.mesh is not None}

    def _settings(self, name: str) -> StoneSettings | None:
        stone = self._stones.get(name)
        return None if stone is None else stone.settings

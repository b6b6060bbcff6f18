"""What a session was before and after each edit, so that edits can be undone, and made again.

An edit changes the scene. What does not is none: moves of the camera, the fall, pushes, the balance.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from culet.errors import InputError
from culet.scene import Camera, Environment, Scene
from culet.scene.sky_seen import Surroundings
from culet.simulation.bodies import BodyState

KEPT = 100
"""Edits of one session."""
STONES_KEPT = 512
"""In the scenes of these edits, all together: eight scenes full."""
STONE_BYTES = 3584
"""Of a stone in a scene that is kept, with its state; measured 3.4 KiB, if an edit changes all of 64."""
SCENE_BYTES = 6144
"""Of the rest of a scene that is kept; measured 5.5 KiB."""
TOGETHER = 1.0
"""s between two edits of the same thing that count as one, as while a slider is dragged."""


@dataclass(frozen=True)
class Moment:
    """All that an edit can change, by the names of meshes and sky: however long it is kept, it keeps neither.

    Moments are equal if the edit of what is between them has changed nothing but how the stones move.
    """

    scene: Scene
    """With the live camera, and the stones where they start."""
    home: Camera
    own: Environment
    """The session's own sky."""
    surroundings: Surroundings | None
    """Of that sky, while the light one is shown."""
    states: Mapping[str, BodyState] = field(compare=False)
    """How stones moved, by their ids: all of them, or in an edit those that the edit moved or removed."""
    falling: bool = field(compare=False)
    """Time went on for the stones."""

    def with_moved_until(self, later: Moment) -> Moment:
        """This moment with the states of those stones alone that are elsewhere later, or not there."""
        moved = {name: state for name, state in self.states.items() if not _stayed(state, later.states.get(name))}
        return replace(self, states=moved)


@dataclass(frozen=True)
class Edit:
    """From one moment to another."""

    what: str
    before: Moment
    after: Moment
    time: float
    """s: of the last of those that count as this one."""
    moved_camera: bool
    """Whether the edit itself changed the camera; if not, the view stays where it is when the edit is undone."""

    @property
    def empty(self) -> bool:
        """Nothing is left to be undone."""
        return self.before == self.after and not self.before.states


class Edits:
    """Of one session, by all who edit it. An edit after some were undone takes the place of those."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """None so far; `clock` tells seconds."""
        self._clock = clock
        self._done: list[Edit] = []
        self._undone: list[Edit] = []

    def __len__(self) -> int:
        return len(self._done) + len(self._undone)

    @property
    def can_undo(self) -> bool:
        """Whether there is an edit to undo."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is an undone edit to make again."""
        return bool(self._undone)

    @property
    def nbytes(self) -> int:
        """At most, about: what an edit leaves as it was is kept once (`scene.patch.sharing`)."""
        return sum(SCENE_BYTES + STONE_BYTES * _stones(edit) for edit in (*self._done, *self._undone))

    def note(self, what: str, before: Moment, after: Moment) -> None:
        """An edit was made. `what` is the same for edits that count as one if they follow each other soon; an edit of
        an empty `what` is always one by itself."""
        moved_camera = (before.scene.camera, before.home) != (after.scene.camera, after.home)
        edit = Edit(what, before.with_moved_until(after), replace(after, states={}), self._clock(), moved_camera)
        if edit.empty:
            return
        self._undone.clear()
        last = self._done[-1] if self._done else None
        if last is not None and what and last.what == what and edit.time - last.time < TOGETHER:
            self._done.pop()
            edit = _together(last, edit)
        if not edit.empty:
            self._done.append(edit)
        while len(self._done) > 1 and (len(self._done) > KEPT or sum(map(_stones, self._done)) > STONES_KEPT):
            del self._done[0]

    def to_undo(self) -> Edit:
        """The last edit that is not undone; InputError if there is none."""
        if not self._done:
            raise InputError("there is no edit to undo")
        return self._done[-1]

    def to_redo(self) -> Edit:
        """The edit that was undone last; InputError if there is none."""
        if not self._undone:
            raise InputError("there is no undone edit to make again")
        return self._undone[-1]

    def undone(self, left: Moment, now: Moment) -> None:
        """The edit of `to_undo` was undone, which led from `left` to `now`: to make the edit again leads there."""
        edit = self._done.pop()
        self._undone.append(replace(edit, after=left.with_moved_until(now), time=float("-inf")))

    def redone(self, left: Moment, now: Moment) -> None:
        """The edit of `to_redo` was made again, which led from `left` to `now`: to undo the edit leads there."""
        edit = self._undone.pop()
        self._done.append(replace(edit, before=left.with_moved_until(now)))


def _together(first: Edit, second: Edit) -> Edit:
    """Both as one: what the first one moved was there before."""
    states = {**second.before.states, **first.before.states}
    return Edit(
        what=first.what,
        before=replace(first.before, states=states),
        after=second.after,
        time=second.time,
        moved_camera=first.moved_camera or second.moved_camera,
    )


def _stones(edit: Edit) -> int:
    return len(edit.before.scene.stones)


def _stayed(before: BodyState, after: BodyState | None) -> bool:
    return after is not None and (after.position, after.orientation) == (before.position, before.orientation)


def paths_of(patch: Mapping[str, object], under: str = "") -> str:
    """What a merge patch reaches, in one line: the same for patches that give other values to the same fields."""
    parts = []
    for name, value in sorted(patch.items()):
        path = f"{under}{name}"
        parts.append(paths_of(value, f"{path}.") if isinstance(value, Mapping) and value else path)
    return " ".join(parts)

"""One session: a scene as its viewers have edited it, the stone in motion, and what was shown lately.

A session does not render and does not know who watches. Every change goes through a method of `Session`, which gives
what is shown a new step number whenever it differs from before.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from time import thread_time
from typing import Any

from culet.engine.session.edits import Edits, Moment
from culet.engine.session.history import History, Past
from culet.engine.session.instants import PosesSeen
from culet.engine.session.motion import StonesMotion
from culet.engine.session.news import News
from culet.engine.session.picking import placed, struck
from culet.engine.session.removals import Removals
from culet.engine.session.snapshot import LARGEST_FRACTION, SessionSnapshot
from culet.engine.session.viewpoint import axes
from culet.errors import InputError
from culet.scene import Camera, Scene, StoneSettings
from culet.scene.fields import Pose
from culet.simulation.bodies import BodyState
from culet.stage import Sky, Stage
from culet_protocol.engine import SessionChange, SessionMotion
from culet_protocol.messages import BALANCED, Balance, Condition
from culet_protocol.watch import watch_key


@dataclass(frozen=True)
class ShownScene:
    """Everything that one picture depends on."""

    step: int
    stage: Stage
    """With the live camera and the stones' poses."""
    simulation_time: float
    """s."""
    moving: bool

    @property
    def scene(self) -> Scene:
        """That of the stage."""
        return self.stage.scene


class Session:
    """Mutable; changed under `lock` only, since a change may wait for a thread that makes a stone."""

    def __init__(
        self,
        name: str,
        stage: Stage,
        *,
        sky: Sky | None = None,
        history: History | None = None,
        timer: Callable[[], float] = thread_time,
    ) -> None:
        """`history` remembers what is shown; `timer` says how many seconds of the processor were taken."""
        self.name = name
        """32 hexadecimal digits."""
        self.key = watch_key(name)
        """Its watch id: the 16 bytes that its frames begin with."""
        self.lock = asyncio.Lock()
        self.asked = asyncio.Lock()
        """Held while a question is answered: of each session one at a time, so that none keeps all others waiting."""
        self.balance = Balance(exactness=BALANCED, pinned=False)
        """Of speed and exactness, while things move."""
        self.sequence = 0
        """Of the frame sent last."""
        self.history = History() if history is None else history
        self.removals = Removals()
        """Stones that may come back."""
        self.edits = Edits()
        """Which may be undone."""
        self.motion = StonesMotion(stage, timer=timer)
        self.news = News(name, stage.scene, self.condition())
        self.stage = stage
        """As it is now: with the live camera, and the stones where they start."""
        self.home = stage.scene.camera
        """The camera as the scene has it."""
        self.sky = sky or stage.sky
        """The session's own sky: the stage's, or the one of the stage before a viewer switched to the light sky."""
        self.shown = self._look(step=1)

    @classmethod
    def restored(
        cls,
        name: str,
        stage: Stage,
        snapshot: SessionSnapshot,
        *,
        sky: Sky | None = None,
        history: History | None = None,
    ) -> Session:
        """The session that another engine had; its step and frame numbers go on where none was used."""
        own = (sky or stage.sky)._replace(surroundings=snapshot.surroundings)
        session = cls(name, stage, sky=own, history=history)
        session.home = snapshot.home
        session.sequence = snapshot.next_sequence
        session.balance = Balance(exactness=snapshot.exactness, pinned=snapshot.pinned)
        session.motion.restore(snapshot.simulation, snapshot.fraction, falling=snapshot.falling)
        session.shown = session._look(step=snapshot.next_step)
        return session

    @property
    def scene(self) -> Scene:
        """That of the stage."""
        return self.stage.scene

    @property
    def moment(self) -> Moment:
        """What an edit can change."""
        return Moment(
            scene=self.scene,
            home=self.home,
            own=self.sky.environment,
            surroundings=self.sky.surroundings,
            states=self.motion.states(),
            falling=self.motion.falling,
        )

    def change(
        self,
        stage: Stage,
        *,
        home: Camera | None = None,
        sky: Sky | None = None,
        states: Mapping[str, BodyState] | None = None,
        falling: bool | None = None,
    ) -> None:
        """Show this stage by its camera; `home` is where a reset takes the camera, by default where it was.

        The stones go on as `Motion.follow` has it, those that `states` names from there. A stone that was removed, and
        comes again with the settings that it had, goes on from where and as it was. `sky` is that of a stage with an
        environment of its own. Time goes on for the stones as `falling` says, by default as those were that come again
        to a scene without any. InputError, and nothing changed, if the stones cannot be so.
        """
        before, were, fell = self.scene, self.motion.states(), self.motion.falling
        returning = self.removals.returning(before, stage.scene)
        self.motion.follow(stage, {name: stone.state for name, stone in returning.items()} | dict(states or {}))
        self.removals.changed(before, stage.scene, were, falling=fell)
        if falling is None and not before.stones and any(stone.falling for stone in returning.values()):
            falling = True
        if falling is not None and stage.scene.stones and falling != self.motion.falling:
            self.motion.set_falling(falling)
        self._take(stage, home, sky)

    def replace(self, stage: Stage, *, home: Camera | None = None, sky: Sky | None = None) -> None:
        """As `change`, but all stones begin anew, at rest where the scene has them. Removals are forgotten."""
        self.motion.replace(stage)
        self.removals.clear()
        self._take(stage, home, sky)

    def _take(self, stage: Stage, home: Camera | None, sky: Sky | None) -> None:
        self.stage = stage
        self.home = home or self.home
        self.sky = sky or self.sky
        self._show()

    def set_falling(self, falling: bool) -> None:
        """Start or pause free fall; InputError if there is nothing to fall."""
        self.motion.set_falling(falling)
        self._show()

    def toggle_fall(self, name: str | None = None) -> None:
        """As `Motion.toggle_fall`."""
        self.motion.toggle_fall(name)
        self._show()

    def push(self, x: float, y: float, right: float, up: float) -> None:
        """Strike the stone at a point of the picture (halves of its height), by R/s along the camera's right and up.

        Time goes on, if a stone is hit. InputError if there is no stone, or the blow is too strong.
        """
        if not self.scene.stones:
            raise InputError("expected a scene with a stone, got none: nothing can be pushed")
        met = struck(self.scene.camera, placed(self._posed(self.motion.latest())), x, y)
        if met is None:
            return
        right_axis, up_axis, _ = axes(self.scene.camera)
        a, b, c = (right * right_axis + up * up_axis).tolist()
        self.motion.push(met.name, met.point, (a, b, c))
        self._show()

    def place(self, name: str, pose: Pose) -> None:
        """Put a stone at rest where it starts from now on: the others go on. pydantic's ValidationError if that is
        beyond the range of coordinates."""
        position, orientation = pose
        there = {"position": position, "orientation": orientation}
        stones = tuple(
            StoneSettings.model_validate({**stone.model_dump(), **there}) if stone.id == name else stone
            for stone in self.scene.stones
        )
        self.change(self.stage.showing(self.scene.model_copy(update={"stones": stones})))
        self.motion.hold_still(name)
        self._show()

    def reset_stone(self, name: str | None = None) -> None:
        """Put all stones, or one, back to where the scene has them, and stop them."""
        self.motion.reset(name)
        self._show()

    def advance(self, now: float, share: float = 1.0) -> None:
        """Simulate up to `now` as `Motion.advance` does; show the pose between the last two states.

        Of a stone that does not move nothing changes, not even the time shown: another time would be another picture,
        to be drawn anew.
        """
        try:
            moved = self.motion.advance(now, share)
        except Exception:
            self._show()
            raise
        if moved:
            self._show()

    def remember(self, shown: ShownScene) -> None:
        """Keep what a frame was made of, so that it can be rendered again."""
        self.history.add(Past(shown.step, shown.scene))

    def recall(self, step: int | None) -> Past:
        """What was shown at a step (None: now), or NotFoundError."""
        now = Past(self.shown.step, self.shown.scene)
        return now if step is None else self.history.at(step, now)

    def change_told(self, *, edited: bool) -> SessionChange:
        """What the gateways do not know yet, and another engine needs to go on; they are to be told of it."""
        snapshot = self.snapshot().model_dump(mode="json")
        return self.news.change(self.scene, self.condition(), snapshot, moving=self.motion.moving, edited=edited)

    def motion_told(self) -> SessionMotion:
        """As `change_told`, of what changed by itself."""
        return self.news.motion(self.snapshot().moving_part())

    def condition(self) -> Condition:
        """What the session is like besides its scene."""
        return Condition(
            falling=self.motion.falling,
            asleep=self.motion.asleep,
            motions=self.motion.motions(),
            exactness=self.balance.exactness,
            pinned=self.balance.pinned,
            can_undo=self.edits.can_undo,
            can_redo=self.edits.can_redo,
        )

    def described(self) -> dict[str, Any]:
        """All that a gateway needs to know, and another engine needs to go on, as JSON's types."""
        return {
            "session": self.name,
            "revision": self.news.revision,
            "scene": self.scene.model_dump(mode="json"),
            **self.condition().model_dump(mode="json"),
            "snapshot": self.snapshot().model_dump(mode="json"),
        }

    def snapshot(self) -> SessionSnapshot:
        """What the scene does not say."""
        return SessionSnapshot(
            simulation=self.motion.snapshot(),
            fraction=min(self.motion.fraction, LARGEST_FRACTION),
            falling=self.motion.falling,
            home=self.home,
            environment=self.sky.environment,
            surroundings=self.sky.surroundings,
            exactness=self.balance.exactness,
            pinned=self.balance.pinned,
            step=self.shown.step,
            sequence=self.sequence,
        )

    def pose(self) -> dict[str, Any] | None:
        """Position and orientation of the stone shown."""
        if not self.shown.scene.stones:
            return None
        stone = self.shown.scene.stones[0]
        return {"position": stone.position, "orientation": stone.orientation}

    def look(self, now: float) -> None:
        """Show where the stones are at `now`, in seconds of a steady clock; waits for no step.

        Of stones that do not move nothing changes, not even the time shown: another time would be another picture, to
        be drawn anew.
        """
        if self.motion.moving or self.shown.moving:
            self._show(now)

    def _show(self, now: float | None = None) -> None:
        look = self._look(self.shown.step, now)
        if look != self.shown:
            self.shown = replace(look, step=self.shown.step + 1)

    def _look(self, step: int, now: float | None = None) -> ShownScene:
        seen = self.motion.seen(now)
        return ShownScene(step, self._posed(seen), seen.time, seen.moving)

    def _posed(self, seen: PosesSeen) -> Stage:
        return self.stage.posed(seen.poses[stone.id] for stone in self.scene.stones)

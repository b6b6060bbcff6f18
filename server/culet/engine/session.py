"""One session: a scene as its viewers have edited it, the stone in motion, and what was shown lately.

A session does not render and does not know who watches. Every change goes through `change`, `advance` or `set_falling`,
which give what is shown a new step number whenever it differs from before.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from time import thread_time
from typing import Any

from culet.engine.picking import struck_point
from culet.engine.snapshot import LARGEST_FRACTION, Snapshot
from culet.engine.viewpoint import axes
from culet.errors import InputError, NotFoundError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.scene import Camera, Environment, Scene
from culet.scene.sky_seen import Surroundings
from culet.simulation import Allowance, FixedStepClock, Pace, Simulation, surfaces_of
from culet_protocol.engine import SessionState
from culet_protocol.messages import BALANCED, Balance


@dataclass(frozen=True, eq=False)
class Sky:
    """A session's own sky: what a switch from the light one goes back to."""

    environment: Environment
    panorama: Panorama | None = None
    """Of an environment that is an image."""
    surroundings: Surroundings | None = None
    """Those that it was seen with, before the scene was put under the light one."""


@dataclass(frozen=True)
class Shown:
    """Everything that one picture depends on."""

    step: int
    scene: Scene
    """With the live camera and the stone's pose."""
    stone: Stone | None
    panorama: Panorama | None = field(compare=False)
    """The one that the scene's environment names."""
    simulation_time: float
    """s."""
    moving: bool


@dataclass(frozen=True)
class Past:
    """What was shown, by the names of its mesh and sky: however long it is remembered, it keeps neither."""

    step: int
    scene: Scene
    """With the live camera and the stone's pose."""


class Session:
    """Mutable; changed under `lock` only, since a change may wait for a thread that makes a stone."""

    def __init__(
        self,
        name: str,
        scene: Scene,
        stone: Stone | None,
        *,
        sky: Sky | None = None,
        history: int = 600,
        timer: Callable[[], float] = thread_time,
    ) -> None:
        """`timer` says how many seconds of the processor were taken."""
        self.name = name
        """32 hexadecimal digits."""
        self.key = bytes.fromhex(name)
        """The 16 bytes that its frames begin with."""
        self.lock = asyncio.Lock()
        self.falling = False
        self.balance = Balance(exactness=BALANCED, pinned=False)
        """Of speed and exactness, while things move."""
        self.sequence = 0
        """Of the frame sent last."""
        self._history_length = history
        self._history: OrderedDict[int, Past] = OrderedDict()
        self._advanced_at: float | None = None
        self._timer = timer
        self._allowance = Allowance()
        self.pace = Pace()
        """Of the simulation."""
        self._authored = scene
        self._camera = scene.camera
        self.sky = sky or Sky(scene.environment)
        """Its environment is the scene's, or was, before the scene was put under the light one."""
        self._place(scene, stone)
        self._clock = _clock(scene)
        self.shown = self._look(step=1)

    @classmethod
    def restored(
        cls,
        name: str,
        scene: Scene,
        stone: Stone | None,
        snapshot: Snapshot,
        *,
        sky: Sky | None = None,
        history: int = 600,
    ) -> Session:
        """The session that another engine had; its step and frame numbers go on where none was used."""
        sky = replace(sky or Sky(scene.environment), surroundings=snapshot.surroundings)
        session = cls(name, scene, stone, sky=sky, history=history)
        session._authored = scene.model_copy(update={"camera": snapshot.home})
        session._clock = _clock(scene, snapshot.fraction)
        session.falling = snapshot.falling and session._simulation is not None
        session.sequence = snapshot.next_sequence
        session.balance = Balance(exactness=snapshot.exactness, pinned=snapshot.pinned)
        if session._simulation is not None and snapshot.simulation is not None:
            session._simulation.restore(snapshot.simulation)
        session.shown = session._look(step=snapshot.next_step)
        return session

    @property
    def scene(self) -> Scene:
        """As it is now: with the live camera, and the stone where it starts."""
        return self._authored.model_copy(update={"camera": self._camera})

    @property
    def home(self) -> Camera:
        """The camera as the scene has it."""
        return self._authored.camera

    @property
    def stone(self) -> Stone | None:
        """The shape of the scene's stone."""
        return self._stone

    @property
    def moving(self) -> bool:
        """Whether time would change what is shown."""
        return self.falling and self._simulation is not None and not self.asleep

    @property
    def asleep(self) -> bool:
        """Whether the stone has come to rest for good, unless somebody changes something."""
        return self._simulation is not None and self._simulation.settled

    def change(self, scene: Scene, *, home: Camera | None = None, sky: Sky | None = None) -> None:
        """Show this scene and its camera; `home` is where a reset takes the camera, by default where it was.

        The stone goes on from where it is, by the scene's settings. `sky` belongs to a scene with another environment
        of its own. InputError, and nothing changed, if the stone cannot have these settings.
        """
        was_moving = self.moving
        if self._simulation is not None:
            self._simulation.adjust(scene.simulation)
            self._simulation.surround(surfaces_of(scene))
        if scene.simulation.time_step != self._clock.time_step:
            self._clock = _clock(scene, self._clock.fraction)
        if not was_moving:
            self._advanced_at = None  # the time that it rested is not made up for
        self._authored = scene.model_copy(update={"camera": home or self.home})
        self.sky = sky or self.sky
        self._camera = scene.camera
        self._show()

    def start_anew(self, scene: Scene, *, home: Camera | None = None, sky: Sky | None = None) -> None:
        """As `change`, with the stone put to the scene's start, from where it falls at once if it was falling."""
        self._place(scene, self._stone)
        self._advanced_at = None
        self._clock.restart()
        self.change(scene, home=home, sky=sky)

    def replace_stone(
        self, scene: Scene, stone: Stone | None, *, home: Camera | None = None, sky: Sky | None = None
    ) -> None:
        """As `change`, with another stone, or none: at rest where the scene has it."""
        self._place(scene, stone)
        self._stop()
        self.change(scene, home=home, sky=sky)

    def set_falling(self, falling: bool) -> None:
        """Start or pause free fall; InputError if there is nothing to fall."""
        if self._simulation is None:
            raise InputError("expected a scene with a stone, got none: nothing can fall")
        if falling:
            self._simulation.prepare()
        self.falling = falling
        self._advanced_at = None
        self._show()

    def toggle_fall(self) -> None:
        """Start or pause free fall. A stone that sleeps, or has not moved yet, is dropped from where the scene has it,
        and from above there if it stands on the floor. InputError if there is nothing to fall."""
        simulation, was_falling = self._simulation, self.falling
        if simulation is not None and (self.asleep or (simulation.at_start and not was_falling)):
            self._stop()
            simulation.drop()
            was_falling = False
        self.set_falling(not was_falling)

    def push(self, x: float, y: float, right: float, up: float) -> None:
        """Strike the stone at a point of the picture (halves of its height), by R/s along the camera's right and up.

        Time goes on, if the stone is hit. InputError if there is no stone, or the blow is too strong.
        """
        if self._simulation is None or self._stone is None:
            raise InputError("expected a scene with a stone, got none: nothing can be pushed")
        position, orientation = self._simulation.state.position, self._simulation.state.orientation
        point = struck_point(self._camera, self._stone, position, orientation, x, y)
        if point is None:
            return
        right_axis, up_axis, _ = axes(self._camera)
        a, b, c = ((right * right_axis + up * up_axis) * self._simulation.body.mass).tolist()
        was_moving = self.moving
        self._simulation.push((a, b, c), point)
        self.falling = True
        if not was_moving:
            self._advanced_at = None
        self._show()

    def reset_stone(self) -> None:
        """Put the stone back to where the scene has it, and stop it."""
        if self._simulation is not None:
            self._simulation.reset()
        self._stop()
        self._show()

    def advance(self, now: float, share: float = 1.0) -> None:
        """Simulate up to `now`, in seconds of a steady clock, in fixed steps; show the pose between the last two.

        Steps may take their part of the `share` of the time that the session can have beside others.

        Of a stone that does not move nothing changes, not even the time shown: another time would be another picture,
        to be drawn anew. Steps that take too long are given up (`Allowance`). If one fails, the stone stops, and the
        error is raised.
        """
        if self._simulation is None or not self.moving:
            return
        elapsed = 0.0 if self._advanced_at is None else max(now - self._advanced_at, 0.0)
        self._advanced_at = now
        try:
            self._step(self._simulation, elapsed, share)
            self._show()
        except Exception:
            self._stop()
            self._show()
            raise

    def pause(self) -> None:
        """Nobody watches: the time that passes now is not made up for, nor is it lost."""
        self._advanced_at = None

    def _step(self, simulation: Simulation, elapsed: float, share: float) -> None:
        self._allowance.grow(elapsed, share)
        due = self._clock.advance(elapsed)
        for taken in range(due):
            if self._allowance.spent:
                self._clock.drop(due - taken)
                break
            begun = self._timer()
            simulation.step()
            self._allowance.spend(self._timer() - begun)
        self.pace.passed(elapsed, self._clock.dropped)

    def remember(self, shown: Shown) -> None:
        """Keep what a frame was made of, so that it can be rendered again."""
        self._history[shown.step] = Past(shown.step, shown.scene)
        while len(self._history) > self._history_length:
            self._history.popitem(last=False)

    @property
    def remembered(self) -> int:
        """Shown states that are kept."""
        return len(self._history)

    def recall(self, step: int | None) -> Past:
        """What was shown at a step (None: now), or NotFoundError."""
        if step is None or step == self.shown.step:
            return Past(self.shown.step, self.shown.scene)
        try:
            return self._history[step]
        except KeyError:
            raise NotFoundError(
                f"step {step} was never shown or is forgotten; the session is at step {self.shown.step} "
                f"and keeps the last {self._history_length} that it showed"
            ) from None

    def report(self, *, edited: bool) -> SessionState:
        """What the gateway needs to know, and another engine needs to go on."""
        return SessionState(
            session=self.name,
            scene=self.scene.model_dump(mode="json"),
            falling=self.falling,
            asleep=self.asleep,
            exactness=self.balance.exactness,
            pinned=self.balance.pinned,
            edited=edited,
            snapshot=self.snapshot().model_dump(mode="json"),
        )

    def snapshot(self) -> Snapshot:
        """What the scene does not say."""
        return Snapshot(
            simulation=None if self._simulation is None else self._simulation.snapshot(),
            fraction=min(self._clock.fraction, LARGEST_FRACTION),
            falling=self.falling,
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

    def _stop(self) -> None:
        self.falling = False
        self._advanced_at = None
        self._clock.restart()

    def _show(self) -> None:
        look = self._look(step=self.shown.step)
        if look != self.shown:
            self.shown = self._look(step=self.shown.step + 1)

    def _look(self, step: int) -> Shown:
        scene, time = self.scene, 0.0
        if self._simulation is not None:
            fraction = self._clock.fraction
            scene = scene.moved(*self._simulation.interpolated(fraction))
            before, after = self._simulation.previous.time, self._simulation.state.time
            time = before + (after - before) * fraction
        return Shown(step, scene, self._stone, self.sky.panorama, time, self.moving)

    def _place(self, scene: Scene, stone: Stone | None) -> None:
        simulation: Simulation | None = None
        if stone is not None and scene.stones:
            start = scene.stones[0]
            simulation = Simulation(scene.simulation, stone, start.position, start.orientation, surfaces_of(scene))
        self._stone = stone
        self._simulation = simulation


def _clock(scene: Scene, fraction: float = 0.0) -> FixedStepClock:
    """A clock for the scene's steps that is so far between two of them."""
    clock = FixedStepClock(scene.simulation.time_step)
    clock.advance(min(fraction, LARGEST_FRACTION) * clock.time_step)
    return clock

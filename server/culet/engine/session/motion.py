"""A session's stones in time: whether they fall, in fixed steps that follow a steady clock, and where they are shown.

Two sides use a motion. One takes the steps (`run`, in a thread of the stepper, or `advance`) and writes down the latest
two states. The other shows what lies between them at a time (`seen`), and never waits for a step.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import threading
from collections.abc import AsyncIterator, Callable, Mapping
from time import thread_time
from typing import Any, Literal

from culet.engine.session.following import adapt, in_order, moved_by, same_form
from culet.engine.session.instants import Instant, Lease, PosesSeen
from culet.engine.session.snapshot import LARGEST_FRACTION
from culet.errors import CuletError, InputError
from culet.simulation import Allowance, FixedStepClock, Pace
from culet.simulation.bodies import Body, BodyState
from culet.simulation.clock import MAX_CATCH_UP
from culet.simulation.rigid_body.state import Triple
from culet.simulation.staged import bodies_of, world_of
from culet.simulation.world import World, between
from culet.stage import Stage

LATE = 1e-3
"""Time steps after a step is due, when it is taken: however the sums of times are rounded, it is due by then."""


class StonesMotion:
    """Mutable. Whoever changes or saves a motion that may be running does so within `still`."""

    def __init__(self, stage: Stage, *, timer: Callable[[], float] = thread_time) -> None:
        """The stones at rest where the scene has them. `timer` says how many seconds of the processor were taken."""
        self.falling = False
        """Time goes on for the stones, should they not sleep."""
        self.pace = Pace()
        self.problem: Exception | None = None
        """Because of which the stones stopped, until somebody takes note of it."""
        self.world = world_of(stage)
        self.clock = FixedStepClock(self.world.law.time_step)
        self._stage = stage
        self._spent = 0.0
        self._timer = timer
        self._allowance = Allowance()
        self._guard = threading.Lock()
        self._turn = asyncio.Lock()
        """Of those on the loop who want the guard: one at a time waits for it in a thread. If many did, no thread might
        be left for what the one who has it waits for, and all would wait for ever."""
        self._lease: Lease | None = None
        self._lost = 0.0
        """s of it that are accounted for."""
        self._followed: float | None = None
        """When the lease began by which the last steps were taken."""
        self._advanced_at: float | None = None
        """s, steady clock, without what was lost: up to when time was simulated. None: time begins with the next
        look."""
        self._seen_until = 0.0
        """s of simulation: up to when the motion was shown last."""
        self._write_down()

    def restore(self, snapshot: dict[str, Any] | None, fraction: float, *, falling: bool) -> None:
        """Go on from what another engine's `snapshot` and clock were; InputError if that is no snapshot."""
        self.clock = _clock(self.clock.time_step, fraction)
        self.falling = falling and bool(self.world.bodies)
        if snapshot is not None:
            self.world = in_order(self.world, snapshot.get("stones"))
            self.world.restore(snapshot)
        self._write_down()

    @contextlib.asynccontextmanager
    async def still(self) -> AsyncIterator[None]:
        """No step is taken meanwhile. Waits for the steps that are being taken, without keeping the loop."""
        async with self._turn:
            if not self._guard.acquire(blocking=False):
                taking = asyncio.get_running_loop().run_in_executor(None, self._guard.acquire)
                try:
                    await asyncio.shield(taking)
                except asyncio.CancelledError:
                    taking.add_done_callback(lambda _: self._guard.release())
                    raise
            try:
                yield
            finally:
                self._guard.release()

    @property
    def moving(self) -> bool:
        """Whether time would change the poses."""
        return self.falling and bool(self._instant.names) and not self._instant.settled

    @property
    def asleep(self) -> bool:
        """Whether all stones have come to rest for good, unless somebody changes something."""
        instant = self._instant
        return bool(instant.names) and instant.settled and all(body.asleep for body in instant.state.bodies)

    @property
    def fraction(self) -> float:
        """Of the step that is put by."""
        return self.clock.fraction

    def seen(self, now: float | None = None) -> PosesSeen:
        """Where the stones are at `now` (s, steady clock), or when the latest step was taken. From any thread."""
        instant, lease = self._instant, self._lease
        fraction = instant.fraction if now is None else instant.fraction_at(now, lease)
        if instant.settled:  # nothing changes, not even the time shown: another time would be another picture
            fraction = 1.0
        before, after = instant.previous.time, instant.state.time
        time = before + (after - before) * fraction
        if now is not None:
            self._seen_until = time
        poses = between(instant.previous, instant.state, fraction)
        return PosesSeen(
            {name: (pose.position, pose.orientation) for name, pose in zip(instant.names, poses, strict=True)},
            time,
            self.moving,
        )

    def latest(self) -> PosesSeen:
        """Where the stones are at the latest step. From any thread."""
        instant = self._instant
        poses = {
            name: (body.position, body.orientation)
            for name, body in zip(instant.names, instant.state.bodies, strict=True)
        }
        return PosesSeen(poses, instant.state.time, self.moving)

    def states(self) -> dict[str, BodyState]:
        """How each stone moves at the latest step, by its id. From any thread."""
        return dict(zip(self._instant.names, self._instant.state.bodies, strict=True))

    def motions(self) -> dict[str, Literal["paused", "falling", "asleep"]]:
        """What each stone does, by its id. From any thread."""
        instant, falling = self._instant, self.falling
        return {
            name: "asleep" if body.asleep else "falling" if falling and not body.held else "paused"
            for name, body in zip(instant.names, instant.state.bodies, strict=True)
        }

    def snapshot(self) -> dict[str, Any] | None:
        """What the scene and `fraction` do not say."""
        return self.world.snapshot() if self.world.bodies else None

    def follow(self, stage: Stage, states: Mapping[str, BodyState] | None = None) -> None:
        """Go on by another stage: stones come and go, or are put elsewhere, and the others move on as they did.

        A stone that `states` names by its id goes on from there. Of the others, one is put to its start that comes, or
        has another start, shape or scale. If no stone goes on with the shape that it had, all of them begin anew.
        InputError, and nothing changed, if the stones cannot be so.
        """
        if not states and moved_by(stage) == moved_by(self._stage):
            self._stage = stage
            return
        bodies = {body.name: body for body in bodies_of(stage)}
        given = {name: state for name, state in (states or {}).items() if name in bodies}
        if any(body.name in bodies and same_form(body, bodies[body.name]) for body in self.world.bodies):
            self._adapt(stage, bodies, given)
        else:
            self.replace(stage)
            for name, state in given.items():
                self.world.remove(name)
                self.world.add(bodies[name], state)
        self._stage = stage
        time_step = stage.scene.simulation.time_step
        if time_step != self.clock.time_step:
            self.clock = _clock(time_step, self.fraction)
        self._write_down()

    def replace(self, stage: Stage) -> None:
        """Begin anew with the stones of a stage, at rest where the scene has them."""
        self.world = world_of(stage)
        self._stage = stage
        self.clock = FixedStepClock(stage.scene.simulation.time_step)
        self.stop()

    def reset(self, name: str | None = None) -> None:
        """Put all stones, or one, back to where they started, and stop them; InputError without that stone."""
        self.world.reset(name)
        if name is not None and self.moving and len(self.world.bodies) > 1:
            self.world.hold(name, held=True)
            self._stop_if_all_are_held()
        else:
            self.stop()

    def hold_still(self, name: str) -> None:
        """Keep a stone that was put somewhere there: time goes on for others, and stops where there are none."""
        if self.falling and len(self.world.bodies) > 1:
            self.world.hold(name, held=True)
            self._stop_if_all_are_held()
        else:
            self.stop()

    def set_falling(self, falling: bool) -> None:
        """Let time go on, or not; InputError without a stone."""
        self._check_stones("fall")
        if falling:
            self.world.prepare()
        elif self.falling:
            self._put_by_what_was_seen()
        self.falling = falling
        self._write_down()

    def toggle_fall(self, name: str | None = None) -> None:
        """Start or pause the fall of all stones, or of one; InputError without any, or without that one.

        Stones that all sleep, or of which none has moved yet, are dropped from where the scene has them, and from above
        there if they stand on the floor. Of several, one is held where it is, or let go; one that sleeps is dropped.
        """
        self._check_stones("fall")
        if name is not None and len(self.world.bodies) > 1:
            self._toggle_one(name)
            return
        if name is not None:
            self.world.number(name)
        was_falling = self.moving or (self.falling and self.asleep)
        if self.asleep or (self.world.at_start and not was_falling):
            self.stop()
            self.world.drop()
            was_falling = False
        if not was_falling:
            for body in self.world.bodies:
                self.world.hold(body.name, held=False)
        self.set_falling(not was_falling)

    def push(self, name: str, point: Triple, velocity: Triple) -> None:
        """Strike a stone at a point of the world (R) so that its centre's velocity changes by `velocity` (R/s), and let
        time go on. InputError without that stone, or if the blow is too strong."""
        body = self.world.bodies[self.world.number(name)]
        x, y, z = (component * body.mass for component in velocity)
        self.world.push(name, (x, y, z), point)
        self.falling = True
        self._write_down()

    def advance(self, now: float, share: float = 1.0) -> bool:
        """Simulate up to `now`, in seconds of a steady clock, in fixed steps; whether there was anything to move.

        Steps may take their part of the `share` of the time that the session can have beside others. Steps that take
        too long are given up (`Allowance`). If one fails, the stones stop, and the error is raised.
        """
        if not self.moving:
            return False
        try:
            self._advance_to(now, share)
        except Exception:
            self.stop()
            raise
        return True

    def look_on(self, now: float, share: float) -> bool:
        """Somebody sees the stones at `now`, so that steps are to be taken for MAX_CATCH_UP seconds from then; whether
        there are any to take."""
        if not self.moving:
            return False
        lease = self._lease
        if lease is None:
            self._lease = Lease(now, now + MAX_CATCH_UP, 0.0, share)
        else:
            self._lease = Lease(lease.since, now + MAX_CATCH_UP, lease.lost + max(now - lease.until, 0.0), share)
        return True

    def run(self, now: float) -> float | None:
        """Take the steps that are due at `now` by the lease; when the next is due, or None if none will be.

        If one fails, the stones stop, and `problem` says why.
        """
        if not self._guard.acquire(blocking=False):  # it is being changed, which may take seconds
            return now + self.clock.time_step
        try:
            lease = self._lease
            if lease is None or not self.moving:
                return None
            if lease.since != self._followed:
                self._followed, self._advanced_at, self._lost = lease.since, lease.since, 0.0
            lost, self._lost = lease.lost - self._lost, lease.lost
            self.clock.lose(lost)
            self.pace.passed(lost, self.clock.dropped)
            end = min(now, lease.until)
            try:
                self._advance_to(end - lease.lost, lease.share)
            except Exception as error:
                self.problem = error  # before they stop, or who sees them at rest would look no more
                self.stop()
                return None
            due = end + (1 - self.fraction + LATE) * self.clock.time_step
            return due if due < lease.until else None  # the next run finds out whether all sleep
        finally:
            self._guard.release()

    def take_spent(self) -> float:
        """s of the processor that steps have taken since this was asked last."""
        spent, self._spent = self._spent, 0.0
        return spent

    def take_problem(self) -> Exception | None:
        """`problem`, which is known from then on."""
        problem, self.problem = self.problem, None
        return problem

    def look_away(self) -> None:
        """Nobody sees the stones any more: no further step is taken, and the time until the next look is not lost. From
        any thread, even while a step is taken."""
        self._lease = None

    def pause(self) -> None:
        """Time that passes until the next look at the clock is not made up for, nor is any lost."""
        self._advanced_at = self._lease = None

    def stop(self) -> None:
        """Nothing falls any more; what was put by of a step is forgotten."""
        self.falling = False
        self.pause()
        self.clock.restart()
        self._seen_until = 0.0
        self._write_down()

    def _adapt(self, stage: Stage, wanted: Mapping[str, Body], states: Mapping[str, BodyState]) -> None:
        """As `following.adapt`; whatever goes wrong, the world is as it was."""
        world, saved = self.world, self.world.snapshot()
        bodies, surfaces, law = world.bodies, world.surfaces, world.law
        try:
            if adapt(world, stage, wanted, states):
                self.pause()
                self.clock.restart()
        except Exception:
            self.world = World(bodies, surfaces, law)
            self.world.restore(saved)
            self._write_down()
            raise

    def _toggle_one(self, name: str) -> None:
        world = self.world
        now = world.state.bodies[world.number(name)]
        if not self.falling:  # this one alone is to fall
            for body in world.bodies:
                world.hold(body.name, held=body.name != name)
            if now.asleep or world.at_start:
                world.drop(name)
            self.set_falling(True)
            return
        if now.held:
            world.hold(name, held=False)
        elif now.asleep:
            world.drop(name)
        else:
            world.hold(name, held=True)
        self._stop_if_all_are_held()

    def _stop_if_all_are_held(self) -> None:
        """Time would go on for no stone: the next fall of all lets go of all."""
        if all(body.held for body in self.world.state.bodies):
            self.stop()
        else:
            self._write_down()

    def _put_by_what_was_seen(self) -> None:
        """As much of the next step as pictures have shown: or else the stones would stop where they were when the last
        step was taken, which is back from where they were seen."""
        before, step = self.world.previous.time, self.clock.time_step
        seen = min((self._seen_until - before) / step, LARGEST_FRACTION)
        self.clock.advance(max(seen - self.fraction, 0.0) * step)

    def _check_stones(self, verb: str) -> None:
        if not self.world.bodies:
            raise InputError(f"expected a scene with a stone, got none: nothing can {verb}")

    def _advance_to(self, now: float, share: float) -> None:
        elapsed = 0.0 if self._advanced_at is None else max(now - self._advanced_at, 0.0)
        self._advanced_at = now
        self._step(elapsed, share)
        self._write_down()

    def _step(self, elapsed: float, share: float) -> None:
        self._allowance.grow(elapsed, share)
        due = self.clock.advance(elapsed)
        for taken in range(due):
            if self._allowance.spent:
                self.clock.drop(due - taken)
                break
            begun = self._timer()
            self._take_step()
            seconds = self._timer() - begun
            self._spent += seconds
            self._allowance.spend(seconds)
        self.pace.passed(elapsed, self.clock.dropped)

    def _take_step(self) -> None:
        """CuletError, and the stones are back where they started, if they came to be where no number is."""
        self.world.step()
        bodies = self.world.state.bodies
        if not all(math.isfinite(sum((*body.position, *body.orientation))) for body in bodies):
            self.world.reset()
            raise CuletError("the stones moved faster than numbers can tell; they are back where they started")

    def _write_down(self) -> None:
        """The latest states, for those who look on."""
        world = self.world
        if not self.falling or world.settled:
            self.pause()  # the time that stones rest is not made up for, whatever lets them go on
        self._instant = Instant(
            names=tuple(body.name for body in world.bodies),
            previous=world.previous,
            state=world.state,
            settled=world.settled,
            fraction=self.clock.fraction,
            time_step=self.clock.time_step,
            at=0.0 if self._advanced_at is None else self._advanced_at,
            lease=self._lease,
        )


def _clock(time_step: float, fraction: float = 0.0) -> FixedStepClock:
    """A clock for steps of `time_step` seconds that is so far between two of them."""
    clock = FixedStepClock(time_step)
    clock.advance(min(fraction, LARGEST_FRACTION) * time_step)
    return clock

"""Stones in motion: their current state, the one before, and the way from one to the next.

A world of one stone is moved by the models of one stone (`Simulation`), to the same bits as ever; one of several by
the compiled solver. When a second stone comes, or the last but one goes, pose, velocity and spin are handed over.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar, assert_never

from culet.errors import InputError
from culet.scene.motion import MotionLaws
from culet.simulation.bodies import Body, BodyState, Pose, WorldState
from culet.simulation.one_stone.alone import Alone
from culet.simulation.one_stone.drop import DROP_HEIGHT, STANDING
from culet.simulation.rigid_body.rotation import normalised, rotate_back, slerp
from culet.simulation.rigid_body.state import Quaternion, Touch, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface
from culet.simulation.solver.polyhedron import polyhedron_of
from culet.simulation.together import SolverEffort, Together, angular_momentum_by
from culet.simulation.world_snapshot import read_world_snapshot, write_world_snapshot

T = TypeVar("T")


class World:
    """Advances in fixed steps of `law.time_step`; the same law, bodies and changes give the same bits.

    It knows nothing of real time, as `Simulation` does not. Each change is whole or not at all. Several threads may use
    the solver of one world, but only one at a time may change the world.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        surfaces: Sequence[Surface] = (FLOOR,),
        law: MotionLaws | None = None,
        effort: SolverEffort | None = None,
    ) -> None:
        """At the start. InputError for names that are not different, a law or an inertia that cannot be used;
        TooLargeError for too many bodies; SolverUnavailableError where they have no solver."""
        self.law = law or MotionLaws()
        self.surfaces = tuple(surfaces)
        self.bodies = tuple(bodies)
        """In their order."""
        self._effort = effort
        _different(self.bodies)
        self._mover = self._made(self.bodies, None)
        self._begin()

    def _begin(self) -> None:
        self.at_start = True
        """Whether nothing has moved a stone yet."""
        self.state = self.previous = WorldState(0, 0.0, self._now())

    def _made(self, bodies: tuple[Body, ...], states: Sequence[BodyState] | None) -> Alone | Together | None:
        """What moves these bodies, from these states or else their starts."""
        if not bodies:
            return None
        if len(bodies) > 1:
            together = Together(self.law, (), self.surfaces, self._effort)
            for number, body in enumerate(bodies):
                together.add(body, BodyState.start_of(body) if states is None else states[number])
            return together
        alone = Alone(self.law, bodies[0], self.surfaces)
        if states is not None:
            alone.set_state(states[0])
        return alone

    def _now(self) -> tuple[BodyState, ...]:
        match self._mover:
            case None:
                return ()
            case Alone():
                return (self._mover.state(),)
            case Together():
                return self._mover.states()
            case _:
                assert_never(self._mover)

    @property
    def settled(self) -> bool:
        """Whether nothing that `interpolated` gives will change any more."""
        return self.state.asleep and self.previous.bodies == self.state.bodies

    def number(self, name: str) -> int:
        """Of the body of that name; InputError if there is none."""
        for number, body in enumerate(self.bodies):
            if body.name == name:
                return number
        there = ", ".join(repr(body.name) for body in self.bodies) or "none"
        raise InputError(f"expected the id of a stone ({there}); got {name!r}", "stone")

    def prepare(self) -> None:
        """Compute what all steps need, so that the first takes no longer than the next."""
        if isinstance(self._mover, Alone):
            self._mover.prepare()

    def step(self) -> None:
        """Advance by one fixed step; where all sleep, only time passes."""
        before = self.state
        time = before.time + self.law.time_step
        bodies = before.bodies
        if isinstance(self._mover, Alone):
            self._mover.step()
            bodies = self._now()
        elif isinstance(self._mover, Together) and not before.asleep:
            self._mover.step()
            bodies = self._mover.states()
        self.previous, self.state = before, WorldState(before.step + 1, time, bodies)
        self.at_start = False

    def push(self, name: str, impulse: Triple, point: Triple) -> None:
        """Strike a stone at a point of the world (R) with an impulse (mass R/s), and wake it. One that is held does not
        move.

        InputError if one of them is not finite, there is no such stone, or it would be faster than a scene can ask for.
        """
        number = self.number(name)
        if not all(math.isfinite(c) for c in (*impulse, *point)):
            raise InputError(f"a push is finite; got {impulse} at {point}", "impulse")
        if self.state.bodies[number].held:
            return
        match self._mover:
            case Alone():
                self._mover.push(impulse, point)
            case Together():
                self._mover.push(self.bodies[number], self.state.bodies[number], impulse, point)
            case None:
                return
            case _:
                assert_never(self._mover)
        self._changed()

    def adjust(self, law: MotionLaws) -> None:
        """Go on from the current state by another law. InputError, and nothing changed, if it cannot be used."""
        if law == self.law:
            return
        if self._mover is not None:
            self._mover.set_law(law)
        self.law = law
        self._look()

    def surround(self, surfaces: Sequence[Surface]) -> None:
        """Put other surfaces about the stones."""
        if tuple(surfaces) == self.surfaces:
            return
        if self._mover is not None:
            self._mover.set_surfaces(surfaces)
        self.surfaces = tuple(surfaces)
        self._look()

    def add(self, body: Body, state: BodyState | None = None) -> None:
        """A further stone, after those that there are: at its start, or as `state` says. The others go on."""
        bodies = (*self.bodies, body)
        _different(bodies)
        given = state or BodyState.start_of(body)
        if isinstance(self._mover, Together):
            self._mover.add(body, given)
        else:
            self._hand_over(bodies, (*self.state.bodies, given))
        self.bodies = bodies
        self.previous = replace(self.previous, bodies=(*self.previous.bodies, given))
        self._look()

    def remove(self, name: str) -> None:
        """A stone goes; what it carried falls."""
        gone = self.number(name)
        bodies = _without(self.bodies, gone)
        if isinstance(self._mover, Together) and len(bodies) > 1:
            self._mover.remove(name)
        else:
            left = [state if not state.asleep else replace(state, asleep=False) for state in self.state.bodies]
            self._hand_over(bodies, _without(tuple(left), gone))
        self.bodies = bodies
        self.previous = replace(self.previous, bodies=_without(self.previous.bodies, gone))
        self._look()

    def change(self, body: Body) -> None:
        """The stone of that name becomes this one: its pose, velocity and spin go on, unless no time has passed yet.

        InputError, and nothing changed, if it cannot be so.
        """
        number = self.number(body.name)
        bodies = (*self.bodies[:number], body, *self.bodies[number + 1 :])
        if self.at_start:
            mover = self._made(bodies, None)
            self.bodies, self._mover = bodies, mover
            self._begin()
            return
        old = self.bodies[number]
        if old.shape is body.shape and old.scale == body.scale and self._mover is not None:
            self._mover.set_body(body)
        else:
            states = self.state.bodies
            awake = [state if not state.asleep else replace(state, asleep=False) for state in states]
            self._hand_over(bodies, awake)
        self.bodies = bodies
        self._look()

    def move(
        self, name: str, position: Triple, orientation: Quaternion, velocity: Triple | None = None,
        spin: Triple | None = None,
    ) -> None:  # fmt: skip
        """Put a stone there, with that motion or, where it is None, the one that it has. It wakes."""
        now = self.state.bodies[self.number(name)]
        turned = normalised(orientation)
        self.put(name, BodyState(position, turned, velocity or now.velocity, spin or now.spin, held=now.held))

    def put(self, name: str, state: BodyState) -> None:
        """A stone is in that state from now on, elsewhere maybe. Of several, one that slept is awake."""
        number = self.number(name)
        self._set(number, state)
        before = self.previous.bodies[number].at(state.position, state.orientation)  # no picture between the two places
        self.previous = replace(self.previous, bodies=_with(self.previous.bodies, number, before))
        self._changed()

    def hold(self, name: str, held: bool) -> None:
        """Keep a stone where it is, at rest, or let go of it."""
        number = self.number(name)
        now = self.state.bodies[number]
        if now.held != held:
            still = BodyState(now.position, now.orientation, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), held=held)
            self._set(number, still)
            self._changed()

    def reset(self, name: str | None = None) -> None:
        """Back to the start: one stone, while time goes on, or all, at step 0."""
        if name is None:
            self._mover = self._made(self.bodies, None)
            self._begin()
            return
        body = self.bodies[self.number(name)]
        self.move(name, body.position, body.orientation, body.velocity, body.spin)

    def drop(self, name: str | None = None) -> None:
        """As `reset`; what stands on the floor is lifted first, so that it falls: all stones together, or that one."""
        self.reset(name)
        bodies = self.bodies if name is None else (self.bodies[self.number(name)],)
        standing = [body.position[1] for body in bodies if _clearance(body, BodyState.start_of(body)) <= STANDING]
        lift = DROP_HEIGHT - min(standing, default=DROP_HEIGHT)
        if lift <= 0:
            return
        for body in bodies:
            x, y, z = body.position
            self.move(body.name, (x, y + lift, z), body.orientation, body.velocity, body.spin)
        if name is None:
            self.previous = self.state

    def interpolated(self, fraction: float) -> tuple[Pose, ...]:
        """Poses `fraction` (0 to 1) of the way from the previous state to the current one."""
        if not 0 <= fraction <= 1:
            raise InputError(f"a fraction of a step is between 0 and 1; got {fraction}", "fraction")
        return between(self.previous, self.state, fraction)

    def energy(self) -> float:
        """Kinetic and potential energy, mass R^2/s^2; the latter is 0 with all centres 1 R above the floor."""
        total = 0.0
        for body, state in zip(self.bodies, self.state.bodies, strict=True):
            momentum = angular_momentum_by(body, self.law, state)
            linear = sum(v * v for v in state.velocity) * body.mass / 2
            rotational = sum(a * b for a, b in zip(momentum, state.spin, strict=True)) / 2
            total += linear + rotational + body.mass * self.law.gravity * (state.position[1] - FLOOR.offset - 1)
        return total

    def touches(self) -> tuple[Touch, ...]:
        """How each stone meets the surfaces and the other stones."""
        match self._mover:
            case None:
                return ()
            case Alone():
                return (self._mover.touch(),)
            case Together():
                return tuple(
                    touch._replace(clearance=_clearance(body, state))
                    for body, state, touch in zip(self.bodies, self.state.bodies, self._mover.touches(), strict=True)
                )
            case _:
                assert_never(self._mover)

    def separation(self, one: str, other: str) -> float:
        """Signed distance of two stones' hulls, R; negative: how deep they overlap. InputError for one and the same."""
        if self.number(one) == self.number(other) or not isinstance(self._mover, Together):
            raise InputError(f"expected two stones; got {one!r} and {other!r}", "stone")
        return self._mover.separation(one, other)[0]

    def snapshot(self) -> dict[str, Any]:
        """Everything that the future depends on besides law, surfaces and bodies, as JSON's types."""
        saved = None if self._mover is None else self._mover.save()
        names = [body.name for body in self.bodies]
        return write_world_snapshot(names, self.state, self.previous, saved, at_start=self.at_start)

    def restore(self, snapshot: Any) -> None:  # noqa: ANN401 - whatever JSON held
        """Go on from a snapshot to the same bits; InputError, and nothing changed, if it is none of these stones."""
        found = read_world_snapshot(snapshot, [body.name for body in self.bodies])
        match self._mover:
            case Alone():
                self._mover.load(found.saved)
            case Together():
                self._mover.load(found.saved)
            case None:
                pass
            case _:
                assert_never(self._mover)
        self.previous, self.at_start = found.previous, found.at_start
        self.state = WorldState(found.step, found.time, self._now())

    def _hand_over(self, bodies: tuple[Body, ...], states: Sequence[BodyState]) -> None:
        """To whatever moves so many."""
        mover = self._made(bodies, states)
        if isinstance(mover, Alone):
            mover.set_time(self.state.step, self.state.time)
        self._mover = mover

    def _set(self, number: int, state: BodyState) -> None:
        match self._mover:
            case Alone():
                self._mover.set_state(state)
            case Together():
                self._mover.set_state(self.bodies[number], state)
            case None:
                pass
            case _:
                assert_never(self._mover)

    def _changed(self) -> None:
        self.at_start = False
        self._look()

    def _look(self) -> None:
        """The state anew, after something was done to it."""
        self.state = replace(self.state, bodies=self._now())
        if self.at_start:
            self.previous = self.state


def between(previous: WorldState, state: WorldState, fraction: float) -> tuple[Pose, ...]:
    """Poses of the same bodies `fraction` (0 to 1) of the way from one state to another."""
    return tuple(_between(start, end, fraction) for start, end in zip(previous.bodies, state.bodies, strict=True))


def _between(start: BodyState, end: BodyState, fraction: float) -> Pose:
    orientation = slerp(start.orientation, end.orientation, fraction)
    if fraction == 1 or start.position == end.position:  # a + (b - a) need not be b
        return Pose(end.position, orientation)
    x, y, z = (a + (b - a) * fraction for a, b in zip(start.position, end.position, strict=True))
    return Pose((x, y, z), orientation)


def _clearance(body: Body, state: BodyState) -> float:
    """Of the lowest vertex above the floor, R."""
    up = rotate_back(state.orientation, (0.0, 1.0, 0.0))
    lowest = float((polyhedron_of(body.shape).vertices @ up).min()) * body.scale
    return state.position[1] + lowest - FLOOR.offset


def _different(bodies: Sequence[Body]) -> None:
    names = [body.name for body in bodies]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(f"each stone has an id of its own; got {twice!r} more than once", "stones")


def _without(items: tuple[T, ...], number: int) -> tuple[T, ...]:
    return items[:number] + items[number + 1 :]


def _with(items: tuple[T, ...], number: int, item: T) -> tuple[T, ...]:
    return (*items[:number], item, *items[number + 1 :])

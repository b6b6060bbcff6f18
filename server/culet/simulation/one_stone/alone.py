"""One stone, moved by the models of one stone, in a world's units.

Those models know a stone of R = 1 on a floor at y = -1. A stone of another scale is simulated in units of its own
radius, seen from the point (0, -1, 0) of the floor: positions, velocities and gravity are divided by the scale, the law
is the same. A scale of 1 changes no bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from culet.scene.motion import MotionLaws
from culet.simulation.bodies import REST, Body, BodyState
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState, Touch, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface


class Alone:
    """Mutable: a `Simulation`, and whether its stone is held."""

    def __init__(self, law: MotionLaws, body: Body, surfaces: Sequence[Surface]) -> None:
        """At the start. InputError for an inertia that cannot be used."""
        self._law, self._body, self._held = law, body, False
        start = self._from_world(body.position)
        self._one = Simulation(_settings(law, body), body.shape, start, body.orientation, self._surfaces(surfaces))

    @property
    def simulation(self) -> Simulation:
        """In units of the stone's radius."""
        return self._one

    def prepare(self) -> None:
        """Compute what all steps need."""
        self._one.prepare()

    def step(self) -> None:
        """Advance by one fixed step; held, only time passes."""
        if not self._held:
            self._one.step()
            return
        state = self._one.state
        self._one.previous = state
        self._one.state = replace(state, step=state.step + 1, time=state.time + self._law.time_step)

    def state(self) -> BodyState:
        """Now."""
        return self.state_of(self._one.state)

    def state_of(self, state: RigidState) -> BodyState:
        """One of the simulation's states, in the world's units."""
        body, scale = self._one.body, self._body.scale
        return BodyState(
            self._to_world(state.position),
            state.orientation,
            _times(body.velocity(state), scale),
            body.angular_velocity(state),
            state.asleep,
            self._held,
        )

    def set_law(self, law: MotionLaws) -> None:
        """Another law, which may be another model; asleep, it wakes just if it would move. InputError, and nothing
        changed, if it cannot be used."""
        self._one.adjust(_settings(law, self._body))
        self._law = law

    def set_surfaces(self, surfaces: Sequence[Surface]) -> None:
        """Other surfaces; asleep, it wakes just if it would move."""
        self._one.surround(self._surfaces(surfaces))

    def set_body(self, body: Body) -> None:
        """Another mass, restitution or friction; velocity and spin stay."""
        self._one.adjust(_settings(self._law, body))
        self._body = body

    def set_state(self, state: BodyState) -> None:
        """Put it somewhere else, or make it move otherwise; awake unless it is said to sleep."""
        self._held = state.held
        body, velocity = self._one.body, REST if state.held else _times(state.velocity, 1 / self._body.scale)
        x, y, z = velocity
        self._one.state = replace(
            self._one.state,
            position=self._from_world(state.position),
            orientation=state.orientation,
            momentum=(x * body.mass, y * body.mass, z * body.mass),
            angular_momentum=body.angular_momentum(state.orientation, REST if state.held else state.spin),
            asleep=state.asleep,
        )

    def set_time(self, step: int, time: float) -> None:
        """Go on counting from there."""
        self._one.state = replace(self._one.state, step=step, time=time)
        self._one.previous = self._one.state

    def push(self, impulse: Triple, point: Triple) -> None:
        """Strike it at a point of the world (R) with an impulse (mass R/s)."""
        self._one.push(_times(impulse, 1 / self._body.scale), self._from_world(point))

    def touch(self) -> Touch:
        """How it meets the surfaces, R."""
        contacts, penetration, clearance = self._one.touch()
        return Touch(contacts, penetration * self._body.scale, clearance * self._body.scale)

    def save(self) -> dict[str, Any]:
        """All that the future depends on besides law, surfaces and body, as JSON's types."""
        return self._one.snapshot() | {"held": self._held}

    def load(self, saved: dict[str, Any]) -> None:
        """Go on from what `save` gave; InputError, and nothing changed, if it is none."""
        self._one.restore({name: value for name, value in saved.items() if name != "held"})
        self._held = bool(saved.get("held"))

    def _surfaces(self, surfaces: Sequence[Surface]) -> tuple[Surface, ...]:
        """n . x >= d is n . (x - c) >= d - n . c, with c the point of the floor."""
        if self._body.scale == 1:
            return tuple(surfaces)
        _, floor, _ = ORIGIN
        return tuple(
            Surface(normal, (offset - normal[1] * floor) / self._body.scale + normal[1] * floor)
            for normal, offset in surfaces
        )

    def _from_world(self, point: Triple) -> Triple:
        return point if self._body.scale == 1 else _about_floor(point, 1 / self._body.scale)

    def _to_world(self, point: Triple) -> Triple:
        return point if self._body.scale == 1 else _about_floor(point, self._body.scale)


def _settings(law: MotionLaws, body: Body) -> SimulationSettings:
    return SimulationSettings.model_construct(
        **{name: getattr(law, name) for name in MotionLaws.model_fields}
        | {
            "mass": body.mass,
            "velocity": _times(body.velocity, 1 / body.scale),
            "spin": body.spin,
            "restitution": body.restitution_by(law),
            "friction": body.friction_by(law),
            "gravity": law.gravity / body.scale,
        }
    )


ORIGIN: Triple = (0.0, FLOOR.offset, 0.0)
"""Of the floor: it is at the same height in all units."""


def _about_floor(point: Triple, factor: float) -> Triple:
    x, y, z = (a + factor * (b - a) for a, b in zip(ORIGIN, point, strict=True))
    return (x, y, z)


def _times(v: Triple, factor: float) -> Triple:
    return v if factor == 1 else (v[0] * factor, v[1] * factor, v[2] * factor)

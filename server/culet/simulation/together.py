"""Several stones, moved by the compiled solver (`solver/`): each touches the surfaces and all others."""

from __future__ import annotations

import base64
import binascii
import ctypes
import math
import threading
import weakref
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from culet.errors import InputError, TooLargeError
from culet.scene.motion import MotionLaws
from culet.simulation.bodies import Body, BodyState
from culet.simulation.one_stone.simulation import MAX_SPEED
from culet.simulation.rigid_body.body import angular_momentum_of, inertia_of
from culet.simulation.rigid_body.principal_axes import principal_axes
from culet.simulation.rigid_body.state import Touch, Triple
from culet.simulation.rigid_body.surfaces import Surface
from culet.simulation.solver import interface
from culet.simulation.solver.library import library
from culet.simulation.solver.polyhedron import polyhedron_of

MAX_BODIES = 64


@dataclass(frozen=True)
class SolverEffort:
    """How finely the solver works: what is not a scene's to choose."""

    substeps: int = 8
    """Of a fixed step, at least. Fewer: impacts of heaps overlap more (4: 3e-4 R instead of 7e-5 R for 12 stones)."""
    sweeps: int = 20
    """Over all contacts in a substep, at most."""


class Together:
    """Mutable, and safe to be used by several threads: one waits for the other."""

    def __init__(
        self, law: MotionLaws, bodies: Sequence[Body], surfaces: Sequence[Surface], effort: SolverEffort | None = None
    ) -> None:
        """At the start. TooLargeError for too many bodies, InputError for a model or an inertia that cannot be used,
        SolverUnavailableError if there is no solver."""
        self._library = library()
        self._lock = threading.RLock()
        self._effort = effort or SolverEffort()
        self._law = _checked(law)
        self._bodies: list[Body] = []
        world = self._library.culet_world_new(MAX_BODIES)
        if world is None:
            raise MemoryError("a world of stones")
        self._world = ctypes.c_void_p(world)
        # At the process's end it stays: a daemon thread may still be stepping it.
        weakref.finalize(self, self._library.culet_world_free, self._world).atexit = False
        self.set_law(law)
        self.set_surfaces(surfaces)
        for body in bodies:
            self.add(body, BodyState.start_of(body))

    def step(self) -> None:
        """Advance by one fixed step. MemoryError if there are more contacts than memory."""
        with self._lock:
            if self._library.culet_world_step(self._world, self._law.time_step):
                raise MemoryError("the contacts of a step")

    def states(self) -> tuple[BodyState, ...]:
        """Of all bodies, in their order."""
        with self._lock:
            found = (interface.CuletState * len(self._bodies))()
            self._library.culet_world_states(self._world, found)
        numbers = np.frombuffer(memoryview(found).cast("B"), np.float64).reshape(len(found), -1)[:, :16].tolist()
        marks = (
            np.frombuffer(memoryview(found).cast("B"), np.int32).reshape(len(found), -1)[:, -2:].astype(bool).tolist()
        )
        return tuple(
            BodyState((x, y, z), (a, b, c, d), (u, v, w), (p, q, r), asleep, held)
            for (x, y, z, a, b, c, d, u, v, w, _, _, _, p, q, r), (asleep, held) in zip(numbers, marks, strict=True)
        )

    def set_law(self, law: MotionLaws) -> None:
        """Another gravity, or whatever else of the law; wakes all. InputError, and nothing changed, if it cannot be."""
        _checked(law)
        given = interface.CuletLaw(
            gravity=law.gravity,
            bounce_speed=law.bounce_speed,
            contact_step=law.contact_step,
            rolling_resistance=law.rolling_resistance,
            sleeping=law.sleeping,
            substeps=self._effort.substeps,
            sweeps=self._effort.sweeps,
        )
        with self._lock:
            properties = [_properties(body, law) for body in self._bodies]
            self._law = law
            self._library.culet_world_set_law(self._world, ctypes.byref(given))
            for number, each in enumerate(properties):
                self._library.culet_world_set_body(self._world, number, ctypes.byref(each))

    def set_surfaces(self, surfaces: Sequence[Surface]) -> None:
        """Other surfaces; wakes all."""
        if len(surfaces) > interface.MAX_SURFACES:
            raise TooLargeError(f"at most {interface.MAX_SURFACES} surfaces stop stones; got {len(surfaces)}")
        planes = [number for surface in surfaces for number in (*surface.normal, surface.offset)]
        with self._lock:
            self._library.culet_world_set_surfaces(self._world, len(surfaces), _doubles(planes))

    def add(self, body: Body, state: BodyState) -> None:
        """A further body, after those that there are. TooLargeError beyond MAX_BODIES."""
        shape = _Shape(body)
        properties, moving = _properties(body, self._law), _given(body, self._law, state)
        with self._lock:
            number = self._library.culet_world_add(
                self._world, ctypes.byref(shape.hull), ctypes.byref(properties), ctypes.byref(moving)
            )
            if number == interface.NO_MEMORY:
                raise MemoryError("a further stone")
            if number == interface.NO_ROOM:
                raise TooLargeError(f"at most {MAX_BODIES} stones can move; got one more", "stones")
            self._bodies.append(body)

    def remove(self, name: str) -> None:
        """What it carried, or slept with it, wakes."""
        with self._lock:
            number = self._number(name)
            self._library.culet_world_remove(self._world, number)
            del self._bodies[number]

    def set_body(self, body: Body) -> None:
        """Another mass, restitution or friction; velocity and spin stay."""
        properties = _properties(body, self._law)
        with self._lock:
            number = self._number(body.name)
            self._library.culet_world_set_body(self._world, number, ctypes.byref(properties))
            self._bodies[number] = body

    def set_state(self, body: Body, state: BodyState) -> None:
        """Put it somewhere else, or make it move otherwise; awake."""
        moving = _given(body, self._law, state)
        with self._lock:
            number = self._number(body.name)
            self._library.culet_world_set_state(self._world, number, ctypes.byref(moving))
            self._library.culet_world_hold(self._world, number, state.held)

    def push(self, body: Body, state: BodyState, impulse: Triple, point: Triple) -> None:
        """Strike a body in that state at a point of the world (R) with an impulse (mass R/s); it wakes.

        InputError if any of its points would move at more than MAX_SPEED.
        """
        x, y, z = (a - b for a, b in zip(point, state.position, strict=True))
        a, b, c = impulse
        _, inverse = inertia_of(self._law.inertia, body.shape, body.mass * body.scale**2)
        turned = angular_momentum_of(inverse, state.orientation, (y * c - z * b, z * a - x * c, x * b - y * a))
        velocity = math.hypot(*(v + p / body.mass for v, p in zip(state.velocity, impulse, strict=True)))
        spin = math.hypot(*(v + w for v, w in zip(state.spin, turned, strict=True)))
        if velocity + spin * body.scale > MAX_SPEED:
            raise InputError(f"a push makes a stone move at {MAX_SPEED:g} R/s at most; got {impulse}", "impulse")
        with self._lock:
            number = self._number(body.name)
            self._library.culet_world_push(self._world, number, _doubles(impulse), _doubles(point))

    def touches(self) -> tuple[Touch, ...]:
        """How each body met surfaces and others in the last substep; the clearance is not known here: 0."""
        with self._lock:
            found = (interface.CuletTouch * len(self._bodies))()
            self._library.culet_world_touches(self._world, found)
        return tuple(Touch(each.contacts, each.penetration, 0.0) for each in found)

    def separation(self, one: str, other: str, enough: float = math.inf) -> tuple[float, Triple]:
        """Signed distance of two bodies' hulls along the best axis, R: negative is how deep they overlap. And that
        axis, of length 1, in the world, from the one towards the other.

        Above `enough` a lower bound of it.
        """
        axis = (ctypes.c_double * 3)()
        with self._lock:
            first, second = self._number(one), self._number(other)
            distance: float = self._library.culet_world_separation(self._world, first, second, enough, axis)
        x, y, z = axis
        return distance, (x, y, z)

    def _number(self, name: str) -> int:
        return next(number for number, body in enumerate(self._bodies) if body.name == name)

    def save(self) -> str:
        """All that the future depends on besides law, surfaces and bodies, as text."""
        with self._lock:
            content = ctypes.create_string_buffer(self._library.culet_world_size(self._world))
            self._library.culet_world_save(self._world, content)
        return base64.b64encode(content.raw).decode()

    def load(self, saved: str) -> None:
        """Go on from what `save` gave, to the same bits; InputError, and nothing changed, if it is of no such world."""
        try:
            content = base64.b64decode(saved, validate=True)
        except (binascii.Error, ValueError) as error:
            raise InputError(f"simulation snapshot: expected base64; got {error}", "contacts") from error
        with self._lock:
            fault = self._library.culet_world_load(self._world, content, len(content))
        if fault == interface.NO_MEMORY:  # -1: not of this world
            raise InputError(
                f"simulation snapshot: expected one of {len(self._bodies)} stones between the same surfaces, saved by "
                f"solver version {interface.VERSION}",
                "contacts",
            )
        if fault:
            raise MemoryError("the contacts of a snapshot")


def _checked(law: MotionLaws) -> MotionLaws:
    if law.model == "classic":
        raise InputError(
            "the model classic moves one stone; got several: choose simulation.model rigid", "simulation.model"
        )
    return law


def _doubles(numbers: Sequence[float]) -> ctypes.Array[ctypes.c_double]:
    return (ctypes.c_double * len(numbers))(*numbers)


class _Shape:
    """A body's hull for the solver, and the arrays that it points to: they live as long as it does."""

    def __init__(self, body: Body) -> None:
        found = self._polyhedron = polyhedron_of(body.shape)
        self._vertices = np.ascontiguousarray(found.vertices * body.scale)
        self._planes = found.planes * (1.0, 1.0, 1.0, body.scale)
        self.hull = interface.CuletHull(
            len(found.vertices),
            len(found.planes),
            len(found.edges),
            self._vertices.ctypes.data_as(interface.Doubles),
            self._planes.ctypes.data_as(interface.Doubles),
            found.first.ctypes.data_as(interface.Integers),
            found.corners.ctypes.data_as(interface.Integers),
            found.edges.ctypes.data_as(interface.Integers),
        )


def _properties(body: Body, law: MotionLaws) -> interface.Properties:
    inertia, inverse = inertia_of(law.inertia, body.shape, body.mass * body.scale**2)
    axes = principal_axes(inertia)
    return interface.Properties(
        body.mass,
        (ctypes.c_double * 9)(*(c for row in inertia for c in row)),
        (ctypes.c_double * 9)(*(c for row in inverse for c in row)),
        (ctypes.c_double * 9)(*(c for axis in axes for c in axis.direction)),
        (ctypes.c_double * 3)(*(axis.moment for axis in axes)),
        body.restitution_by(law),
        body.friction_by(law),
    )


def angular_momentum_by(body: Body, law: MotionLaws, state: BodyState) -> Triple:
    """World axes, mass R^2/s."""
    inertia, _ = inertia_of(law.inertia, body.shape, body.mass * body.scale**2)
    return angular_momentum_of(inertia, state.orientation, state.spin)


def _given(body: Body, law: MotionLaws, state: BodyState) -> interface.CuletState:
    momentum = angular_momentum_by(body, law, state)
    return interface.CuletState(
        state.position, state.orientation, state.velocity, momentum, state.spin, state.asleep, state.held
    )

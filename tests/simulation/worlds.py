"""Worlds of the tests of several stones."""

from __future__ import annotations

from collections.abc import Sequence

from culet.simulation.bodies import Body
from culet.simulation.rigid_body.surfaces import FLOOR, Surface
from culet.simulation.world import World
from culet.study.contacts.worlds import law


def world(bodies: Sequence[Body], surfaces: Sequence[Surface] = (FLOOR,), **settings: object) -> World:
    """With nothing but Coulomb's friction; each test says what else there is."""
    return World(bodies, surfaces, law(**settings))

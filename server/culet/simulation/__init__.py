"""Rigid bodies: state, integrators, contact."""

from culet.simulation.clock import Allowance, FixedStepClock, Pace
from culet.simulation.paths import StonePath, record, write
from culet.simulation.simulation import Simulation
from culet.simulation.state import RigidState
from culet.simulation.surfaces import Surface, surfaces_of

__all__ = [
    "Allowance",
    "FixedStepClock",
    "Pace",
    "RigidState",
    "Simulation",
    "StonePath",
    "Surface",
    "record",
    "surfaces_of",
    "write",
]

"""Rigid bodies: state, integrators, contact."""

from culet.simulation.clock import Allowance, FixedStepClock, Pace
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.recording.paths import StonePath, record, write
from culet.simulation.rigid_body.state import RigidState
from culet.simulation.rigid_body.surfaces import Surface, surfaces_of

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

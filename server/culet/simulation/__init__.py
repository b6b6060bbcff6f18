"""Rigid bodies: state, integrators, contact."""

from culet.simulation.clock import FixedStepClock
from culet.simulation.paths import Path, record, write
from culet.simulation.simulation import Simulation
from culet.simulation.state import RigidState

__all__ = ["FixedStepClock", "Path", "RigidState", "Simulation", "record", "write"]

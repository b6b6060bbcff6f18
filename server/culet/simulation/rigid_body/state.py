"""What a rigid body is at one instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

Triple = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Touch(NamedTuple):
    """How a stone meets the surfaces about it."""

    contacts: int
    """Points that touch."""
    penetration: float
    """How deep the deepest of them is inside, R."""
    clearance: float
    """Height of the stone's lowest vertex above the floor, R; negative: it is inside the floor."""


@dataclass(frozen=True)
class RigidState:
    """Immutable; plain floats, so that it goes to JSON and back without loss."""

    step: int
    """Fixed steps since the start."""
    time: float
    """s."""
    position: Triple
    """Of the centre of mass, R."""
    orientation: Quaternion
    """Unit quaternion w, x, y, z: stone's axes to world."""
    momentum: Triple
    """Linear momentum, mass R/s."""
    angular_momentum: Triple
    """About the centre of mass, in world axes, mass R^2/s."""
    impacts: int = 0
    """Hard impacts so far; with the seed it fixes the next random torque."""
    asleep: bool = False
    """At rest until something disturbs it."""
    coarse: int = 0
    """Steps so far with more events than were followed exactly (rigid)."""

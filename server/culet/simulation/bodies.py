"""What a world is told of its stones, and what it tells of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.scene.motion import MotionLaws
from culet.simulation.rigid_body.rotation import normalised
from culet.simulation.rigid_body.state import Quaternion, Triple

REST: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Body:
    """A stone that moves: its shape, its mass, and where and how it starts."""

    name: str
    """Of its own in a world."""
    shape: Shape
    position: Triple
    """Of the centre of mass at the start, R."""
    orientation: Quaternion
    """At the start; unit."""
    velocity: Triple = REST
    """At the start, R/s."""
    spin: Triple = REST
    """At the start, world axes, rad/s."""
    scale: float = 1.0
    """Radius of the placed stone, R."""
    mass: float = 1.0
    restitution: float | None = None
    """Between 0 and 1; None: the law's."""
    friction: float | None = None
    """Coulomb's coefficient; None: the law's."""

    def __post_init__(self) -> None:
        """InputError for a start that is none."""
        at = f"stone {self.name!r}"
        numbers = (*self.position, *self.orientation, *self.velocity, *self.spin)
        if not all(math.isfinite(c) for c in numbers):
            raise InputError(f"{at}: a start is finite; got {self.position}, {self.orientation}", "start")
        if not any(self.orientation):
            raise InputError(f"{at}: a quaternion of length 0 is no orientation", "start_orientation")
        if not (0 < self.scale < math.inf and 0 < self.mass < math.inf):
            raise InputError(f"{at}: expected a scale and a mass above 0; got {self.scale} and {self.mass}", "scale")
        if abs(sum(c * c for c in self.orientation) - 1) > 1e-12:  # normalising again would change the last bit
            object.__setattr__(self, "orientation", normalised(self.orientation))

    def restitution_by(self, law: MotionLaws) -> float:
        """Its own, or the law's."""
        return law.restitution if self.restitution is None else self.restitution

    def friction_by(self, law: MotionLaws) -> float:
        """Its own, or the law's."""
        return law.friction if self.friction is None else self.friction

    def like(self, other: Body) -> bool:
        """Whether the two are the same stone but for where and how they start."""
        return self._made() == other._made()

    def _made(self) -> tuple[object, ...]:
        return (self.name, self.shape, self.scale, self.mass, self.restitution, self.friction)


@dataclass(frozen=True)
class BodyState:
    """Where a stone is and how it moves; plain floats."""

    position: Triple
    """Of the centre of mass, R."""
    orientation: Quaternion
    """Unit quaternion w, x, y, z: stone's axes to world."""
    velocity: Triple
    """Of the centre of mass, R/s."""
    spin: Triple
    """World axes, rad/s."""
    asleep: bool = False
    """At rest until something disturbs it."""
    held: bool = False
    """Kept where it is: it stops others and does not fall."""

    @classmethod
    def start_of(cls, body: Body) -> Self:
        """As it begins."""
        return cls(body.position, body.orientation, body.velocity, body.spin)

    def at(self, position: Triple, orientation: Quaternion) -> BodyState:
        """The same elsewhere."""
        return replace(self, position=position, orientation=orientation)


@dataclass(frozen=True)
class WorldState:
    """All stones at one instant."""

    step: int
    """Fixed steps since the start."""
    time: float
    """s."""
    bodies: tuple[BodyState, ...]
    """In the order of the world's bodies."""

    @property
    def asleep(self) -> bool:
        """Whether no stone will move unless something disturbs one."""
        return all(body.asleep or body.held for body in self.bodies)


@dataclass(frozen=True)
class Pose:
    """What a picture needs."""

    position: Triple
    orientation: Quaternion

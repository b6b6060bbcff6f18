"""What moves one stone: the scene's laws of motion, and what of them is the stone's own."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field

from culet.geometry.shape import Shape
from culet.optics.densities import density_of
from culet.scene.fields import Vector
from culet.scene.model import SPIN, Scene
from culet.scene.motion import MotionLaws
from culet.scene.stone import CARATS_PER_GRAM, StoneSettings

GRAMS = 1e-6
"""In a cubic millimetre of 1 kg/m^3."""


class SimulationSettings(MotionLaws):
    """Laws of motion with one stone's restitution and friction, its mass, and how it starts."""

    mass: Annotated[float, Field(gt=0)] = 2
    """Carats."""
    spin: Vector = SPIN
    """rad/s, about the world's axes."""
    velocity: Vector = (0, 0, 0)
    """R/s."""

    @classmethod
    def of(cls, scene: Scene, settings: StoneSettings, shape: Shape) -> Self:
        """Those of a stone of the scene; `shape` has radius 1."""
        own = {name: value for name in ("restitution", "friction") if (value := getattr(settings, name)) is not None}
        laws = {name: getattr(scene.simulation, name) for name in MotionLaws.model_fields}
        mass = mass_of(settings, shape, scene.millimetres)
        return cls(**laws | own, mass=mass, spin=settings.spin, velocity=settings.velocity)


def mass_of(settings: StoneSettings, shape: Shape, millimetres: float) -> float:
    """Carats: the stone's own mass, or that of its shape, which has radius 1, by its density and size."""
    if settings.mass is not None:
        return settings.mass
    density = density_of(settings.material) if settings.density is None else settings.density
    volume = shape.mass.volume * (settings.scale * millimetres) ** 3
    return volume * density * GRAMS * CARATS_PER_GRAM

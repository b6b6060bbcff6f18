"""Light of one direction, or of one point: what shadows and caustics are made of."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LightRay:
    """A lamp is several of them, which share its light."""

    colour: tuple[float, float, float]
    """Irradiance over pi of a surface that faces it; of a point, at the middle of the stones."""
    towards: tuple[float, float, float] | None = None
    """Unit vector to a light that is infinitely far away; None of a point."""
    position: tuple[float, float, float] | None = None
    """Of a point, in the world, R."""
    follows: bool = True
    """Into the stones and out again; else it only makes shadows."""
    gauges: bool = False
    """Into the stones, coarsely, to find what part of its emitter's light goes through them into its shadows: that much
    less is taken there. For lamps that make no flecks; one ray of them is enough."""
    emitter: int = 0
    """Whose it is: rays of one emitter share its light."""

    @property
    def brightness(self) -> float:
        """Mean of the channels."""
        return sum(self.colour) / 3

"""Light of one direction, or from one point."""

from __future__ import annotations

from dataclasses import dataclass

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Ray:
    """Light that comes from one direction of the sky, or from one point of the room."""

    towards: Triple | None
    """Of unit length, the way to where it comes from; None: from a point."""
    position: Triple | None
    """Of the point, R; None: from infinity."""
    colour: Triple
    """Irradiance over pi of what faces it, by channel."""
    follows: bool
    """Whether it is followed through the stones; else it only throws a shadow."""
    emitter: int
    """Its number among the sources."""

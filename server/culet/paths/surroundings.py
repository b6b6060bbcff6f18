"""What a ray that meets no stone any more sees, in double precision: which lamps, and how much of its light each makes.

The kernel says how much light there is; here it is divided among what gives it, by the same formulas as sky.cl has.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.paths.answer import Met, Side
from culet.scene.emitters import BoxLamp, PointLight
from culet.scene.model import Scene

Array = NDArray[np.float64]

OVERHEAD = 0.8
"""Sine of the elevation from which a lamp is above all sides: 53 degrees."""
UPRIGHT = 1e-3
"""Length of a horizontal part below which a direction has none."""
WALLS: tuple[Met, ...] = ("floor", "middle-wall", "left-wall", "right-wall")
"""By the surfaces' numbers: floor.y = -1, then WALL_NORMALS of scene/room.py as the default camera sees them."""


def smoothstep(share: float) -> float:
    """Of a share that is cut to 0 and 1."""
    s = min(max(share, 0.0), 1.0)
    return s * s * (3 - 2 * s)


class RaySurroundings:
    """Of one scene, from what its kernel was told."""

    def __init__(self, scene: Scene, parameters: NDArray[np.void]) -> None:
        self._p = parameters
        shown = enumerate(scene.emitters if scene.shown_lamps else ())
        lamps = [(number, lamp) for number, lamp in shown if not isinstance(lamp, PointLight)]
        self._discs = [number for number, lamp in lamps if not isinstance(lamp, BoxLamp)]
        self._boxes = [number for number, lamp in lamps if isinstance(lamp, BoxLamp)]

    def radiance_by_source(self, direction: Array, *, by_stone: bool) -> list[tuple[Met, int | None, Array]]:
        """What is seen in a direction besides the bare sky: lamps with their numbers, and the observer's head, which
        only stones see. (3,) radiance each, those that show none left out."""
        p = self._p
        lamps: list[tuple[Met, int | None, Array]] = []
        for k, number in enumerate(self._discs):
            share = smoothstep(float(p["lamp_rim"][k] - p["lamp_slope"][k] * _squared(direction - p["lamp"][k])))
            lamps.append(("lamp", number, share * p["lamp_radiance"][k].astype(float)))
        for k, number in enumerate(self._boxes):
            way = p["box"][k].astype(float) @ direction
            edge, level = p["box_edge"][k].astype(float), p["box_level"][k].astype(float)
            across, up = (min(max(edge[i] * way[0] - abs(way[1 + i]), 0.0), 1.0) for i in range(2))
            share = smoothstep(across * up) * (level[0] + level[1] * way[2])
            lamps.append(("lamp", number, share * p["box_radiance"][k].astype(float)))
        hidden = self.head(direction) if by_stone else 0.0
        found: list[tuple[Met, int | None, Array]] = [
            (met, number, (1 - hidden) * radiance) for met, number, radiance in lamps if radiance.any()
        ]
        if hidden > 0:
            found.append(("head", None, hidden * p["head_radiance"].astype(float)))
        return found

    def head(self, direction: Array) -> float:
        """The part of the sky that the observer's head hides there."""
        p = self._p
        if not p["has_head"]:
            return 0.0
        return smoothstep(float(p["head_rim"] - p["head_slope"] * _squared(direction - p["head"])))


def _squared(vector: Array) -> float:
    return float(vector @ vector)


def side_of(towards: Array, forward: Array, up: Array) -> Side:
    """Where a direction is for who looks along `forward`: above or below, or else to one of four sides. Who looks
    straight down has ahead what is at the upper edge of the picture."""
    towards = towards / np.linalg.norm(towards)
    if abs(towards[1]) > OVERHEAD:
        return "above" if towards[1] > 0 else "below"
    ahead = forward * (1, 0, 1)
    if np.linalg.norm(ahead) < UPRIGHT:
        ahead = up * (1, 0, 1)
    ahead = ahead / np.linalg.norm(ahead)
    right = np.array([-ahead[2], 0.0, ahead[0]])  # ahead x (0, 1, 0)
    along, across = float(towards @ ahead), float(towards @ right)
    if abs(along) >= abs(across):
        return "ahead" if along > 0 else "behind"
    return "right" if across > 0 else "left"

"""Light maps by beams, as tests make them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.emitters.light_map import Figures, MapFrame, frame_of
from culet.rendering.emitters.ray import LightRay
from culet.rendering.light.beams import Beams, BeamTally
from culet.scene import Scene
from shared.stages import staged

Array = NDArray[np.float64]

DARK: dict[str, Any] = {
    "floor": {"kind": "matte"},
    "environment": {"kind": "constant", "radiance": [0, 0, 0]},
    "emitters": [{"shape": "point", "position": [0, 5, 0], "colour": [1, 1, 1]}],
}
"""A matte floor; the light that tests throw is their own."""
UPRIGHT: dict[str, Any] = {"position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
SLANTED = (-4 / math.sqrt(68), 6 / math.sqrt(68), 4 / math.sqrt(68))


class Thrown(NamedTuple):
    """A map, and what is known of it."""

    map: Array
    """By surface, level, row, column and channel."""
    frame: MapFrame
    tally: BeamTally
    figures: Figures

    def at(self, u: float, v: float, surface: int = 0) -> Array:
        """(3,) of the finer level's texel at a place of a surface."""
        columns, rows = self.frame.texels(surface, 0)
        row, column = int(abs(rows - v).argmin()), int(abs(columns - u).argmin())
        return np.asarray(self.map[surface, 0, row, column])

    def lost(self) -> float:
        """What of the incident light is not accounted for, as part of it."""
        t = self.tally
        found = t.landed + t.outside + t.away + t.behind + t.absorbed + t.cut + t.unresolved
        return (found - t.incident) / t.incident if t.incident else found


def sun(towards: Sequence[float] | Array = SLANTED, colour: tuple[float, float, float] = (1, 1, 1)) -> LightRay:
    """Parallel light."""
    x, y, z = np.array(towards) / np.linalg.norm(towards)
    return LightRay(colour, towards=(float(x), float(y), float(z)))


def lamp(position: tuple[float, float, float] = (-4, 6, 4)) -> LightRay:
    """Light of a point."""
    return LightRay((1, 1, 1), position=position)


def sun_from(degrees: float) -> LightRay:
    """Parallel light, so far from vertical, that goes towards +x."""
    angle = math.radians(degrees)
    return sun((-math.sin(angle), math.cos(angle), 0))


def thrown(
    beams: Beams,
    rays: Sequence[LightRay],
    shape: Shape | None = None,
    *,
    stones: Sequence[dict[str, Any]] = ({},),
    cutoff: float = 1e-3,
    halves: tuple[float, float] | None = None,
    number: int = 0,
    **scene: object,
) -> Thrown:
    """The light of these rays, thrown by stones of that shape; `halves` in place of the frame's own sizes."""
    stage = staged(Scene.read({**DARK, **scene, "stones": list(stones)}), shape)
    frame = frame_of(stage)
    if halves is not None:
        frame = MapFrame(frame.matte, frame.middle, frame.centres, halves)
    target = cl.Buffer(beams.device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    figures = beams.make(stage, rays, frame, target, cutoff=cutoff, number=number)
    made = np.empty(frame.shape, np.float32)
    cl.enqueue_copy(beams.device.queue, made, target)
    assert beams.tally is not None
    return Thrown(made.astype(float), frame, beams.tally, figures)

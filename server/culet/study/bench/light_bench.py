"""`culet bench`, of the light that stones throw: maps, and a moving frame with its map or with shadows alone."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import pyopencl as cl

from culet.rendering.emitters.light_map import frame_of
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.sources import rays_of
from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import Renderer
from culet.scene.emitters import PointLight, Sun
from culet.scene.legacy import LEGACY_DEFAULT, LEGACY_POINTS
from culet.scene.model import Scene
from culet.scene.room import Plane
from culet.stage import Stage

MAP_CUTOFF = 1e-3
"""Of the maps, so coarse that what each pass takes besides its beams shows. Frames have their scene's own."""
BESIDE = (-4.0, 6.0, 4.0)
OUT_OF_REACH = 1e-3
"""Half size of a coarser level, R, that hardly any light lands on: what a map of one level takes."""

MATTE = LEGACY_DEFAULT.model_copy(update={"floor": Plane(kind="matte")})
"""A diamond that floats over a matte floor."""
LIT = MATTE.model_copy(update={"emitters": (*LEGACY_POINTS, Sun(direction=(1, 0.8, 1), colour=(2, 2, 2)))})
"""Under two points and a sun."""


@dataclass(frozen=True)
class LightTiming:
    """Of a map, or of a frame with its map."""

    name: str
    seconds: float
    """Median."""
    processor_seconds: float
    """Median of all cores' time together."""
    ratio: float
    """Median processor time over that of the first map, or of the first frame."""
    beams: float | None
    """That were followed; None of a frame."""


def measure_light(renderer: Renderer, width: int, height: int, repeats: int) -> list[LightTiming]:
    """Each kind's entries in turns: a parallel light's maps and a point's; then frames without caustics and with."""
    beams = {name: Beams(renderer.device) for name in ("one", "both", "point")}
    parallel = MATTE.model_copy(update={"emitters": (Sun(direction=BESIDE, colour=(1, 1, 1)),)})
    point = MATTE.model_copy(update={"emitters": (PointLight(position=BESIDE, colour=(1, 1, 1)),)})
    maps = {
        "map, parallel light, one level": _map(renderer, parallel, beams["one"], levels=1),
        "map, parallel light": _map(renderer, parallel, beams["both"]),
        "map, point light": _map(renderer, point, beams["point"]),
    }
    shadows = LIT.optics.model_copy(update={"caustics": "off"})
    frames = {
        "frame, two points and a sun, shadows alone": _frame(
            renderer, LIT.model_copy(update={"optics": shadows}), width, height
        ),
        "frame, two points and a sun, caustics": _frame(renderer, LIT, width, height),
    }
    counts = [each.tally.beams if each.tally else 0.0 for each in beams.values()]
    return [*_timed(maps, counts, repeats), *_timed(frames, [None] * len(frames), repeats)]


def _map(renderer: Renderer, scene: Scene, beams: Beams, levels: int = 2) -> Callable[[int], None]:
    stage, device = Stage.of(scene), renderer.device
    frame = frame_of(stage)
    if levels == 1:
        frame = replace(frame, halves=(frame.halves[0], OUT_OF_REACH))
    target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    rays: list[LightRay] = rays_of(stage, 0)

    def run(number: int) -> None:
        del number
        beams.make(stage, rays, frame, target, cutoff=MAP_CUTOFF)

    run(0)  # compiled, and warm
    return run


def _frame(renderer: Renderer, scene: Scene, width: int, height: int) -> Callable[[int], None]:
    """Of a stone that has moved since the frame before."""
    first = Stage.of(scene)

    def run(number: int) -> None:
        (stone,) = scene.stones
        x, y, z = stone.position
        moved = scene.model_copy(update={"stones": (stone.model_copy(update={"position": (x, y + 1e-3 * number, z)}),)})
        renderer.lighting.forget()
        renderer.picture(first.showing(moved), width, height, effort=LightEffort.MOVING).refine(1)

    run(0)
    run(0)
    return run


def _timed(runs: dict[str, Callable[[int], None]], beams: Sequence[float | None], repeats: int) -> list[LightTiming]:
    walls: dict[str, list[float]] = {name: [] for name in runs}
    processors: dict[str, list[float]] = {name: [] for name in runs}
    for number in range(repeats):
        for name, run in runs.items():
            wall, processor = time.perf_counter(), time.process_time()
            run(number + 1)
            walls[name].append(time.perf_counter() - wall)
            processors[name].append(time.process_time() - processor)
    plainest = statistics.median(next(iter(processors.values())))
    return [
        LightTiming(
            name, statistics.median(walls[name]), statistics.median(processors[name]),
            statistics.median(processors[name]) / plainest, count,
        )
        for name, count in zip(runs, beams, strict=True)
    ]  # fmt: skip

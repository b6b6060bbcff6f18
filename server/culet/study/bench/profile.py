"""`culet bench --profile`: where the processor time of a moving frame goes, and what share of the machine's limit.

Time is the processor's, of all cores together, which other work on the machine does not lengthen much; limits are by
processor time too. Work is counted, never estimated from time: segments by the kernel, bytes by the pictures' sizes.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from culet.engine.painting import jpeg
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import DevicePicture, Renderer
from culet.rendering.stones.facet_rows import facet_rows, search_cost
from culet.scene.model import Scene
from culet.study.bench.cases import stage_of
from culet.study.bench.roofline import Roofline, measure_roofline

T = TypeVar("T")

PROFILED = "checker", "default", "default, twelve stones"
"""Of the benchmark's cases."""
FLOPS_PER_INSTRUCTION = 2
"""Of a multiply-add, by which the limit of instructions is measured: the search for facets is mostly those."""
SUM_BYTES = 16
"""Of a pixel's sums: four numbers of single precision, one of them not used."""
SHOWN_BYTES = 3
"""Of a pixel as it is shown."""


@dataclass(frozen=True)
class StageCost:
    """Of one frame of one sample a pixel."""

    name: str
    seconds: float
    """Of processors, median."""
    work: str
    """That was counted, in words."""
    instructions: float | None = None
    """Counted, each for one lane; None: they are not what is counted."""
    bytes: float | None = None
    """Read and written, counted; None: they are not what is counted."""

    def share(self, limits: Roofline) -> float | None:
        """Part of its time that its counted work takes at the measured limit; None: nothing was counted."""
        if self.instructions is not None:
            return self.instructions / (limits.single_flops / FLOPS_PER_INSTRUCTION) / self.seconds
        if self.bytes is not None:
            return self.bytes / limits.bandwidth_per_second / self.seconds
        return None


@dataclass(frozen=True)
class Profile:
    """Of one case."""

    name: str
    stages: tuple[StageCost, ...]
    limits: Roofline
    """Of a second of one processor."""

    @property
    def seconds(self) -> float:
        """Of processors, of all stages."""
        return sum(stage.seconds for stage in self.stages)


class _Spent:
    """Processor seconds of stages, frame after frame."""

    def __init__(self) -> None:
        self._spent = dict[str, list[float]]()

    def on(self, name: str, call: Callable[[], T]) -> T:
        """What a call returns; its time is the stage's."""
        before = time.process_time()
        result = call()
        self.add(name, time.process_time() - before)
        return result

    def add(self, name: str, seconds: float) -> None:
        self._spent.setdefault(name, []).append(seconds)

    def median(self, name: str) -> float:
        return statistics.median(self._spent[name])


def measure_profile(
    renderer: Renderer, cases: dict[str, Scene], width: int, height: int, repeats: int
) -> Iterator[Profile]:
    """Of each case by itself. Each frame is of a stage that was not seen before, as while stones move."""
    limits = measure_roofline(renderer.device, clock=time.process_time)
    for name, scene in cases.items():
        yield Profile(name, tuple(stages(renderer, scene, width, height, repeats)), limits)


def stages(renderer: Renderer, scene: Scene, width: int, height: int, repeats: int) -> Iterator[StageCost]:
    """Those of a frame, in their order; medians of `repeats`."""
    stage, spent = stage_of(scene), _Spent()
    picture = renderer.picture(stage, width, height, effort=LightEffort.MOVING)
    for count in range(repeats + 1):
        frames = _Spent() if count == 0 else spent  # the first frame pays for programs, pages and caches
        picture = renderer.picture(replace(stage), width, height, effort=LightEffort.MOVING)
        frames.on("prepare", picture.prepare)
        whole = _Spent()
        whole.on("refine", picture.refine)
        lit = picture.light_seconds / max(picture.light_seconds + picture.seconds, 1e-9)
        frames.add("light", lit * whole.median("refine"))
        frames.add("trace", (1 - lit) * whole.median("refine"))
        rgb = frames.on("develop", picture.softened)
        frames.on("encode", partial(jpeg.encode, rgb, jpeg.MOVING_QUALITY))
    pixels = width * height
    data = len(jpeg.encode(picture.softened(), jpeg.MOVING_QUALITY))
    yield StageCost("preparing, on the host", spent.median("prepare"), "")
    if picture.light_seconds > 0:
        yield StageCost("map of the light", spent.median("light"), "")
    yield _tracing(picture, scene, spent.median("trace"))
    developing = f"{pixels} pixels: sums read, bytes written, filtered and read back"
    yield StageCost("developing", spent.median("develop"), developing, bytes=pixels * (SUM_BYTES + 5 * SHOWN_BYTES))
    yield StageCost(
        f"JPEG of quality {jpeg.MOVING_QUALITY}", spent.median("encode"), f"bytes read, {data} written",
        bytes=pixels * SHOWN_BYTES + data,
    )  # fmt: skip


def _tracing(picture: DevicePicture, scene: Scene, seconds: float) -> StageCost:
    """The kernel. What it takes to find the facet ahead is known where all stones have the same cut."""
    segments = picture.segments()
    name, counted = "tracing", f"{segments} segments inside stones"
    cost = _search_cost(scene)
    if cost is None or segments == 0:
        return StageCost(name, seconds, counted)
    work = f"{counted}, {cost:g} instructions each for the facet ahead"
    return StageCost(name, seconds, work, instructions=cost * segments)


def _search_cost(scene: Scene) -> float | None:
    """Instructions, if the stones are convex and all cost as much."""
    costs = {search_cost(facet_rows(shape)) if shape.convex else None for shape in stage_of(scene).shapes}
    return costs.pop() if len(costs) == 1 else None

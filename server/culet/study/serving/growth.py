"""The study of growth: how cost grows with a picture's pixels, a stone's facets, a scene's bounces, wavelengths, stones
and lights, with stones that touch, and with who looks on.

Each sweep changes one number and keeps all else. Its frames are timed in turns, so that a noisy machine is noisy for
all of them; of the larger half a power is fitted, as small numbers cost mostly what any frame does.
"""

from __future__ import annotations

import asyncio
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from culet.geometry.shape import Shape
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import Renderer
from culet.scene.emitters import Emitter, PointLight, RoundLamp
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, Plane
from culet.stage import Stage
from culet.study.contacts.heaps import dearest_quarter, heap
from culet.study.findings.convergence import fit_order
from culet.study.findings.journal import PointJournal
from culet.study.report import Figure, Fit, Point
from culet.study.serving.crowd import running_service
from culet.study.solids import ball

FIGURES: dict[str, Figure] = {
    "processor_seconds": Figure(unit="s", about="Of all cores together, median: of a frame of one sample; of a step of "
                                                "the simulation; of sessions and viewers, in a second of the clock."),
    "seconds": Figure(unit="s", about="Of the clock, median, of a frame."),
    "segments": Figure(unit="", better="neither", about="Inside stones, of a frame."),
    "frames_per_second": Figure(unit="1/s", better="more", about="That came to a viewer."),
}  # fmt: skip
"""Null where a sweep says nothing of it."""

SHAPE = 16, 9
"""Of a picture, its width over its height."""


class GrowthSweep(NamedTuple):
    """What a number is of, and the numbers."""

    numbers: tuple[int, ...]
    most: float
    """Exponent up to which its growth is as it should be."""


class GrowthEffort(NamedTuple):
    """How much a study of growth takes."""

    sweeps: dict[str, GrowthSweep]
    height: int
    """Pixels of frames whose pixels are not swept."""
    repeats: int
    heap_seconds: float
    """Simulated, of falling heaps."""
    load_seconds: float
    """Of the clock, of sessions and viewers."""


LINEAR = 1.05
"""What is linear, with what a fit of a noisy machine's times may miss."""

FULL = GrowthEffort(
    {
        "pixels": GrowthSweep((14_400, 57_600, 230_400, 921_600, 3_686_400), LINEAR),
        "facets": GrowthSweep((16, 32, 64, 128, 256, 512, 1024), LINEAR),
        "bounces": GrowthSweep((8, 16, 32, 64, 128, 256), LINEAR),
        "bands": GrowthSweep((3, 6, 12, 24, 48), LINEAR),
        "stones": GrowthSweep((1, 2, 4, 8, 16, 32, 64), LINEAR),
        "lamps": GrowthSweep((1, 2, 4, 8, 16, 24), LINEAR),
        "points": GrowthSweep((1, 2, 4, 8), LINEAR),
        "touching stones": GrowthSweep((4, 8, 16, 32, 64), 1.8),
        "sessions": GrowthSweep((1, 2, 4, 8, 16), LINEAR),
        "viewers": GrowthSweep((1, 2, 4, 8, 16, 32), LINEAR),
    },
    360, 9, 14.0, 6.0,
)  # fmt: skip
QUICK = GrowthEffort(
    {
        name: GrowthSweep(sweep.numbers[: -1 if len(sweep.numbers) > 4 else None], sweep.most)
        for name, sweep in FULL.sweeps.items()
    },
    180, 5, 8.0, 3.0,
)  # fmt: skip

Progress = Callable[[str, int], None]


@dataclass(frozen=True)
class _Shot:
    """A frame to be timed."""

    stage: Stage
    width: int
    height: int


def measure_all(renderer: Renderer, extent: GrowthEffort, journal: PointJournal, progress: Progress) -> None:
    """Every sweep that the journal lacks."""
    for done, (name, sweep) in enumerate(extent.sweeps.items()):
        progress(name, done)
        if all(_key(name, number) in journal for number in sweep.numbers):
            continue
        match name:
            case "touching stones":
                found = _touching(sweep.numbers, extent.heap_seconds)
            case "sessions" | "viewers":
                found = asyncio.run(_crowds(name, sweep.numbers, extent.load_seconds))
            case _:
                found = _frames(renderer, name, sweep.numbers, extent)
        journal.add(*found)


def fits_of(points: Sequence[Point], extent: GrowthEffort) -> list[Fit]:
    """The power with which each sweep's cost grows, of its larger half."""
    fits = []
    for name in extent.sweeps:
        own = [point for point in points if point.group == name]
        larger = own[(len(own) - 1) // 2 :]
        numbers = [float(point.knobs[name] or 0) for point in larger]
        costs = [point.figures["processor_seconds"] or 0.0 for point in larger]
        fit = fit_order(numbers, costs, floor=0.0, ceiling=math.inf)
        if fit is not None:
            fits.append(Fit(label=name, error="processor_seconds", step=name, order=fit.order, points=fit.points))
    return fits


def _key(name: str, number: int) -> str:
    return f"{name}={number}"


def _point(name: str, number: int, **figures: float) -> Point:
    return Point(
        key=_key(name, number), group=name, label=f"{number} {name}", knobs={name: number},
        figures=dict.fromkeys(FIGURES) | figures,
    )  # fmt: skip


def _frames(renderer: Renderer, name: str, numbers: Sequence[int], extent: GrowthEffort) -> list[Point]:
    shots = [_shot(name, number, extent.height) for number in numbers]
    walls: list[list[float]] = [[] for _ in numbers]
    processors: list[list[float]] = [[] for _ in numbers]
    segments = []
    for shot in shots:  # compiled, and warm
        picture = renderer.picture(shot.stage, shot.width, shot.height, effort=LightEffort.MOVING)
        picture.refine(1)
        segments.append(picture.segments())
    for _ in range(extent.repeats):
        for place, shot in enumerate(shots):
            renderer.lighting.forget()  # as of stones that have moved
            wall, processor = time.perf_counter(), time.process_time()
            renderer.picture(shot.stage, shot.width, shot.height, effort=LightEffort.MOVING).refine(1)
            walls[place].append(time.perf_counter() - wall)
            processors[place].append(time.process_time() - processor)
    return [
        _point(
            name, number, processor_seconds=statistics.median(processors[place]),
            seconds=statistics.median(walls[place]), segments=segments[place],
        )
        for place, number in enumerate(numbers)
    ]  # fmt: skip


def _shot(name: str, number: int, height: int) -> _Shot:
    """The frame in which there are so many of these."""
    scene, shape = Scene(), None
    match name:
        case "pixels":
            height = math.isqrt(number * SHAPE[1] // SHAPE[0])
        case "facets":
            shape = ball(number)()
        case "bounces" | "bands":
            field = {"bounces": "max_bounces", "bands": "bands"}[name]
            scene = scene.model_copy(update={"optics": scene.optics.model_copy(update={field: number})})
        case "stones":
            scene = beside_each_other(number)
        case "lamps":
            scene = _lit_by([_lamp(place, number) for place in range(number)], Scene())
        case "points":
            floor = LEGACY_DEFAULT.model_copy(update={"floor": Plane(kind="matte")})
            scene = _lit_by([_light(place, number) for place in range(number)], floor)
        case _:
            raise ValueError(f"no sweep is called {name}")
    return _Shot(_stage(scene, shape), height * SHAPE[0] // SHAPE[1], height)


def _stage(scene: Scene, shape: Shape | None) -> Stage:
    stage = Stage.of(scene)
    return stage if shape is None else Stage(scene, (shape,) * len(scene.stones), stage.panorama)


def beside_each_other(number: int) -> Scene:
    """So many default stones on the floor, which together cover about what one does."""
    (stone,) = Scene().stones
    columns = math.ceil(math.sqrt(number))
    scale = number**-0.5
    stones = []
    for each in range(number):
        row, column = divmod(each, columns)
        x, z = (2 * scale * (place - (columns - 1) / 2) for place in (column, row))
        y = FLOOR_Y + scale * (stone.position[1] - FLOOR_Y)
        changes = {"id": f"stone-{each}", "scale": scale, "position": (x, y, z)}
        stones.append(stone.model_copy(update=changes))
    return Scene().model_copy(update={"stones": tuple(stones)})


def _lit_by(emitters: Sequence[Emitter], scene: Scene) -> Scene:
    return scene.model_copy(update={"emitters": tuple(emitters)})


def _around(place: int, number: int) -> tuple[float, float, float]:
    """A direction above the floor, of so many."""
    angle = 2 * math.pi * place / number
    return math.cos(angle), 1.0, math.sin(angle)


def _lamp(place: int, number: int) -> RoundLamp:
    bright = 8 / number
    return RoundLamp(direction=_around(place, number), radiance=(bright, bright, bright), half_angle_degrees=6)


def _light(place: int, number: int) -> PointLight:
    x, y, z = _around(place, number)
    return PointLight(position=(5 * x, 5 * y, 5 * z), colour=(1 / number, 1 / number, 1 / number))


def _touching(numbers: Sequence[int], seconds: float) -> list[Point]:
    return [
        _point("touching stones", number, processor_seconds=dearest_quarter(heap(number, seed=1), seconds))
        for number in numbers
    ]


async def _crowds(name: str, numbers: Sequence[int], seconds: float) -> list[Point]:
    found = []
    async with running_service() as service:
        await service.load(1, 1, seconds)  # programs are compiled
        for number in numbers:
            load = await service.load(*((number, 1) if name == "sessions" else (1, number)), seconds)
            found.append(_point(name, number, processor_seconds=load.processor_seconds, frames_per_second=load.frames))
    return found


def steeper_than_they_should_be(fits: Sequence[Fit], extent: GrowthEffort) -> Iterator[str]:
    """The sweeps whose cost grows with a larger power than it should, in words."""
    for fit in fits:
        most = extent.sweeps[fit.label].most
        if fit.order > most:
            yield f"{fit.label}: cost grows as the number to the {fit.order:.2f}, expected at most {most:g}"

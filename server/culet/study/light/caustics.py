"""The study of the light that stones throw: the cut-off of beams against the error of the map and the time it takes.

The scene's stones lie over a matte floor, in the dark but for one lamp: a point, or a sun, each from the same side.
Maps by beams, of one pass or several, are judged by a converged one, and so are photons of the same program; then the
maps of a resting picture, pass by pass; and, for stones turned at random, the estimated error beside the true one.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from culet.errors import SceneError
from culet.rendering.emitters.light_map import Figures, frame_of
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.sources import rays_of
from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.photons import Photons
from culet.rendering.light.solids import MANY, takes_only_beams
from culet.rendering.renderer import Renderer
from culet.scene.emitters import PointLight, Sun
from culet.scene.room import Plane
from culet.scene.sky import ConstantEnvironment
from culet.stage import Stage
from culet.study.findings.convergence import resting_error, time_to
from culet.study.findings.journal import PointJournal
from culet.study.report import Figure, Point, Race

Array = NDArray[np.float64]

FIGURES: dict[str, Figure] = {
    "seconds": Figure(unit="s", about="Time of the map, all passes: median."),
    "processor_seconds": Figure(unit="s", about="The same, of all cores together."),
    "rmse": Figure(unit="radiance", about="RMSE of the finer level against the converged map; a white floor is 1."),
    "rmse_estimated": Figure(unit="radiance", about="The same, as the map's maker estimates it."),
    "estimate_ratio": Figure(unit="", better="neither", about="Estimated over true."),
    "missing": Figure(unit="", about="Light that the converged map has on both levels and this one has not, of the "
                                     "light that meets the stones."),
    "bound": Figure(unit="", about="Light that was cut, not resolved or fell beside the map, likewise: at least what "
                                   "is missing of a single light."),
    "reference_rmse": Figure(unit="radiance", about="Of the converged map itself, by its halves."),
    "beams": Figure(unit="", better="neither", about="Beams that were followed, or photons."),
}  # fmt: skip
"""Null where a method says nothing of it."""

BESIDE = (-4.0, 6.0, 4.0)
"""R: where the point is; a sun is in that direction. 8.2 R away, the light comes from 47 degrees above the floor."""
LAMPS: dict[str, PointLight | Sun] = {
    "point": PointLight(position=BESIDE, colour=(1, 1, 1)),
    "sun": Sun(direction=BESIDE, colour=(1, 1, 1)),
}
CUTOFFS = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6)
PASSES = (1, 4, 16, 64)
"""Of a sun, each with a direction of its own."""
COARSEST_PHOTONS = 10_000
DIRECTIONS = 16
"""Of a sun, in a pass of photons."""
REFERENCE_NUMBER = 100_000
"""Of the first pass of a reference: its directions are none of those that are judged."""
RESTING_TARGETS = {"point": (0.005, 0.002), "sun": (0.005, 0.003)}
"""RMSE to which a resting picture's map is timed."""
TARGETS = (0.02, 0.01, 0.005, 0.003, 0.002)
"""RMSE to which times are compared. That of a moving frame is about 0.01."""


class CausticsEffort(NamedTuple):
    """How much a study of caustics takes."""

    cutoffs: tuple[float, ...]
    passes: tuple[int, ...]
    photons: int
    """Times that their number is doubled."""
    reference_cutoff: float
    sun_cutoff: float
    directions: int
    """Of the sun's reference."""
    poses: int
    pose_cutoffs: tuple[float, ...]
    repeats: int


FULL = CausticsEffort(CUTOFFS, PASSES, 10, 1e-7, 2e-6, 384, 12, (1e-3, 1e-4, 1e-5), 9)
QUICK = CausticsEffort(CUTOFFS[:7:2], PASSES[:3], 7, 1e-7, 1e-5, 96, 4, (1e-3, 1e-4), 3)

Progress = Callable[[str, int], None]


@dataclass(frozen=True, eq=False)
class Converged:
    """What maps are judged by."""

    map: Array
    """As `Bench.map` has it."""
    error: float
    """Its own, by its halves: RMSE of the finer level. 0 of one direction."""


class Bench:
    """Maps of one stage under one lamp, with the time they took."""

    def __init__(self, renderer: Renderer, stage: Stage, lamp: str) -> None:
        self.renderer, self.device, self.lamp = renderer, renderer.device, lamp
        self.stage = under(stage, lamp)
        self.frame = frame_of(self.stage)
        self.beams = Beams(self.device)
        self.target = cl.Buffer(self.device.context, cl.mem_flags.READ_WRITE, self.frame.nbytes)
        self.made = cl.Buffer(self.device.context, cl.mem_flags.READ_WRITE, self.frame.nbytes)

    def map(self, source: Any = None) -> Array:  # noqa: ANN401 - pyopencl has no types
        """By surface, level, row, column and channel: those surfaces that are matte."""
        made = np.empty(self.frame.shape, np.float32)
        cl.enqueue_copy(self.device.queue, made, self.target if source is None else source)
        return made[list(self.frame.matte)].astype(np.float64)

    def thrown(self, cutoff: float, number: int, part: int) -> Figures:
        """One pass more, the `part`th of so many of equal weight, from 1."""
        return self.beams.make(
            self.stage, rays_of(self.stage, number), self.frame, self.target,
            cutoff=cutoff, number=number, keep=1 - 1 / part, gain=1 / part,
        )  # fmt: skip

    def converged(self, extent: CausticsEffort, directions: int) -> Converged:
        """By beams: what photons make of the same comes nearer and nearer to it."""
        if self.lamp == "point":
            self.thrown(extent.reference_cutoff, 0, 1)
            return Converged(self.map(), 0.0)
        halves = []
        for half in range(2):
            for part in range(1, directions // 2 + 1):
                self.thrown(extent.sun_cutoff, REFERENCE_NUMBER + 2 * part + half, part)
            halves.append(self.map())
        return Converged((halves[0] + halves[1]) / 2, rms(halves[0] - halves[1]) / 2)

    def missing(self, made: Array, judge: Converged) -> float:
        """Flux, R^2, of all surfaces, mean of the channels: the coarser level is filled under the finer one too."""
        apart = (judge.map - made)[:, 1].mean(axis=-1).sum()
        return float(apart * self.frame.texel_area(1))


def under(stage: Stage, lamp: str) -> Stage:
    """The stones over a matte floor under that lamp alone; SceneError if they take no beams."""
    if not stage.shapes or not takes_only_beams(stage):
        raise SceneError(f"stones: expected convex stones of at most {MANY} facets, whose light beams follow", "stones")
    scene = stage.scene
    dark = ConstantEnvironment(kind="constant", radiance=(0, 0, 0))
    optics = scene.optics.model_copy(update={"estimator": "chain", "caustics": "on"})
    return replace(stage, panorama=None, scene=scene.model_copy(update={
        "floor": Plane(kind="matte"), "walls": Plane(kind="none"), "environment": dark, "emitters": (LAMPS[lamp],),
        "head": None, "optics": optics,
    }))  # fmt: skip


def turned(stage: Stage, number: int) -> Stage:
    """The stage with its stones turned at random, pose `number`."""
    turns = Rotation.random(len(stage.scene.stones), random_state=number).as_quat()
    stones = tuple(
        stone.model_copy(update={"orientation": (float(w), float(x), float(y), float(z))})
        for stone, (x, y, z, w) in zip(stage.scene.stones, turns, strict=True)
    )
    return replace(stage, scene=stage.scene.model_copy(update={"stones": stones}))


def measure_all(
    renderer: Renderer, stage: Stage, extent: CausticsEffort, journal: PointJournal, progress: Progress
) -> None:
    """Every point that the journal lacks; `progress` is told what comes next and how much is done."""
    done = 0
    for lamp in LAMPS:
        bench, judge = Bench(renderer, stage, lamp), None
        for name, run in _sweeps(bench, extent):
            progress(f"{lamp}: {name}", done)
            done += 1
            if not any(point.group == f"{lamp}: {name}" for point in journal.points.values()):
                judge = judge or bench.converged(extent, extent.directions)
                journal.add(*run(judge))
    for number in range(extent.poses):
        for lamp in LAMPS:
            progress(f"pose {number + 1}, {lamp}", done)
            done += 1
            if f"{lamp} pose={number + 1} cutoff={extent.pose_cutoffs[0]:g}" not in journal:
                journal.add(*_poses(Bench(renderer, turned(stage, number), lamp), extent, number))


def steps(extent: CausticsEffort) -> int:
    """That `measure_all` tells of."""
    return len(LAMPS) * (3 + extent.poses)


def notes(extent: CausticsEffort) -> list[str]:
    """What there is to say about the references."""
    words = (
        f"Converged maps are beams at a cut-off of {extent.reference_cutoff:g}; of the sun, the mean of "
        f"{extent.directions} directions that no judged map has, at {extent.sun_cutoff:g}. Their own RMSE is "
        "`reference_rmse`: errors near that are theirs. Stones that are turned are judged in the sun's middle "
        "direction."
    )
    return [words]


def _sweeps(bench: Bench, extent: CausticsEffort) -> Iterator[tuple[str, Callable[[Converged], list[Point]]]]:
    yield "beams", partial(_by_beams, bench, extent)
    yield "photons", partial(_by_photons, bench, extent)
    yield "at rest", partial(_at_rest, bench)


class _Clock:
    """Wall and processor time of what is timed, without what is done between."""

    def __init__(self) -> None:
        self.seconds = self.processor = 0.0

    def __enter__(self) -> None:
        self._begun = time.perf_counter(), time.process_time()

    def __exit__(self, *_: object) -> None:
        self.seconds += time.perf_counter() - self._begun[0]
        self.processor += time.process_time() - self._begun[1]


def _by_beams(bench: Bench, extent: CausticsEffort, judge: Converged) -> list[Point]:
    """Cut-offs, of a sun with several passes each."""
    points = []
    for cutoff in extent.cutoffs:
        bench.thrown(cutoff, 0, 1)  # compiled, and warm
        clock, figures, incident, lost = _Clock(), None, 0.0, 0.0
        for part in range(1, (extent.passes if bench.lamp == "sun" else PASSES[:1])[-1] + 1):
            repeats = extent.repeats if part == 1 else 1
            times = []
            for _ in range(repeats):
                single = _Clock()
                with single:
                    figures = bench.thrown(cutoff, part - 1, part)
                times.append(single)
            clock.seconds += statistics.median(each.seconds for each in times)
            clock.processor += statistics.median(each.processor for each in times)
            assert figures is not None  # noqa: S101 - there is a repeat at least
            incident, lost = incident + figures.incident, lost + figures.bound * figures.incident
            if part in PASSES:
                made = bench.map()
                estimated = figures.rmse if bench.lamp == "point" else None  # of a sun not the directions' part
                points.append(_point(
                    bench, "beams", {"method": "beams", "cutoff": cutoff, "passes": part, "photons": None},
                    _figures(bench, made, judge, clock, incident / part, estimated, lost / incident,
                             bench.beams.tally.beams if bench.beams.tally else 0.0),
                ))  # fmt: skip
    return points


def _by_photons(bench: Bench, extent: CausticsEffort, judge: Converged) -> list[Point]:
    """Passes whose photons double from one to the next, each weighed by its number: as a resting picture has them."""
    maps = Photons(bench.device).maps(bench.stage, bench.frame)
    for _ in maps.pieces(bench.made, _spread(bench.stage, 0), number=0, photons=1):  # compiled, and warm
        pass
    clock, points, shot = _Clock(), list[Point](), 0
    for number in range(extent.photons):
        photons = COARSEST_PHOTONS * 2 ** max(0, number - 1)
        with clock:
            for _ in maps.pieces(bench.made, _spread(bench.stage, number), number=number, photons=photons):
                pass
            maps.join(bench.target, bench.made, shot / (shot + photons), photons / (shot + photons))
        shot += photons
        figures = maps.figures
        assert figures is not None  # noqa: S101 - of the pass that is done
        points.append(_point(
            bench, "photons", {"method": "photons", "cutoff": None, "passes": number + 1, "photons": shot},
            _figures(bench, bench.map(), judge, clock, figures.incident, None, None, shot),
        ))  # fmt: skip
    return points


def _spread(stage: Stage, number: int) -> list[LightRay]:
    """The rays of several passes at once, of equal shares."""
    if all(ray.position is not None for ray in rays_of(stage, 0)):
        return rays_of(stage, number)
    found = []
    for each in range(number * DIRECTIONS, (number + 1) * DIRECTIONS):
        for ray in rays_of(stage, each):
            red, green, blue = ray.colour
            found.append(replace(ray, colour=(red / DIRECTIONS, green / DIRECTIONS, blue / DIRECTIONS)))
    return found


def _at_rest(bench: Bench, judge: Converged) -> list[Point]:
    """What a picture at rest has after each pass, as the server makes it."""
    lighting = bench.renderer.lighting
    lighting.make_ready(bench.stage)
    lighting.forget()
    found = lighting.of(bench.stage)
    assert found is not None  # noqa: S101 - the floor is matte
    optics = bench.stage.scene.optics
    pieces = found.pieces(optics.caustics_cutoff, LightEffort.PATIENT, 0.02)
    clock, points, passes = _Clock(), list[Point](), 0
    while True:
        with clock:
            more = next(pieces, None)
            bench.device.queue.finish()
        if found.passes > passes:
            passes = found.passes
            if found.figures is not None and (passes.bit_count() == 1 or more is None):
                points.append(_point(
                    bench, "at rest", {"method": "at rest", "cutoff": found.cutoff, "passes": passes, "photons": None},
                    _figures(bench, bench.map(found.bound.buffer), judge, clock, found.figures.incident, found.rmse,
                             found.figures.bound, None),
                ))  # fmt: skip
        if more is None:
            lighting.forget()
            return points


def _poses(bench: Bench, extent: CausticsEffort, number: int) -> list[Point]:
    """The estimate beside the truth: of one direction, which is all that a pass estimates."""
    bench.thrown(extent.reference_cutoff, 0, 1)
    judge, points = Converged(bench.map(), 0.0), []
    for cutoff in extent.pose_cutoffs:
        clock = _Clock()
        with clock:
            figures = bench.thrown(cutoff, 0, 1)
        points.append(Point(
            key=f"{bench.lamp} pose={number + 1} cutoff={cutoff:g}", group="poses",
            label=f"{bench.lamp}, pose {number + 1}, cut-off {cutoff:g}",
            knobs={"lamp": bench.lamp, "method": "beams", "cutoff": cutoff, "passes": 1, "photons": None},
            figures=_figures(bench, bench.map(), judge, clock, figures.incident, figures.rmse, figures.bound,
                             bench.beams.tally.beams if bench.beams.tally else 0.0),
        ))  # fmt: skip
    return points


def _figures(
    bench: Bench, made: Array, judge: Converged, clock: _Clock, incident: float, estimated: float | None,
    bound: float | None, beams: float | None,
) -> dict[str, float | None]:  # fmt: skip
    error = rms(made - judge.map)
    known = estimated is not None and math.isfinite(estimated)
    return {
        "seconds": clock.seconds, "processor_seconds": clock.processor, "rmse": error,
        "rmse_estimated": estimated if known else None,
        "estimate_ratio": estimated / error if known and estimated is not None and error > 0 else None,
        "missing": bench.missing(made, judge) / incident if incident > 0 else None, "bound": bound,
        "reference_rmse": judge.error or None, "beams": beams,
    }  # fmt: skip


def _point(
    bench: Bench, sweep: str, knobs: dict[str, str | float | int | None], figures: dict[str, float | None]
) -> Point:
    told = [f"{name} {value:g}" for name, value in knobs.items() if isinstance(value, int | float)]
    return Point(
        key=f"{bench.lamp} {sweep} " + " ".join(f"{name}={value}" for name, value in knobs.items()),
        group=f"{bench.lamp}: {sweep}", label=f"{bench.lamp}, {sweep}, {', '.join(told)}",
        knobs={"lamp": bench.lamp, **knobs}, figures=figures,
    )  # fmt: skip


def rms(apart: Array) -> float:
    """Over the finer level."""
    return float(np.sqrt(np.mean(np.square(apart[:, 0]))))


def races(points: Sequence[Point], cost: str = "processor_seconds") -> list[Race]:
    """Seconds by beams and by photons to each of TARGETS; of beams by the best cut-off and number of passes."""
    found = []
    for lamp in LAMPS:
        for method in ("beams", "photons"):
            curve = _falling([p for p in points if p.group == f"{lamp}: {method}"], cost)
            floor = resting_error(*curve) if method == "photons" else None
            times = {target: time_to(*curve, target, floor=floor) for target in TARGETS}
            found.append(Race(
                name=f"{lamp}, {method}", note="by processor time",
                seconds={f"{target:g}": time.seconds if method == "photons" or not time.extrapolated else None
                         for target, time in times.items()},
                extrapolated=tuple(f"{t:g}" for t, time in times.items() if time.extrapolated and method == "photons"),
            ))  # fmt: skip
    return found


def rested(points: Sequence[Point], lamp: str, target: float) -> float | None:
    """s until a resting picture's map had that RMSE; None if it had not."""
    curve = _falling([p for p in points if p.group == f"{lamp}: at rest"], "seconds")
    reached = time_to(*curve, target)
    return None if reached.extrapolated else reached.seconds


def _falling(points: Sequence[Point], cost: str) -> tuple[list[float], list[float]]:
    """Times and errors of those that none is both faster and better than."""
    seconds, errors = list[float](), list[float]()
    for time_, error in sorted((p.figures[cost] or 0.0, p.figures["rmse"] or 0.0) for p in points):
        if not errors or error < errors[-1]:
            seconds.append(time_)
            errors.append(error)
    return seconds, errors

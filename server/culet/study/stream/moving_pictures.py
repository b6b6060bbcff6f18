"""How near what a viewer sees of a fall comes to the converged pictures, at equal frame rates.

A fall is recorded, and at moments spread over it each way of drawing it makes the picture that the page shows: drawn as
the governor has it, filtered or not, sent as JPEG, and enlarged to the size that was asked for. It is judged at that
size against a converged picture of the same moment, by FLIP, by CIEDE2000 and by its root mean square error.

FLIP is P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, HPG 2020: the mean over the picture of
what an eye that flips between the two notices, from 0 (nothing) to 1, at 67 pixels a degree.
"""

from __future__ import annotations

import io
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import flip_evaluator
import numpy as np
import PIL.Image
from numpy.typing import NDArray
from rich import box
from rich.table import Table

from culet.engine.governing.governor import Governor, Plan
from culet.engine.painting import jpeg
from culet.engine.painting.quality import LADDER
from culet.falls import simulate_stage
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import Renderer
from culet.stage import Stage
from culet.study.likeness.image_error import mean_ciede2000
from culet_protocol.messages import Balance

RATES = 30.0, 60.0
"""Frames per second that are held."""
CONVERGED_CUTOFF = 1e-3
PIXELS_PER_DEGREE = 67.0
"""A screen of 0.7 m width and 3840 pixels seen from 0.7 m: FLIP's own default."""
GOVERNED = Balance(exactness=0.5, pinned=False)
"""As sessions begin: the governor chooses. The rate is given beside it."""
TURNS = 3
"""Times that a frame is drawn; the quickest counts."""

_flip: Any = flip_evaluator.evaluate  # has no types
ScreenPixels = NDArray[np.uint8]
"""(height, width, 3), sRGB."""


@dataclass(frozen=True)
class DrawingWay:
    """Of drawing the frames of a fall."""

    rate: float
    """Frames per second that the governor is to hold."""
    dearer: float
    """Times that a frame takes of what it takes: the governor chooses what a slower program could hold."""
    softened: bool
    """Whether a frame of full size is filtered, as the engine does."""


@dataclass(frozen=True)
class Judged:
    """Means over the moments of a fall."""

    way: DrawingWay
    width: int
    """Pixels of the frames, on average."""
    height: int
    cutoff: float
    """The largest."""
    seconds: float
    """Of processor time that a frame took, all cores together: rendering, tone map and filter."""
    flip: float
    ciede2000: float
    rmse: float
    """Of what is shown, 0 to 255."""


@dataclass(frozen=True)
class FallStudy:
    """A study."""

    width: int
    """Pixels of what is seen."""
    height: int
    moments: int
    samples: int
    """Of the converged pictures."""
    judged: Sequence[Judged]

    def document(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self), indent=1)


def ways_of(dearer: Sequence[float]) -> list[DrawingWay]:
    """Each rate, each dearness, filtered and not."""
    return [DrawingWay(rate, times, softened) for rate in RATES for times in dearer for softened in (False, True)]


def measure(
    stage: Stage,
    size: tuple[int, int],
    *,
    seconds: float,
    moments: int,
    samples: int,
    dearer: Sequence[float],
    progress: Callable[[float], None],
) -> FallStudy:
    """Let the stage's stones fall for `seconds`, and judge so many `moments` of it; the first one is the start."""
    renderer, ways = Renderer(), ways_of(dearer)
    stages = moments_of(stage, seconds, moments)
    unit = _first_sample(renderer, stages[0], size)
    found: dict[DrawingWay, list[tuple[Plan, float, tuple[float, float, float]]]] = {way: [] for way in ways}
    for number, moment in enumerate(stages):
        converged = _converged(renderer, moment, size, samples)
        for way in ways:
            plan = planned(moment, size, way, unit)
            shown, spent = as_seen(renderer, moment, plan, softened=way.softened)
            found[way].append((plan, spent, differences(shown, converged)))
        progress((number + 1) / len(stages))
    return FallStudy(*size, moments, samples, [_mean(way, judged) for way, judged in found.items()])


def moments_of(stage: Stage, seconds: float, moments: int) -> list[Stage]:
    """The stage at so many moments of its fall, evenly spread over it."""
    motion = simulate_stage(stage, seconds)
    steps = np.linspace(0, len(motion.time) - 1, moments).round().astype(int)
    position, orientation = motion.position[steps].tolist(), motion.orientation[steps].tolist()
    return [
        stage.posed([(tuple(place), tuple(turn)) for place, turn in zip(*poses, strict=True)])
        for poses in zip(position, orientation, strict=True)
    ]


def planned(stage: Stage, size: tuple[int, int], way: DrawingWay, unit: float) -> Plan:
    """What the governor would draw of it, if a first sample in full takes `unit` seconds."""
    governor = Governor(LADDER)
    governor.rested(stage.scene, size, unit * way.dearer, way.rate)
    return governor.plan(stage.scene, size, GOVERNED)


def as_seen(renderer: Renderer, stage: Stage, plan: Plan, *, softened: bool) -> tuple[ScreenPixels, float]:
    """What the page shows of a moving frame, and the s of processor time that the engine drew it in."""
    best = np.inf
    for _ in range(TURNS):
        before = time.process_time()
        picture = renderer.picture(stage.showing(plan.scene), *plan.size, effort=LightEffort.MOVING)
        picture.refine(1)
        rgb = picture.softened() if softened and plan.size == plan.wanted else picture.rgb()
        best = min(best, time.process_time() - before)
    with PIL.Image.open(io.BytesIO(jpeg.encode(rgb, jpeg.MOVING_QUALITY))) as sent:
        enlarged = sent.resize(plan.wanted, PIL.Image.Resampling.BICUBIC)  # as browsers do, nearly
    return np.asarray(enlarged, np.uint8), float(best)


def differences(shown: ScreenPixels, converged: ScreenPixels) -> tuple[float, float, float]:
    """FLIP, CIEDE2000 and RMSE, means over the picture."""
    return flip(shown, converged), mean_ciede2000(shown, converged), rmse(shown, converged)


def flip(shown: ScreenPixels, converged: ScreenPixels) -> float:
    """Mean over the picture."""
    pair = [np.ascontiguousarray(each, np.float32) / 255 for each in (converged, shown)]
    _, mean, _ = _flip(*pair, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE})
    return float(mean)


def rmse(shown: ScreenPixels, converged: ScreenPixels) -> float:
    """0 to 255."""
    return float(np.sqrt(np.mean(np.square(shown.astype(float) - converged))))


def _converged(renderer: Renderer, stage: Stage, size: tuple[int, int], samples: int) -> ScreenPixels:
    optics = stage.scene.optics.model_copy(update={"cutoff": min(stage.scene.optics.cutoff, CONVERGED_CUTOFF)})
    picture = renderer.picture(stage.showing(stage.scene.model_copy(update={"optics": optics})), *size)
    picture.refine(samples)
    return picture.rgb()


def _first_sample(renderer: Renderer, stage: Stage, size: tuple[int, int]) -> float:
    """s of the first sample of a picture at rest, which the governor begins with: of a device that does nothing else,
    whose units share the processor time that it took."""

    def drawn() -> float:
        before = time.process_time()
        renderer.picture(stage, *size).refine(1)
        return time.process_time() - before

    drawn()  # compiles
    return min(drawn() for _ in range(TURNS)) / renderer.device.units


def _mean(way: DrawingWay, judged: Sequence[tuple[Plan, float, tuple[float, float, float]]]) -> Judged:
    plans = [plan for plan, _, _ in judged]
    seen, ciede2000, error = np.mean([differences for _, _, differences in judged], axis=0)
    width, height = np.mean([plan.size for plan in plans], axis=0).round()
    seconds = float(np.median([spent for _, spent, _ in judged]))
    cutoff = max(plan.scene.optics.cutoff for plan in plans)
    return Judged(way, int(width), int(height), cutoff, seconds, float(seen), float(ciede2000), float(error))


def table(fall: FallStudy) -> Table:
    """A row for each way."""
    heads = "frames/s", "dearer", "filtered", "drawn", "cut-off", "ms", "FLIP", "CIEDE2000", "RMSE"
    rows = Table(*heads, box=box.SIMPLE)
    for each in fall.judged:
        rows.add_row(*_cells(each))
    return rows


def _cells(each: Judged) -> list[str]:
    way = each.way
    return [
        f"{way.rate:g}", f"{way.dearer:g}", "yes" if way.softened else "no", f"{each.width}x{each.height}",
        f"{each.cutoff:g}", f"{each.seconds * 1e3:.1f}", f"{each.flip:.4f}", f"{each.ciede2000:.3f}",
        f"{each.rmse:.2f}",
    ]  # fmt: skip

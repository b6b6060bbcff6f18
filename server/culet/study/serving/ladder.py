"""Measures the governor's ladder: which scale, cut-off and bounces give the least error for each time, moving.

    python -m culet.study.serving.ladder > server/culet/engine/governing/ladder.json

Each setting draws the legacy default scene at one sample a pixel, as a moving frame is. They take turns, and what
counts is the least of the processor's times, since other work only ever adds to them, and of those what all sizes
together say of a cut-off and bounces: 5 % of noise in one of them would put a setting off the frontier.
The picture is brought to full size as a browser does, and compared, as it is shown and in radiance, with a converged
one.
Besides the ladder, the errors of all settings are kept: what is drawn may be a rung at another size.
"""

from __future__ import annotations

import datetime as dt
import json
import sys
import time
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from culet.engine.governing.governor import Setting
from culet.optics.tone import tone_map
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.model import Scene
from culet.stage import Stage
from culet.study.findings.provenance import provenance
from culet.study.likeness.radiance_error import Image, enlarged, radiance_error

SIZE = 1280, 720
SCALES = 1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6, 0.55, 0.5, 0.4, 0.3
LEAST_SCALE = 0.5
"""Of this size: 640x360, below which the governor does not go. What is smaller follows, for larger pictures."""
CUTOFFS = 0.01, 0.02, 0.05
BOUNCES = 256, 48, 24, 16
REFERENCE_SAMPLES, REFERENCE_CUTOFF = 64, 1e-3
TURNS = 5
CLOSEST = 0.95
"""Cost of a rung over that of the one above it: what is nearer is not worth a change of setting, but where there is
nothing cheaper."""


@dataclass(frozen=True)
class MeasuredSetting:
    """One setting of the grid."""

    setting: Setting
    radiance_error: float
    """Root mean square error of the linear radiance, as `Setting.error` is of what is shown."""


def measure(renderer: Renderer, scene: Scene, size: tuple[int, int] = SIZE) -> list[MeasuredSetting]:
    """All settings, by scale, cut-off and bounces."""
    stage = Stage.of(scene)
    reference = renderer.picture(_with_optics(stage, REFERENCE_CUTOFF, BOUNCES[0]), *size)
    reference.refine(REFERENCE_SAMPLES)
    return _measured(renderer, stage, reference)


def ladder_of(measured: list[MeasuredSetting]) -> tuple[Setting, ...]:
    """The best setting first, then the frontier of those that are cheaper: each has the least error for its cost.

    The first is the scene's own, whatever its error.
    """
    best, *others = (each.setting for each in measured)
    return tuple(replace(r, cost=round(r.cost, 3), error=round(r.error, 4)) for r in _rungs(best, others))


def errors_of(measured: list[MeasuredSetting]) -> dict[str, Any]:
    """As `measured_errors` reads them: axes ascending, errors by scale, then cut-off, then bounces."""
    shape = len(SCALES), len(CUTOFFS), len(BOUNCES)
    shown = np.array([round(each.setting.error, 4) for each in measured]).reshape(shape)
    radiance = np.array([round(each.radiance_error, 4) for each in measured]).reshape(shape)
    return {
        "scales": SCALES[::-1],
        "cutoffs": CUTOFFS,
        "max_bounces": BOUNCES[::-1],
        "shown": shown[::-1, :, ::-1].tolist(),
        "radiance": radiance[::-1, :, ::-1].tolist(),
    }


def _rungs(best: Setting, others: list[Setting]) -> list[Setting]:
    rungs = [best, *_frontier([other for other in others if other.scale >= LEAST_SCALE], best.cost)]
    return rungs + _frontier([other for other in others if other.error > rungs[-1].error], rungs[-1].cost)


def _frontier(settings: list[Setting], cost: float) -> list[Setting]:
    """Those than which none cheaper is better, from below that cost down, none close to the one before it but the
    cheapest of all, which a slow machine needs."""
    rungs: list[Setting] = []
    cheapest = min(settings, key=lambda setting: (setting.cost, setting.error), default=None)
    for setting in sorted(settings, key=lambda setting: setting.cost, reverse=True):
        cheaper = [other for other in settings if other.cost <= setting.cost and other is not setting]
        most = cost if setting is cheapest else CLOSEST * cost
        if setting.cost < most and all(other.error > setting.error for other in cheaper):
            rungs.append(setting)
            cost = setting.cost
    return rungs


def _measured(renderer: Renderer, stage: Stage, reference: DevicePicture) -> list[MeasuredSetting]:
    size = reference.width, reference.height
    settings = list(product(SCALES, CUTOFFS, BOUNCES))
    pictures = [_draw(renderer, stage, size, *setting)[1] for setting in settings]  # which pays for the compiler
    turns = [[_draw(renderer, stage, size, *setting)[0] for setting in settings] for _ in range(TURNS)]
    seconds = smoothed(settings, [min(of_setting) for of_setting in zip(*turns, strict=True)])
    truth = reference.linear(), tone_map(reference.linear())
    measured = []
    for setting, taken, picture in zip(settings, seconds, pictures, strict=True):
        radiance, shown = (_error(p, t) for p, t in zip(picture, truth, strict=True))
        measured.append(MeasuredSetting(Setting(*setting, taken / seconds[0], shown), radiance))
    return measured


def smoothed(settings: list[tuple[float, float, int]], seconds: list[float]) -> list[float]:
    """Times of settings (scale, cut-off, bounces) by the law that fits them best (least squares of the logarithms): a
    pixel takes a time by cut-off and bounces, times a power of the scale, as smaller pictures have less coherent rays.
    """
    kinds = sorted({(cutoff, bounces) for _, cutoff, bounces in settings})
    law = np.zeros((len(settings), len(kinds) + 1))
    for number, (scale, *kind) in enumerate(settings):
        law[number, kinds.index((kind[0], int(kind[1])))] = 1
        law[number, -1] = np.log(scale)
    found = np.linalg.lstsq(law, np.log(seconds), rcond=None)[0]
    return [float(value) for value in np.exp(law @ found)]


def _draw(
    renderer: Renderer, stage: Stage, size: tuple[int, int], scale: float, cutoff: float, bounces: int
) -> tuple[float, tuple[Image, Image]]:
    """Processor's seconds; radiance and shown."""
    width, height = round(size[0] * scale), round(size[1] * scale)
    start = time.process_time()
    picture = renderer.picture(_with_optics(stage, cutoff, bounces), width, height)
    picture.refine()
    seconds = time.process_time() - start
    linear = picture.linear()
    # One of full size is filtered before it is sent.
    shown = picture.softened() / np.float32(255) if scale == 1 else tone_map(linear)
    return seconds, (linear, shown)


def _error(image: Image, truth: Image) -> float:
    return radiance_error(enlarged(image, *truth.shape[:2]), truth)["rmse"]


def _with_optics(stage: Stage, cutoff: float, bounces: int) -> Stage:
    optics = stage.scene.optics.model_copy(update={"cutoff": cutoff, "max_bounces": bounces})
    return stage.showing(stage.scene.model_copy(update={"optics": optics}))


def main() -> None:
    """Print ladder and errors as JSON, and what they were measured on."""
    renderer = Renderer()
    measured = measure(renderer, LEGACY_DEFAULT)
    document = {
        "measured": {
            "made": dt.datetime.now(dt.UTC).isoformat(timespec="seconds"),
            **provenance(renderer.describe()),
            "width": SIZE[0],
            "height": SIZE[1],
        },
        "rungs": [asdict(setting) for setting in ladder_of(measured)],
        "errors": errors_of(measured),
    }
    json.dump(document, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()

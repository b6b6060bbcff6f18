"""Measures the governor's ladder: which scale and cut-off give the least error for each time, moving.

    python -m culet.study.ladder > server/culet/engine/ladder.json

Each setting draws the default scene once, at one sample a pixel, as a moving frame is; the picture is brought to full
size as a browser does, and compared, as it is shown, with a converged one.
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from dataclasses import asdict

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.engine.governor import Setting
from culet.geometry.load import stone_of
from culet.geometry.stone import Stone
from culet.optics.tone import tone_map
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene

SIZE = 1280, 720
SCALES = 1.0, 0.9, 0.8, 0.7, 0.6, 0.5
CUTOFFS = 0.01, 0.02, 0.05
REFERENCE_SAMPLES, REFERENCE_CUTOFF = 64, 1e-3
REPEATS = 5


def measure_ladder(renderer: Renderer, scene: Scene, size: tuple[int, int] = SIZE) -> tuple[Setting, ...]:
    """The best setting first, then the front of those that are cheaper: each has the least error for its cost.

    The first is the scene's own, whatever its error: a single sample of every pixel is sharper than a smaller picture,
    and so has more of the error that more samples would take away.
    """
    stone = stone_of(scene.stones[0], {})
    reference = renderer.picture(_with_cutoff(scene, REFERENCE_CUTOFF), stone, *size)
    reference.refine(REFERENCE_SAMPLES)
    truth = tone_map(reference.linear())
    measured = [_measure(renderer, scene, stone, size, s, c, truth) for s in SCALES for c in CUTOFFS]
    best = measured[0]
    rungs = [best]
    for setting in sorted(measured[1:], key=lambda setting: setting.cost, reverse=True):
        cheaper = [other for other in measured[1:] if other.cost <= setting.cost and other is not setting]
        if setting.cost < best.cost and all(other.error > setting.error for other in cheaper):
            rungs.append(setting)
    return tuple(Setting(r.scale, r.cutoff, round(r.cost / best.cost, 3), round(r.error, 4)) for r in rungs)


def _measure(
    renderer: Renderer,
    scene: Scene,
    stone: Stone,
    size: tuple[int, int],
    scale: float,
    cutoff: float,
    truth: NDArray[np.float64],
) -> Setting:
    width, height = round(size[0] * scale), round(size[1] * scale)
    times = []
    for _ in range(REPEATS + 1):  # the first pays for the compiler
        start = time.process_time()
        picture = renderer.picture(_with_cutoff(scene, cutoff), stone, width, height)
        picture.refine()
        times.append(time.process_time() - start)
    shown = tone_map(picture.linear())
    channels = [
        np.asarray(PIL.Image.fromarray(shown[..., k].astype(np.float32)).resize(size, PIL.Image.Resampling.BILINEAR))
        for k in range(3)
    ]
    error = float(np.sqrt(np.mean((np.stack(channels, axis=-1) - truth) ** 2)))
    return Setting(scale, cutoff, statistics.median(times[1:]), error)


def _with_cutoff(scene: Scene, cutoff: float) -> Scene:
    return scene.model_copy(update={"optics": scene.optics.model_copy(update={"cutoff": cutoff})})


def main() -> None:
    """Print the ladder as JSON, and what it was measured on."""
    renderer = Renderer()
    rungs = [asdict(setting) for setting in measure_ladder(renderer, Scene())]
    json.dump(
        {"measured": {**renderer.describe(), "width": SIZE[0], "height": SIZE[1]}, "rungs": rungs}, sys.stdout, indent=2
    )
    print()


if __name__ == "__main__":
    main()

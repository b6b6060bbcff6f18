"""Measures the ladder of bytes: how many a moving frame of each scale and JPEG quality has, and what it misses.

    python -m culet.study.stream.bytes_ladder > server/culet/engine/governing/bytes_ladder.json

Frames of the default scene's fall, one sample a pixel, are encoded as the engine encodes them, decoded, brought to full
size as a browser does, and compared, as they are shown, with converged ones.
"""

from __future__ import annotations

import datetime as dt
import json
import statistics
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from culet.engine.painting import jpeg
from culet.optics.tone import tone_map
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene
from culet.simulation.staged import world_of
from culet.stage import Stage
from culet.study.findings.provenance import provenance
from culet.study.likeness.radiance_error import enlarged, radiance_error

SIZE = 1280, 720
SCALES = 1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2
QUALITIES = jpeg.MOVING_QUALITY, 80, 75, 70, 65, 60, 55, 50, 45, 40, 35, jpeg.LEAST_QUALITY
POSES, SECONDS_APART = 4, 0.2
REFERENCE_SAMPLES, REFERENCE_CUTOFF = 64, 1e-3


def measure(renderer: Renderer, scene: Scene, size: tuple[int, int] = SIZE) -> dict[str, Any]:
    """As `thrift` reads them: bytes and errors by scale, then quality."""
    references: list[NDArray[np.floating[Any]]] = []
    frames: dict[float, list[NDArray[np.uint8]]] = {scale: [] for scale in SCALES}
    for stage in _poses(scene):
        optics = stage.scene.optics.model_copy(update={"cutoff": REFERENCE_CUTOFF})
        reference = renderer.picture(stage.showing(stage.scene.model_copy(update={"optics": optics})), *size)
        reference.refine(REFERENCE_SAMPLES)
        references.append(tone_map(reference.linear()))
        for scale in SCALES:
            picture = renderer.picture(stage, round(size[0] * scale), round(size[1] * scale))
            picture.refine()
            frames[scale].append(picture.softened() if scale == 1 else picture.rgb())  # as they are sent
    cells = [[_cell(frames[scale], references, quality) for quality in QUALITIES] for scale in SCALES]
    return {
        "scales": SCALES,
        "qualities": QUALITIES,
        "bytes": [[size for size, _ in row] for row in cells],
        "errors": [[error for _, error in row] for row in cells],
    }


def _cell(
    frames: list[NDArray[np.uint8]], references: list[NDArray[np.floating[Any]]], quality: int
) -> tuple[int, float]:
    """Mean bytes, and mean error of what is shown."""
    sizes, errors = [], []
    for frame, truth in zip(frames, references, strict=True):
        data = jpeg.encode(frame, quality)
        shown = simplejpeg.decode_jpeg(data, "RGB") / np.float32(255)
        sizes.append(len(data))
        errors.append(radiance_error(enlarged(shown, *truth.shape[:2]), truth)["rmse"])
    return round(statistics.mean(sizes)), round(statistics.mean(errors), 4)


def _poses(scene: Scene) -> Iterator[Stage]:
    stage = Stage.of(scene)
    world = world_of(stage)
    for number in range(POSES):
        while world.state.time < number * SECONDS_APART - 1e-9:
            world.step()
        yield stage.posed([(body.position, body.orientation) for body in world.state.bodies])


def print_ladder(measure: Callable[[Renderer, Scene], dict[str, Any]]) -> None:
    """Print a ladder of the default scene as JSON, and what it was measured on."""
    renderer = Renderer()
    found = measure(renderer, Scene())
    measured = {
        "made": dt.datetime.now(dt.UTC).isoformat(timespec="seconds"),
        **provenance(renderer.describe()),
        "width": SIZE[0],
        "height": SIZE[1],
    }
    json.dump({"measured": measured, **found}, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    print_ladder(measure)

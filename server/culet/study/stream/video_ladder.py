"""Measures the ladder of video: how many bytes a moving frame of each scale and rate factor has, and what it misses.

    python -m culet.study.stream.video_ladder > server/culet/engine/governing/video_ladder.json

As `culet.study.stream.bytes_ladder` does it of JPEG, but of frames that follow each other at 30 a second. Key frames,
of which there is one in a hundred, do not count. Needs PyAV.
"""

from __future__ import annotations

import statistics
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.engine.governing.thrift import BEST_CRF
from culet.engine.painting.video import VideoEncoder
from culet.optics.tone import tone_map
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene
from culet.study.likeness.radiance_error import enlarged, radiance_error
from culet.study.stream.bytes_ladder import REFERENCE_CUTOFF, REFERENCE_SAMPLES, SCALES, SIZE, print_ladder
from culet.study.stream.falling_frames import falling
from culet.study.stream.video_frames import decoded
from culet_protocol.frame import Codec

CRFS = BEST_CRF, 23, 26, 29, 32, 35, 38, 41
FRAMES, JUDGED = 32, (9, 19, 31)
"""Of the fall: encoded, and compared with converged ones."""


def measure(renderer: Renderer, scene: Scene, size: tuple[int, int] = SIZE) -> dict[str, Any]:
    """As `thrift` reads them: bytes and errors by scale, then rate factor."""
    stages = falling(scene, FRAMES)
    references: list[NDArray[np.floating[Any]]] = []
    for place in JUDGED:
        optics = stages[place].scene.optics.model_copy(update={"cutoff": REFERENCE_CUTOFF})
        exact = stages[place].showing(stages[place].scene.model_copy(update={"optics": optics}))
        reference = renderer.picture(exact, *size)
        reference.refine(REFERENCE_SAMPLES)
        references.append(tone_map(reference.linear()))
    rows = []
    for scale in SCALES:
        frames = []
        for stage in stages:
            picture = renderer.picture(stage, round(size[0] * scale), round(size[1] * scale))
            picture.refine()
            frames.append(picture.softened() if scale == 1 else picture.rgb())  # as they are sent
        rows.append([_cell(frames, references, crf) for crf in CRFS])
    return {
        "scales": SCALES,
        "qualities": CRFS,
        "bytes": [[count for count, _ in row] for row in rows],
        "errors": [[error for _, error in row] for row in rows],
    }


def _cell(frames: list[NDArray[np.uint8]], references: list[NDArray[np.floating[Any]]], crf: int) -> tuple[int, float]:
    """Mean bytes, and mean error of what is shown."""
    height, width, _ = frames[0].shape
    encoder = VideoEncoder(Codec.H264, width, height, crf)
    packets = [encoder.encode(frame, place / 30) for place, frame in enumerate(frames)]
    shown = decoded(Codec.H264, packets)
    errors = [
        radiance_error(enlarged(shown[place] / np.float32(255), *truth.shape[:2]), truth)["rmse"]
        for place, truth in zip(JUDGED, references, strict=True)
    ]
    return round(statistics.mean(len(packet.data) for packet in packets[1:])), round(statistics.mean(errors), 4)


if __name__ == "__main__":
    print_ladder(measure)

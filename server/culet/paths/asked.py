"""What a ray is asked about by: a pixel of a picture, or an origin and a direction; and its answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, assert_never

import numpy as np

from culet.errors import SceneError
from culet.paths.answer import Path
from culet.paths.recorder import PathRecorder
from culet.paths.telling import path_of
from culet.rendering.light.effort import LightEffort
from culet.scene.camera import Camera
from culet.stage import Stage


class Pixel(NamedTuple):
    """Of a picture of that size, from its upper left corner."""

    x: int
    y: int
    width: int
    height: int


class Ray(NamedTuple):
    """From a place of the world, in a direction of any length but 0."""

    origin: tuple[float, float, float]
    direction: tuple[float, float, float]


def answered(
    recorder: PathRecorder,
    stage: Stage,
    asked: Pixel | Ray,
    *,
    wavelengths: Sequence[float] = (),
    effort: LightEffort = LightEffort.PATIENT,
    waited_for: Callable[[], bool] = lambda: True,
) -> Path:
    """SceneError for a pixel that is not in the picture, a ray that points nowhere, and what `PathRecorder` refuses."""
    record = partial(recorder.record, wavelengths=wavelengths, effort=effort, waited_for=waited_for)
    match asked:
        case Pixel(x, y, width, height):
            if not (0 <= x < width and 0 <= y < height):
                raise SceneError(
                    f"pixel: expected x from 0 to {width - 1} and y from 0 to {height - 1}, got {x},{y}", "pixel"
                )
            return path_of(record(stage, width, height, x, y))
        case Ray(origin, direction):
            seen = stage.showing(stage.scene.model_copy(update={"camera": camera_along(origin, direction)}))
            return path_of(record(seen, 1, 1, 0, 0), pixel=False)
        case _:
            assert_never(asked)


def camera_along(origin: Sequence[float], direction: Sequence[float]) -> Camera:
    """Of a picture of one pixel, whose ray is this one; SceneError if the direction is 0."""
    way = np.array(direction, dtype=float)
    length = float(np.linalg.norm(way))
    if length == 0:
        raise SceneError("ray.direction: expected any length but 0", "ray.direction")
    way = way / length
    up = (0.0, 1.0, 0.0) if abs(way[1]) < 0.999 else (0.0, 0.0, -1.0)
    x, y, z = (np.array(origin, dtype=float) + way).tolist()
    return Camera.model_validate({"position": origin, "target": (x, y, z), "up": up})

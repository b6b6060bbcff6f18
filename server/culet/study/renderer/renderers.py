"""Renderers for every way of compiling, on one device."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from culet.rendering.opencl.device import Device
from culet.rendering.programs import build
from culet.rendering.renderer import DevicePicture, Renderer
from culet.study.renderer.knobs import Knobs
from culet.study.renderer.shot import Shot

PRECISE_FLAGS = ("-cl-std=CL1.2",)
"""Without permission to reorder, fuse or approximate."""


@contextlib.contextmanager
def compiled_with(flags: tuple[str, ...]) -> Iterator[None]:
    """Programs that are built meanwhile get these flags. For a study alone: not for a process that serves."""
    usual = build.FLAGS
    build.FLAGS = flags  # type: ignore[assignment]
    try:
        yield
    finally:
        build.FLAGS = usual


class Renderers:
    """Made when they are first asked for."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self._made: dict[tuple[str, int, bool], Renderer] = {}

    def picture(self, knobs: Knobs, shot: Shot) -> DevicePicture:
        """An empty picture with these knobs; compiles what it needs."""
        stage = shot.stage.showing(knobs.applied_to(shot.stage.scene))
        if knobs.geometry == "triangles":
            stage = replace(stage, shapes=tuple(replace(shape, convex=False) for shape in stage.shapes))
        with compiled_with(build.FLAGS if knobs.relaxed_maths else PRECISE_FLAGS):
            renderer = self._renderer(knobs)
            columns, rows = (max(1, round(knobs.scale * length)) for length in (shot.width, shot.height))
            return renderer.picture(stage, columns, rows)

    def _renderer(self, knobs: Knobs) -> Renderer:
        key = knobs.precision, knobs.lanes, knobs.relaxed_maths
        if key not in self._made:
            real = np.float64 if knobs.precision == "double" else np.float32
            self._made[key] = Renderer(self.device, real=real, lanes=knobs.lanes)
        return self._made[key]

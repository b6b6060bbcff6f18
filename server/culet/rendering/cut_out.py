"""Pictures without what is behind: how much of the backdrop the camera sees at each pixel is their transparency.

A picture is linear in the radiance of what the camera sees behind everything: L = F + t B. Two pictures of the same
samples, one before a backdrop of radiance 0 and one of radiance 1, are F and F + t, so both are known exactly, without
noise of their own: at the edges of stones, and where a studio's floor mirrors or shades the backdrop. Light that stones
send to the camera comes from around them, never from the backdrop, so a stone is as opaque as it is bright or dark.

Alpha is 1 - t, t being the mean of the channels; where caustics make a studio's floor brighter than the backdrop, 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.optics.gamut import desaturate
from culet.optics.tone import tone_map
from culet.rendering.chains import is_spectral
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.backdrop import PlainBackdrop
from culet.stage import Stage

DEVELOPED = 2**16
"""Pixels that are developed at a time: some 20 ms."""


class CutOut(DevicePicture):
    """A picture of a scene in front of nothing: `linear()` and `rgb()` have a fourth channel, alpha. Where the film has
    a colour behind everything, `rgb()` is in front of that, and has three."""

    def __init__(self, renderer: Renderer, stage: Stage, width: int, height: int) -> None:
        """As a picture that `Renderer.picture` makes."""
        super().__init__(renderer, _before(stage, 0), width, height, None, None, LightEffort.PATIENT)
        light_map = None if self._light is None else self._light.bound
        self._lighter = DevicePicture(renderer, _before(stage, 1), width, height, None, light_map, None)
        self._behind = stage.scene.film.behind
        self._cut_out, self._cut_out_samples = np.zeros((height, width, 4 if self._behind is None else 3), np.uint8), 0
        """As developed last, and how many samples there were then."""

    def _one_sample(self) -> Iterator[float]:
        """One of both, by the same light map."""
        if self._lighter.samples > self.samples:  # the map has become another, and this picture has begun anew
            self._lighter.begin_anew()
        for part in super()._one_sample():
            yield part / 2
        self._lighter._level = self._level
        before, self._lighter.launch_seconds = self._lighter.seconds, self.launch_seconds
        for part in self._lighter._one_sample():
            yield (1 + part) / 2
        self.seconds += self._lighter.seconds - before

    def begin_anew(self) -> None:
        """Forget all samples."""
        super().begin_anew()
        self._cut_out_samples = 0

    def segments(self) -> int:
        """Interior segments of the last sample, of both."""
        return super().segments() + self._lighter.segments()

    def refine_until(
        self,
        target: Target,
        seconds: float,
        *,
        pause: Callable[[], bool] = lambda: False,
        due: Callable[[float], bool] = lambda _: False,
    ) -> Iterator[float]:
        """As of any picture. The error is the larger one of the two: before black and before white."""
        self._lighter.compare_as_shown()
        yield from super().refine_until(target, seconds, pause=pause, due=due)

    def meets(self, target: Target) -> bool:
        """Whether it has the error that the target asks for, if it asks for one."""
        return super().meets(target) and self._lighter.meets(target)

    def shown_error(self) -> float:
        """Estimated, of what is shown before the worse of black and white."""
        return max(super().shown_error(), self._lighter.shown_error())

    def _needed(self, target: Target) -> int:
        return max(super()._needed(target), self._lighter._needed(target))

    def linear(self, rows: slice = slice(None)) -> NDArray[np.floating[Any]]:
        """(height, width, 4), or those rows: linear radiance in front of black, which is multiplied by alpha already;
        and alpha."""
        dark, light = super().linear(rows), self._lighter.linear(rows)
        alpha = np.clip(1 - (light - dark).mean(axis=-1, keepdims=True), 0, 1)
        return np.concatenate([dark, alpha], axis=-1)

    def rgb(self) -> NDArray[np.uint8]:
        """(height, width, 4), tone-mapped colours, not multiplied by alpha, and alpha; 8 bits. In front of a colour
        (height, width, 3)."""
        for _ in self.develop_in_pieces():
            pass
        return self._cut_out

    def develop_in_pieces(self, *, soft: bool = False) -> Iterator[None]:
        """Make `rgb()` of the samples that there are, DEVELOPED pixels at a time; yields between them. None is seen but
        for a moment, so none is filtered (`soft`)."""
        assert not soft  # noqa: S101
        if self._cut_out_samples == self.samples:
            return
        shown = np.empty_like(self._cut_out)
        step = max(1, DEVELOPED // self.width)
        for begin in range(0, self.height, step):
            rows = slice(begin, begin + step)
            shown[rows] = self._developed(self.linear(rows).reshape(-1, 4)).reshape(shown[rows].shape)
            yield
        self._cut_out, self._cut_out_samples = shown, self.samples

    def _developed(self, linear: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
        """(N, 4), or (N, 3): by the references of film.cl."""
        film = self.scene.film
        alpha = linear[:, 3:].astype(np.float64)
        colour = np.divide(film.exposure * linear[:, :3], alpha, out=np.zeros((len(linear), 3)), where=alpha > 0)
        if film.gamut == "desaturate" and is_spectral(self.scene):
            colour = desaturate(colour)
        shown = tone_map(colour, film.tone_map)
        if self._behind is None:
            return np.asarray(np.rint(255 * np.concatenate([shown, alpha], axis=-1)), np.uint8)
        return np.asarray(np.rint(255 * alpha * shown + (1 - alpha) * np.array(self._behind)), np.uint8)


def _before(stage: Stage, radiance: float) -> Stage:
    backdrop = PlainBackdrop(kind="plain", colour=(radiance, radiance, radiance))
    return stage.showing(stage.scene.model_copy(update={"backdrop": backdrop}))


class CuttingRenderer(Renderer):
    """A renderer that makes cut-outs too."""

    def cut_out(self, stage: Stage, width: int, height: int) -> CutOut:
        """An empty picture of the stage in front of nothing, to be refined."""
        return CutOut(self, stage, width, height)

"""What the engine needs of a renderer; `culet.rendering.renderer.Renderer` is one.

Everything here is called from one thread only, the render thread, unless it says otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from culet.optics.panoramas import Panorama
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.scene import Scene
from culet.stage import Stage

PIECE_SECONDS = 0.025
"""That a piece of work is meant to hold the render thread: two of them are 50 ms, after which a viewer sees that frames
are late; and 100 times what it costs to begin one."""

ALONE_SECONDS = 0.05
"""The same where nobody else wants the thread: a governed frame is then one launch, however busy the machine is."""


class AnyPicture(Protocol):
    """An image that gets better with every sample."""

    @property
    def scene(self) -> Scene:
        """What it shows."""

    @property
    def samples(self) -> int:
        """Samples per pixel so far."""

    @property
    def samples_seen(self) -> int:
        """Samples per pixel in what is shown, at least."""

    @property
    def under_way(self) -> bool:
        """Whether it was left amid a sample, which some pixels have and others have not."""

    @property
    def sample_seconds(self) -> float:
        """Render seconds of the last whole sample."""

    @property
    def seconds(self) -> float:
        """Render seconds of the last refinement."""

    @property
    def light_seconds(self) -> float:
        """s of the last refinement that went into the light map, besides."""

    def refine(self, samples: int = 1) -> None:
        """Add samples to every pixel."""

    def refine_in_pieces(self, samples: int, seconds: float) -> Iterator[float]:
        """Add samples to every pixel, about so many seconds at a time; yields the part that is done, between them."""

    def refine_until(
        self, target: Target, seconds: float, *, pause: Callable[[], bool] = ..., due: Callable[[float], bool] = ...
    ) -> Iterator[float]:
        """The same until the target is reached; after each sample `pause` is asked whether to leave it at that. `due`
        tells whether somebody is to see it within so many seconds: then it may be left amid a sample too."""

    def reached(self, target: Target) -> bool:
        """Whether there is nothing left to do for it: its error is met, or its samples are there."""

    def meets(self, target: Target) -> bool:
        """Whether it has the error that the target asks for, if it asks for one."""

    def shown_error(self) -> float:
        """Root mean square error of what is shown, from 0 to 1, that more samples would take away: estimated. NaN below
        two samples, and without `refine_until`."""

    def give_up(self) -> None:
        """Nobody goes on with it. Amid a sample it and what it is at hold each other, until this is called."""

    def develop_in_pieces(self, *, soft: bool = False) -> Iterator[Any]:
        """Tone-map for `rgb`, or with `soft` for `softened`, yielding between short pieces of work."""

    def overlaid(self, over: NDArray[np.uint8]) -> Iterator[NDArray[np.uint8]]:
        """Amid a sample: tone-mapped where that is done, over a picture (height, width, 3) of what was seen before;
        yields it between short pieces of work, and at last whole."""

    def rgb(self) -> NDArray[np.uint8]:
        """(height, width, 3), tone-mapped; at once if that was done in pieces."""

    def softened(self) -> NDArray[np.uint8]:
        """The same, filtered: of a single sample a pixel it is nearer to what more would show. At once if it was so
        developed in pieces."""

    def cut(self) -> float:
        """Mean weight of what the cut-off dropped."""

    def error_estimate(self) -> float:
        """Root mean square error of the radiance; NaN below two samples."""

    def light_error(self) -> float:
        """Root mean square error of its light map, estimated; NaN without a map."""

    def light_bound(self) -> float:
        """Part of the stones' light that its map may miss, at most; NaN without a map."""

    def shows_shadows_only(self) -> bool:
        """Whether its map shows nothing of what goes through the stones."""


class AnyRenderer(Protocol):
    """A device that draws scenes."""

    def picture(
        self, stage: Stage, width: int, height: int, *, effort: LightEffort = LightEffort.PATIENT
    ) -> AnyPicture:
        """An empty picture of the stage, with that effort on its light map."""

    def cut_out(self, stage: Stage, width: int, height: int) -> AnyPicture:
        """The same in front of nothing: with alpha, and twice the work."""

    def forget(self, panorama: Panorama) -> None:
        """A sky that no scene shows any more. From any thread."""

    def held(self) -> Mapping[str, int]:
        """Bytes of memory, by what takes them. From any thread."""

    def release(self) -> None:
        """Give back all memory that no picture has. While no picture is refined."""

    def trim(self) -> None:
        """Give back the memory of pictures that are gone. From any thread."""

    def is_ready(self, stage: Stage, samples: int = 0) -> bool:
        """Whether the next sample of a picture that has so many can be begun at once."""

    def make_ready(self, stage: Stage, samples: int = 0) -> None:
        """Make it so: have programs compiled and trees made, which may take seconds. Called from any thread."""

    def describe(self) -> Mapping[str, Any]:
        """Device, driver and lanes."""

"""The light map of one stage: made in passes, whose mean it is, and honest about what it misses."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import replace
from enum import Enum, auto

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.chains import is_spectral
from culet.rendering.emitters.light_map import CHANNELS, LEVELS, SIZE, BoundMap, Figures
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.sources import rays_of
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.passes import Passes
from culet.rendering.light.photons import PhotonMaps
from culet.rendering.light.solids import takes_only_beams
from culet.stage import Stage

TARGET = 2e-3
"""Estimated root mean square error at which a map is good enough, in parts of the brightest emitter's irradiance over
pi: a quarter of a step of 8 bits in the middle of the scale."""
MOST_PASSES = 64
"""Two seconds of a sun, whose error is then a fifth of a percent of its light."""
SHADOWS = 2048
"""Of stones on surfaces by rays, in all passes of a picture: 340 directions of each of six lamps past one stone on a
floor. Of twelve stones, six lamps and four surfaces a single pass has twice as many."""
PHOTON_PASSES = 8
"""Four million photons, some seconds."""
FEWEST_PASSES = 4
"""Two of them tell the error."""
FALL = 0.5
"""Cut-off of a pass over that of the one before."""
LEAST_CUTOFF = 1e-6
"""R^2 of the brightest emitter's irradiance. What remains is 1 % of the light, and costs a quarter of a second."""
RANDOM_CUTOFF = 3e-5
"""The same, of the first passes of lamps that are as many directions as there are passes: one is not worth more."""
FEW_PASSES = 16
"""After which, of such lamps, the cut-off falls as 1 / passes: what it takes then weighs more than the directions."""
LASTING = 0.5
"""Of the error that a cut-off makes in a pass, what the mean of many directions or wavelengths keeps: measured on a sun
of 0.27 degrees (`culet study caustics`)."""
PHOTONS = 30.0
"""Of each channel, over the cut-off: at 1e-3 then 30,000 photons, whose error is like that of beams."""
FIRST_PHOTONS = 30_000
"""In the first pass at most, in the next twice as many, and so on."""
LEAST_PHOTONS = 3000
"""Of a moving frame: fewer make blots that jump, and nothing is better."""
MOVING_PHOTON_SECONDS = 0.012
"""s of a moving frame that photons may take: a third of the time at 30 frames/s."""


class Maker(Enum):
    """How light is followed through the stones."""

    NOTHING = auto()
    """Not at all: only shadows are shown. The scene asks for that, or photons would take too long."""
    BEAMS = auto()
    PHOTONS = auto()


class Illumination:
    """The light map of one stage: the mean of its passes."""

    def __init__(self, of: Passes, stage: Stage, bound: BoundMap) -> None:
        self.stage, self.bound = stage, bound
        self.passes = 0
        self.version = 0
        """Passes ever made: another number is another map."""
        self.seconds = 0.0
        """Spent on all passes."""
        self.maker = Maker.NOTHING
        self.cutoff = math.inf
        """Of the finest pass."""
        self.figures: Figures | None = None
        """Of the finest pass, but for the error, which is the mean's."""
        self._of = of
        self._start = math.nan
        """Cut-off of the first pass."""
        self.provisional = False
        """Made for a moving picture, in a hurry."""
        self._running: Generator[object, None, None] | None = None
        """The pass under way. A picture that is given up leaves it to the next one: none is left out or made twice."""
        self._waiting = 0
        """Pictures that wait for the pass under way."""
        self._left_at = math.inf
        """s, `time.monotonic`: when the last one left it."""
        self._weight = 0.0
        self._squared = 0.0
        self._bias = 0.0
        """Weights' sum times what the cut-offs of passes let expect of the mean's error."""
        self._spread: list[float] = []
        """Estimates of a single pass's variance, of weight 1."""
        self._before: NDArray[np.float32] | None = None
        self._photons: PhotonMaps | None = None
        rays = rays_of(stage, 0)
        self._brightness = max(_whole(rays), default=0.0)
        self._by_beams = takes_only_beams(stage)
        self._random = is_spectral(stage.scene) or not self._by_beams or any(ray.position is None for ray in rays)
        """Whether passes differ in more than their cut-offs."""
        shadows = len(rays) * len(stage.scene.stones) * len(bound.frame.matte)
        fewer = min(max(FEWEST_PASSES, SHADOWS // max(1, shadows)), MOST_PASSES)
        self._most_passes = fewer if self._by_beams else PHOTON_PASSES
        """A count, and not a time: the same scene gives the same picture."""

    @property
    def rmse(self) -> float:
        """Estimated error of the map, root mean square over its finer level, as radiance of a white surface. A single
        pass of photons does not tell it: NaN; one of beams tells what its cut-off makes, and not what a lamp's one
        direction does."""
        if self.passes == 0 or (self.maker is Maker.PHOTONS and not self._spread):
            return math.nan
        bias, alone = self._bias / self._weight, self._squared / self._weight**2
        if self._random:
            bias *= math.sqrt(LASTING**2 + (1 - LASTING**2) * alone)
        variance = float(np.mean(self._spread)) * alone if self._spread else 0.0
        return math.hypot(bias, math.sqrt(variance))

    @property
    def good_enough(self) -> bool:
        """Whether more passes are not worth their time."""
        if self.maker is Maker.NOTHING and self.passes and not self._random:
            return True
        settled = self.passes > 0 and (not self._random or len(self._spread) > 1)
        return self.passes >= self._most_passes or (settled and self.rmse <= TARGET * max(self._brightness, 1e-30))

    def pieces(
        self,
        cutoff: float,
        effort: LightEffort,
        seconds: float,
        *,
        first: bool = False,
        meanwhile: Callable[[], None] | None = None,
    ) -> Iterator[object]:
        """Make the map as good as is fitting, in launches of about so many seconds; yields between them.

        A map that is as fine as the cut-off asks serves a moving picture as it is. A map that was made for one is made
        anew for other pictures, which depend on their scene alone. Before the `first` sample of a resting picture it
        takes one pass, or whatever there is already, so that there is soon something to see. `meanwhile` may be called
        while a launch for a moving picture is under way: of what the picture needs besides.
        """
        if effort is LightEffort.RESTING and first and self.passes > 0:
            return
        if effort is LightEffort.MOVING:
            # By and by: a pass that was waited for may have failed, or be begun anew when another stage's is done.
            while self.passes == 0 or (self.provisional and self.cutoff > cutoff):
                if self._running is None or (self.provisional and self._start > cutoff):
                    self._begin(cutoff, provisional=True)
                yield from self._advance(cutoff, effort, seconds, meanwhile)
            return
        while self.passes == 0 or self.provisional or self._start != cutoff:
            if self.provisional or self._start != cutoff:
                self._begin(cutoff, provisional=False)
            yield from self._advance(cutoff, effort, seconds)
        if effort is LightEffort.RESTING and first:
            return
        while not self.good_enough:
            least = LEAST_CUTOFF
            if self._random:
                falls = min(1.0, FEW_PASSES / max(1, self.passes)) if self._by_beams else 1.0
                least = max(least, RANDOM_CUTOFF * falls)
            if not self._random and self.cutoff <= least:
                break
            yield from self._advance(max(least, min(self.cutoff, cutoff) * FALL), effort, seconds)
        self._of.forget_beams()

    def _begin(self, cutoff: float, *, provisional: bool) -> None:
        """Anew, as if there were no pass; what is in the map stays there until the first one is done. A pass that is
        under way ends without being added."""
        if self._running is not None:
            self._running.close()
        self._start, self.provisional, self._running = cutoff, provisional, None
        self.passes = 0
        self.cutoff, self.maker = math.inf, Maker.NOTHING
        self._weight = self._squared = self._bias = 0.0
        self._spread.clear()

    def _advance(
        self, cutoff: float, effort: LightEffort, seconds: float, meanwhile: Callable[[], None] | None = None
    ) -> Iterator[object]:
        """Go on with the pass under way, or else with a new one; if another picture begins anew, with that one's. A new
        pass waits for the one of another stage, or is spared if a picture of this stage has made one meanwhile."""
        if self._running is None:
            made = self.version
            yield from self._of.others_end(effort)
            if self.version != made:
                return
        self._running = self._running or self._pass(cutoff, effort, seconds, meanwhile)
        self._waiting += 1
        try:
            while self._running is not None:
                running = self._running
                try:
                    for piece in running:  # noqa: UP028 - that would end it with the picture that it is made for
                        yield piece
                except Exception:
                    self._running = None  # it has ended without a pass
                    raise
                if self._running is running:
                    self._running = None
                if self.passes > 0:
                    return
        finally:
            self._waiting -= 1
            self._left_at = time.monotonic()

    def give_up_left(self, seconds: float) -> None:
        """End the pass under way, without adding it, if nobody has waited for it for so long."""
        if self._running is not None and self._waiting == 0 and time.monotonic() - self._left_at >= seconds:
            self._running.close()
            self._running = None

    def end_pass(self) -> Iterator[object]:
        """Let the pass under way end, for a picture of another stage, or give it up if none of this stage waits for it.
        If it fails, the other picture does not learn of it: the one that it is for makes it again."""
        while (running := self._running) is not None:
            if self._waiting == 0:
                running.close()
            try:
                piece = next(running)
            except Exception:  # that there is no more, or its failure
                if self._running is running:
                    self._running = None
            else:
                yield piece

    def _pass(
        self, cutoff: float, effort: LightEffort, seconds: float, meanwhile: Callable[[], None] | None
    ) -> Generator[object, None, None]:
        """One pass more, the only one of such an effort."""
        with self._of.under_way(effort, self):
            yield from self._made(cutoff, effort, seconds, meanwhile)

    def _made(
        self, cutoff: float, effort: LightEffort, seconds: float, meanwhile: Callable[[], None] | None
    ) -> Generator[object, None, None]:
        number, started, scene = self.passes, time.perf_counter(), self.stage.scene
        rays = rays_of(self.stage, number, moving=effort is LightEffort.MOVING)
        follows = scene.optics.caustics == "on"
        if self._by_beams:
            weight = cutoff**-0.5  # the error that lamps' directions make does not fall with the cut-off
            before, keep, gain = self._weigh(weight, anew=not self._random)
            beams = self._of.take_beams()
            try:
                figures = yield from beams.pieces(
                    self.stage, rays, self.bound.frame, lambda: self.bound.buffer, cutoff=cutoff, seconds=seconds,
                    number=number, keep=keep, gain=gain, meanwhile=meanwhile,
                )  # fmt: skip
            finally:
                self._of.give_back(beams)
            maker, bias = Maker.BEAMS if follows else Maker.NOTHING, figures.rmse if follows else 0.0
        else:
            if self._photons is None:
                self._photons = self._of.photons.maps(self.stage, self.bound.frame)
            photons = min(PHOTONS / cutoff, FIRST_PHOTONS * 2.0**number)
            if effort is LightEffort.MOVING:
                photons = min(photons, MOVING_PHOTON_SECONDS / self._photons.photon_seconds)
                follows = follows and photons >= LEAST_PHOTONS
            maker, bias, weight = Maker.PHOTONS if follows else Maker.NOTHING, 0.0, photons
            made = self._of.scratch(self.bound.frame.nbytes)
            yield from self._photons.pieces(
                made, rays, number=number, photons=round(max(photons, LEAST_PHOTONS)), seconds=seconds, follow=follows
            )
            before, keep, gain = self._weigh(weight, anew=maker is not self.maker)
            self._photons.join(self.bound.buffer, made, keep, gain)
            assert self._photons.figures is not None  # noqa: S101 - of the pass that is done
            figures = self._photons.figures
        self._count(weight, bias, gain, before, anew=keep == 0)
        self.maker, self.passes, self.version = maker, self.passes + 1, self.version + 1
        self.seconds += time.perf_counter() - started
        self.cutoff = min(self.cutoff, cutoff)
        self.figures = replace(figures, rmse=self.rmse, seconds=self.seconds)

    def _weigh(self, weight: float, *, anew: bool) -> tuple[list[NDArray[np.float32]] | None, float, float]:
        """The map before a pass of that weight, and what of the map is kept, and of the pass added."""
        if anew or self._weight == 0:
            return None, 0.0, 1.0
        gain = weight / (self._weight + weight)
        return list(self._fine()), 1 - gain, gain

    def _count(
        self, weight: float, bias: float, gain: float, before: list[NDArray[np.float32]] | None, *, anew: bool
    ) -> None:
        """A pass was added."""
        if anew:
            self._weight = self._squared = self._bias = 0.0
            self._spread.clear()
        if before is not None:  # the variance of a pass, less that of the mean so far
            both = zip(self._fine(), before, strict=True)  # a surface at a time: all take 50 MiB
            apart = [float(np.mean(np.square(now - then, dtype=np.float64))) for now, then in both]
            self._spread.append(math.fsum(apart) / len(apart) / gain**2 / (1 + self._squared / self._weight**2))
        self._weight += weight
        self._squared += weight**2
        self._bias += weight * bias

    def _fine(self) -> Iterator[NDArray[np.float32]]:
        """(SIZE, SIZE, CHANNELS) the finer level of each surface that has a map."""
        for surface in self.bound.frame.matte:
            found = np.empty((SIZE, SIZE, CHANNELS), np.float32)
            cl.enqueue_copy(self._of.device.queue, found, self.bound.buffer, src_offset=surface * LEVELS * found.nbytes)
            yield found


def _whole(rays: Sequence[LightRay]) -> Iterator[float]:
    """Brightness of each emitter."""
    sums: dict[int, float] = {}
    for ray in rays:
        sums[ray.emitter] = sums.get(ray.emitter, 0.0) + ray.brightness
    yield from sums.values()

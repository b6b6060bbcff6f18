"""The light maps of a device: made in passes, and kept while neither stones nor emitters change."""

from __future__ import annotations

import math
import pickle
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from enum import Enum, auto
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

import culet_kernels
from culet.rendering.chains import band_count, is_spectral
from culet.rendering.emitters.light_map import CHANNELS, LEVELS, SIZE, BoundMap, Figures, frame_of
from culet.rendering.emitters.open_sky import is_known
from culet.rendering.emitters.panorama_light import is_summed, panorama_light
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.sources import mapped_surfaces, rays_of
from culet.rendering.emitters.unshaded import sky_light
from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.photons import PhotonMaps, Photons, needed
from culet.rendering.light.solids import FEW, takes_beams
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.apart import run_apart
from culet.rendering.opencl.compiling import compiling
from culet.rendering.opencl.device import Device
from culet.rendering.opencl.making import alone, lacks
from culet.rendering.programs.build import recipe
from culet.rendering.room.surfaces import shown
from culet.stage import Stage

KEPT = 2**25
"""Bytes of maps that are kept, the latest used last: five of a floor, of 6 MiB each, or one of floor and walls, of 24.
One of a moving picture is kept until one is made of the same stones elsewhere: each frame has its own, of which only
the last may be shown again, at rest. Pictures keep theirs besides."""
LEFT_SECONDS = 2.0
"""For which a pass is kept that nobody waits for any more: the next picture of the same stage goes on with it, as after
a frame that showed something sooner."""
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
APART = (sys.executable, "-m", "culet.rendering.light.precompile")
"""The process that compiles programs of light, which takes a stage."""
COARSEST = 1.0
"""A cut-off at which hardly anything is followed."""
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


class Lighting:
    """Of one device. One thread at a time makes maps."""

    def __init__(self, device: Device, allocate: Callable[[int], Any], *, apart: bool = False) -> None:
        """`allocate` makes a buffer of so many bytes on the device, for maps. `apart`: `make_ready` has programs that
        the driver's cache does not have compiled by a process of its own."""
        self.device = device
        self._apart = apart
        self._allocate = allocate
        self._kept: dict[_Key, Illumination] = {}
        self._beams: list[Beams] = []
        """That are at no pass."""
        self._first: Beams | None = None
        """Whose programs the others share."""
        self._under_way: dict[LightEffort, Illumination] = {}
        """Whose pass has begun and is not done yet. Of each effort there is one at a time: a pass holds 8 MiB a surface
        for each core, and ten pictures would hold that ten times."""
        self._warm: set[BeamPrograms] = set()
        """Kinds of stages for whose beams there is machine code."""
        self._making_ready = threading.Lock()
        self.photons = Photons(device)

    def of(self, stage: Stage) -> Illumination | None:
        """What there is, or will be, of a stage's map; None where no surface has one."""
        if not mapped_surfaces(stage):
            return None
        key = _key(stage)
        known = self._kept.pop(key, None)
        if known is None:
            before = [other for other, each in list(self._kept.items()) if each.provisional and other[1:] == key[1:]]
            for other in before:
                self._kept.pop(other, None)  # another thread may have given it back
            frame = frame_of(stage)
            known = Illumination(self, stage, BoundMap(frame, self._allocate))
        self._kept[key] = known
        held = 0
        for other, each in reversed(list(self._kept.items())):
            held += each.bound.frame.nbytes
            if held > KEPT and each is not known:
                self._kept.pop(other, None)
        return known

    def is_ready(self, stage: Stage) -> bool:
        """Whether a picture's light can be had without waiting for a compiler, for a panorama's sum, or for what a room
        leaves of the sky."""
        room = shown(stage.scene)
        if stage.panorama is not None and room and not is_summed(stage.panorama):
            return False
        if not is_known(room):
            return False
        if not mapped_surfaces(stage):
            return True
        return beams_of(stage) in self._warm if takes_only_beams(stage) else self.photons.is_ready(stage)

    def make_ready(self, stage: Stage) -> None:
        """Have the programs that are needed compiled, in any thread, and one after the other: a compiler takes some
        100 MiB, and so does the pass."""
        if stage.panorama is not None and shown(stage.scene):
            panorama_light(stage.panorama)
        sky_light(stage)
        with self._making_ready:
            if self.is_ready(stage):
                return
            cache, program = kernel_cache.folder(), self._recipe(stage)
            # The stage is sent to that process; a panorama, which may have hundreds of MiB, is not.
            if self._apart and stage.panorama is None and lacks(cache, program):
                run_apart(APART, {}, pickle.dumps(stage))
            with alone(cache, program):
                self._compile(stage)

    def _recipe(self, stage: Stage) -> str:
        """Of the programs that `_compile` asks for."""
        if takes_only_beams(stage):
            return recipe(self.device, "beams.cl", culet_kernels.source("light_sum.cl"), beams_of(stage))
        return recipe(self.device, "photons.cl", "and launched", needed(stage))

    def _compile(self, stage: Stage) -> None:
        """By a pass of next to no light in a queue of its own, since machine code is made at the first launch."""
        device = replace(self.device, queue=cl.CommandQueue(self.device.context))
        frame = frame_of(stage)
        target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
        rays = rays_of(stage, 0)
        with compiling():
            if takes_only_beams(stage):
                Beams(device).make(stage, rays, frame, target, cutoff=COARSEST)
                self._warm.add(beams_of(stage))
            else:
                photons = Photons(device)
                for _ in photons.maps(stage, frame).pieces(target, rays[:1], number=0, photons=1):
                    pass
                self.photons.prepare(stage)

    def forget(self) -> None:
        """All maps; pictures that are being made of them go on."""
        self._kept.clear()

    def release(self) -> None:
        """Give back what is kept for the next pass, the maps of moving frames, and passes that nobody waits for.
        Pictures and passes that are under way have their own. While no picture is refined."""
        for each in list(self._under_way.values()):
            each.give_up_left(0.0)
        self.forget_beams()
        self.forget_provisional()

    def forget_provisional(self) -> None:
        """Give back the maps of moving frames that no picture has. From any thread, also while pictures are refined."""
        for key, each in list(self._kept.items()):
            if each.provisional:
                self._kept.pop(key, None)

    def give_up_left(self) -> None:
        """Passes that nobody has waited for a while. One holds what it sums, and would do so until another picture of
        the same effort has a pass."""
        for each in list(self._under_way.values()):
            each.give_up_left(LEFT_SECONDS)

    def others_end(self, effort: LightEffort) -> Iterator[object]:
        """Let the pass of such an effort that is under way end, whoever it is for, or give it up if nobody waits for
        it; yields between its launches."""
        while (other := self._under_way.get(effort)) is not None:
            yield from other.end_pass()

    @contextmanager
    def under_way(self, effort: LightEffort, illumination: Illumination) -> Iterator[None]:
        """For as long as a pass takes."""
        self._under_way[effort] = illumination
        try:
            yield
        finally:
            del self._under_way[effort]

    def take_beams(self) -> Beams:
        """For one pass; passes of pictures of different efforts may be under way by turns."""
        with suppress(IndexError):  # another thread may have given back what there was
            return self._beams.pop()
        self._first = self._first or Beams(self.device)
        return Beams(self.device, like=self._first)

    def give_back(self, beams: Beams) -> None:
        """For the next pass. Of several whose passes were under way by turns one is kept: each holds up to 8 MiB a
        surface for each core, and for each point a quarter of that. Those of a pass that was given up are not."""
        if beams.clean and not self._beams:
            self._beams.append(beams)

    def forget_beams(self) -> None:
        """Give back what is kept for the next pass. While no picture is refined, or by who refines it: buffers wait for
        the device before they go."""
        self._beams.clear()

    def scratch(self, size: int) -> Any:  # noqa: ANN401
        """Memory for a pass that is not whole yet."""
        return self._allocate(size)


def takes_only_beams(stage: Stage) -> bool:
    """Whether all stones are such that beams are followed, or else photons."""
    return all(map(takes_beams, stage.shapes))


class BeamPrograms(NamedTuple):
    """Which programs the beams of a stage need."""

    many_facets: bool
    several: bool
    """Stones."""
    polarised: bool
    points: bool
    lamps: bool


def beams_of(stage: Stage) -> BeamPrograms:
    """Those of a stage."""
    points = [ray.position is not None for ray in rays_of(stage, 0)]
    return BeamPrograms(
        any(len(shape.planes) > FEW for shape in stage.shapes),
        len(stage.shapes) > 1,
        stage.scene.optics.polarised,
        any(points),
        not all(points),
    )


class _Key(NamedTuple):
    """What a map depends on."""

    stones: object
    shapes: tuple[int, ...]
    light: object
    room: tuple[str, str]
    optics: tuple[object, ...]


def _key(stage: Stage) -> _Key:
    scene = stage.scene
    optics = scene.optics
    return _Key(
        scene.stones,
        tuple(map(id, stage.shapes)),
        (scene.emitters, scene.environment, id(stage.panorama)),
        (scene.floor.kind, scene.walls.kind),
        (optics.fresnel, band_count(scene), optics.polarised, optics.caustics, optics.max_bounces, scene.millimetres),
    )


class Illumination:
    """The light map of one stage: the mean of its passes."""

    def __init__(self, of: Lighting, stage: Stage, bound: BoundMap) -> None:
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

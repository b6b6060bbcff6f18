"""Pictures of scenes, refined sample by sample."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.optics.panoramas import Panorama
from culet.rendering.bounds import largest_radiance
from culet.rendering.emitters.light_map import BoundMap
from culet.rendering.features import Features, by_half_spaces, features_of
from culet.rendering.film.fireflies import Fireflies, FireflyKernels
from culet.rendering.film.shown_difference import ShownDifference, film_arguments
from culet.rendering.film.softening import Softening
from culet.rendering.film.sums import Fold, Sums
from culet.rendering.film.target import Target
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.illumination import Maker
from culet.rendering.light.lighting import Lighting
from culet.rendering.opencl.device import Device, Real, open_device
from culet.rendering.opencl.layout import constants
from culet.rendering.pace import KernelPace
from culet.rendering.programs.build import OF_ITEMS, TILES_DEALT, Kernel, Variant, build, progress_size, tile_of
from culet.rendering.programs.program import Programs
from culet.rendering.stones.facet_rows import facet_rows, has_facet_rows
from culet.rendering.stones.tree import has_tree, tree_of
from culet.rendering.tracing import Tracing, Tracings, needed_features
from culet.scene.model import Scene
from culet.stage import Stage

TALLIES = constants("tile.cl")["TALLIES"]
"""Numbers for each tile."""
LATER, ASIDE = constants("film.cl")["LATER"], constants("film.cl")["ASIDE"]
"""Which sums `develop` adds to the earlier run."""
ALMOST = 1 - 2**-20
"""The part of a sample that is done when its pixels are, but not what comes after."""
LIGHT_FOR_SAMPLES = 1.0
"""s that passes of light get for each second of samples that are shown meanwhile, and made anew in the light that there
is at last. So the light of a picture at rest takes at most twice as long as if nothing were seen of it."""
SOON = 0.1
"""s. A sample that ends as soon is shown when it is whole."""
MIXED = -1
"""Version of the map that samples saw which saw several."""
DEVELOP_BLOCK = 16
"""Pixels of a work-item that develops, as in film.cl."""
DEVELOP_GROUP = 16
"""Work-items of a group. Always as many, or PoCL would make machine code anew for many a picture's size: 0.2 s each."""
DEVELOPED = 2**19
"""Pixels that are developed at a time: some 7 ms. With more than 65535 work-items PoCL would make machine code anew."""
LEVELS = 2, 1
"""Of batches, by preference: 4^level samples of each pixel that are drawn at once."""
LARGEST_BATCH = 2**24
"""Samples of all pixels: some seconds of the default scene, by which a still that runs out of time ends later."""
KEPT = 2**24
"""Bytes that are kept beyond what pictures had at most at a time lately: frames that change their sizes would else
leave some of each size. Less would free, and have cleared by the system anew, what the next frame needs."""
LATELY = 1.0
"""s; longer than the time between the frames of whoever looks at something that moves."""


class Renderer:
    """Makes pictures on one device. One thread at a time may refine them."""

    def __init__(
        self,
        device: Device | None = None,
        *,
        real: Real = np.float32,
        lanes: int | None = None,
        background_compile: bool = False,
        special_programs: bool = True,
    ) -> None:
        """Open the device (DeviceError if none works). With `background_compile` a picture never waits for a special
        program: the general one serves until it is ready; without `special_programs` for good. Then what the driver's
        cache does not have is compiled by processes of their own, too."""
        self.device = device or open_device()
        self.variant = Variant(lanes=lanes or self.device.lanes_for(real), real=real)
        self.programs = Programs(self.device, apart=background_compile)
        self._background_compile, self._special_programs = background_compile, special_programs
        self.pool = cl.tools.MemoryPool(cl.tools.ImmediateAllocator(self.device.queue))
        self._most, self._most_before, self._since = 0, 0, time.monotonic()
        """Bytes that pictures had at most at a time: since a moment less than LATELY ago, in as long before that, and
        that moment."""
        self.fold = Fold(self.device, self.variant)
        self.lighting = Lighting(self.device, self.allocate, apart=background_compile)
        self._paces: dict[tuple[Any, int], KernelPace] = {}
        film = build(self.device, "film.cl", self.variant.options)
        self.develop = cl.Kernel(film, "develop")
        self.shown_difference = ShownDifference(self.device, film)
        self.softening = Softening(self.device, film, self.allocate)
        self._firefly_kernels: FireflyKernels | None = None
        self._warm_up()

    def prepare(self) -> None:
        """Make the program that serves most scenes until a special one is ready, so that no picture waits for it."""
        self.programs.prepare(Features().general, self.variant)

    def kernel_for(self, features: Features, *, asked_for: bool) -> Kernel:
        """The kernel for what needs these features, or for just them where they were asked for."""
        if not (asked_for or self._special_programs):
            return self.programs.exact(features.general, self.variant)
        get = self.programs.best if self._background_compile else self.programs.exact
        return get(features, self.variant)

    def picture(
        self,
        stage: Stage,
        width: int,
        height: int,
        *,
        features: Features | None = None,
        effort: LightEffort | None = LightEffort.PATIENT,
        light_map: BoundMap | None = None,
    ) -> DevicePicture:
        """An empty picture of the stage, to be refined. `features` asks for another program than the stage needs.

        `effort` on its light map; or a map that was made elsewhere. With neither only points throw shadows, and nothing
        throws caustics.
        """
        self.lighting.passes.give_up_left()
        return DevicePicture(self, stage, width, height, features, light_map, effort)

    def forget(self, panorama: Panorama) -> None:
        """A sky that no scene shows any more."""
        self.device.forget(panorama)

    def held(self) -> dict[str, int]:
        """Bytes of memory, by what takes them: pictures, and the device's copies of skies."""
        return {"pictures": int(self.pool.managed_bytes), "device_skies": self.device.panorama_bytes()}

    def release(self) -> None:
        """Give back the memory of pictures and of passes of light that are gone, which is kept for the next ones, and
        passes that nobody waits for. While no picture is refined."""
        self.lighting.release()
        self._free_kept()

    def trim(self) -> None:
        """Give back what is kept of pictures and maps that are gone. From any thread, also while pictures are refined,
        which may be in the midst of a pass that nobody waits for."""
        self.lighting.forget_provisional()
        self._free_kept()

    def _free_kept(self) -> None:
        self.pool.free_held()
        self._most = self._most_before = self.pool.active_bytes

    def allocate(self, size: int) -> Any:  # noqa: ANN401 - pyopencl has no types
        """A buffer of so many bytes, by preference one of a picture that is gone. Those that are kept are given back
        when there are KEPT more than pictures had at most at a time in the last second or two, or since the last were
        given back."""
        now = time.monotonic()
        if now - self._since >= LATELY:
            # What is there now was there when the time was up, or is of pictures that came since.
            long_ago = now - self._since >= 2 * LATELY
            self._most_before = self.pool.active_bytes if long_ago else self._most
            self._most, self._since = self.pool.active_bytes, now
        if self.pool.managed_bytes > max(self._most, self._most_before) + KEPT:
            self._free_kept()
        buffer = self.pool.allocate(size)
        self._most = max(self._most, self.pool.active_bytes)
        return buffer

    def fireflies(self, pixels: int, exposure: float) -> Fireflies:
        """What leaves out the fireflies of a picture of so many pixels."""
        self._firefly_kernels = self._firefly_kernels or FireflyKernels(self.device, self.variant)
        return Fireflies(self._firefly_kernels, self.allocate, pixels, exposure)

    def _warm_up(self) -> None:
        """Have machine code made of what every picture needs, before any picture waits for it."""
        scratch = cl.Buffer(self.device.context, cl.mem_flags.READ_WRITE, 64)
        none = np.int32(0)
        self.develop(
            self.device.queue, (DEVELOP_GROUP,), (DEVELOP_GROUP,), scratch, scratch, scratch, none, scratch, none, none,
            np.float32(0), none, none,
        )  # fmt: skip
        self.fold.warm_up(scratch)
        self.shown_difference.warm_up(scratch)
        self.softening.warm_up(scratch)
        self.device.queue.finish()

    def pace_of(self, kernel: Kernel, triangles: int) -> KernelPace:
        """What is known of that program's steps, with stones of about so many triangles."""
        return self._paces.setdefault((kernel, triangles.bit_length()), KernelPace())

    def is_ready(self, stage: Stage, samples: int = 0) -> bool:
        """Whether the next sample of a picture that has so many can be begun without waiting for a compiler, a mesh's
        tree or a cut's symmetry."""
        features = needed_features(stage, samples)
        found = all(has_facet_rows(shape) if by_half_spaces(shape) else has_tree(shape) for shape in stage.shapes)
        has_program = any(self.programs.is_ready(each, self.variant) for each in (features, features.general))
        return found and has_program and self.lighting.is_ready(stage)

    def make_ready(self, stage: Stage, samples: int = 0) -> None:
        """Have what `is_ready` asks for made, while pictures are refined in another thread."""
        features = needed_features(stage, samples)
        for shape in stage.shapes:
            if by_half_spaces(shape):
                facet_rows(shape)
            else:
                tree_of(shape)
        self.programs.prepare(features.general, self.variant)
        self.lighting.make_ready(stage)

    def describe(self) -> dict[str, str | int]:
        """Device, driver and lanes, for reports."""
        return {
            "device": self.device.name,
            "driver": self.device.driver,
            "units": self.device.units,
            "lanes": self.variant.lanes,
            "precision": "double" if self.variant.real is np.float64 else "single",
        }


def jitter(sample: int, kind: str = "box") -> tuple[float, float]:
    """Where a sample lies, from its pixel's upper left corner, in pixels: the centre first, then the R2 sequence (M.
    Roberts, The unreasonable effectiveness of quasirandom sequences, 2018), spread as the reconstruction filter weighs
    (M. Ernst et al., Filter Importance Sampling, 2006)."""
    x, y = (0.5 + sample * 0.7548776662466927) % 1, (0.5 + sample * 0.5698402909980532) % 1
    return (x, y) if kind == "box" else (_tent(x), _tent(y))


def _tent(u: float) -> float:
    """The tent's inverse distribution: from 0.5 - 1 to 0.5 + 1 pixels, half of it within the pixel's middle 0.59."""
    return 0.5 + (math.sqrt(2 * u) - 1 if u < 0.5 else 1 - math.sqrt(2 - 2 * u))


class DevicePicture:
    """A scene seen at a size: sums of linear radiance on the device, one more sample of each pixel at a time."""

    def __init__(
        self,
        renderer: Renderer,
        stage: Stage,
        width: int,
        height: int,
        features: Features | None,
        light_map: BoundMap | None,
        effort: LightEffort | None,
    ) -> None:
        self.stage, self.width, self.height = stage, width, height
        self.seconds = 0.0
        """Spent by the last refinement."""
        self.light_seconds = 0.0
        """Spent by the last refinement on the light map."""
        self.launch_seconds = math.inf
        """That a launch is meant to take."""
        self.sample_seconds = 0.0
        """Spent on the last whole sample."""
        self._sampling: Iterator[float] | None = None
        """The sample, or batch, under way. A picture that is left amid one goes on with it."""
        self._level = 0
        """Of that batch; of a sample by itself 0."""
        self._tallied = 0
        """That of which tallies are on the device."""
        self._lighting: Iterator[object] | None = None
        """The light on its way to be good enough, the same."""
        self._under_way_seconds = self._part = 0.0
        """Spent on the sample, or batch, under way, s, and the part of its tiles that are done."""
        self._light_spent = self._samples_spent = 0.0
        """s on passes of light, and on samples, while the light got better."""
        self._renderer = renderer
        real = renderer.variant.real
        needed = features_of(stage)
        asked_for, features = features is not None, features or needed
        if features.estimator != needed.estimator:
            raise ValueError(f"features: expected estimator {needed.estimator}, the scene's, got {features.estimator}")
        if features.stones < needed.stones:
            raise ValueError(f"features: expected stones {needed.stones}, the scene's, got {features.stones}")
        self._effort, self._light = effort or LightEffort.PATIENT, None
        if effort is not None and light_map is None and features.light_map != 0:
            self._light = renderer.lighting.of(stage)
        bound = self._light.bound if self._light else light_map
        triangles = sum(len(shape.triangles) for shape in stage.shapes)

        def tracing(traced: Stage, wanted: Features) -> Tracing:
            kernel = renderer.kernel_for(wanted, asked_for=asked_for)
            read = replace(wanted, dispersion=kernel.features.dispersion)  # a general one has a chain for each channel
            inputs = partial(Inputs, renderer.device, traced, width, height, read, real, bound)
            return Tracing(kernel, renderer.pace_of(kernel, triangles), inputs)

        self._tracings = Tracings(stage, features, tracing)
        if (
            self._light is None or self._effort is not LightEffort.MOVING
        ):  # or else beside the first launch of its light
            _ = self._tracings.of(0).inputs  # what cannot be drawn is refused at once
        self._lit_by = 0
        """Version of the map that its samples saw, or MIXED."""
        self._in_final_light = self._light is None
        """Whether they all saw the one that is good enough."""
        self._light_errors: list[float] = []
        self._light_bounds: list[float] = []
        """Of the map, as each sample saw it: first those that were put aside."""
        self._tile = tile = tile_of(features)
        self._tiles = math.ceil(width / tile), math.ceil(height / tile)
        # Not by this picture's `_allocate`: with sums that hold their picture, both stay until garbage is collected.
        self._sums = Sums(renderer.fold, renderer.allocate, width, height, real)
        film = stage.scene.film
        hides = film.fireflies == "hide" and not film.cut_out
        self._fireflies = renderer.fireflies(width * height, film.exposure) if hides else None
        self._batches = self._fireflies is None and stage.scene.optics.end != "roulette"
        """Whether several samples may be drawn at once. Chance is drawn by tile and sample."""
        self._tallies = self._allocate(TALLIES * 4 * self._tiles[0] * self._tiles[1] * (16 if self._batches else 1))
        self._tallies_before = np.zeros((self._tiles[0] * self._tiles[1], TALLIES), np.float32)
        """Of the sample before the one that is under way."""
        self._seen = np.zeros(self._tiles[0] * self._tiles[1], bool)
        """Tiles of the sample under way that `overlaid` has shown."""
        self._shown, self._shown_samples = np.zeros((height, width, 3), np.uint8), (0, 0)
        """As developed last, and how many samples there were then, and put aside."""
        self._softened, self._softened_samples = self._shown, (0, 0)
        """The same, filtered."""

    @property
    def scene(self) -> Scene:
        """What it shows."""
        return self.stage.scene

    @property
    def samples(self) -> int:
        """Of each pixel, so far."""
        return self._sums.samples

    @property
    def samples_seen(self) -> int:
        """Of each pixel, in what is shown. While the light gets better, samples are shown that are made anew in the
        light that there is at last, one by one: until then as many are shown as there were."""
        under_way = self._sampling is not None  # in some pixels, and in none that there was nothing of
        return max(self.samples, self._sums.samples_aside, int(under_way))

    @property
    def under_way(self) -> bool:
        """Whether it was left amid a sample, which some pixels have and others have not."""
        return self._sampling is not None

    def give_up(self) -> None:
        """Nobody goes on with it: amid a sample it and what it is at would hold each other, and its memory, until
        Python collects circles."""
        self._sampling = self._lighting = None

    def prepare(self) -> None:
        """Have on the device what the next sample needs, which `refine` does by itself."""
        self._tracings.prepare(self.samples)

    def refine(self, samples: int = 1) -> None:
        """Add samples to every pixel; returns when they are there."""
        for _ in self.refine_in_pieces(samples, math.inf):
            pass

    def refine_in_pieces(self, samples: int, seconds: float) -> Iterator[float]:
        """The same in launches of about so many seconds each; yields the part that is done, between them.

        However long a pixel takes: a launch ends after a number of steps, and the next one goes on where it ended. The
        picture is the same to the last bit as one that is made at once.
        """
        self.seconds = self.light_seconds = 0.0
        self.launch_seconds = seconds
        before = self.samples
        while self.samples < before + samples:
            for _ in self._lit():
                yield max(0, self.samples - before) / samples
            done = self.samples - before
            for part in self._sampled(self._level_of(samples - max(0, done))):
                yield max(0.0, done + part * self._batch) / samples
        self._samples_spent = 0.0  # nobody could leave them: light owes them no time

    def refine_until(
        self,
        target: Target,
        seconds: float,
        *,
        pause: Callable[[], bool] = lambda: False,
        due: Callable[[float], bool] = lambda _: False,
    ) -> Iterator[float]:
        """Add samples until the target is reached, in launches of about so many seconds; yields the part that is done,
        as far as that can be told.

        After each sample `pause` is asked whether to leave it at that for now. `due` tells whether somebody is to see
        the picture within so many seconds: it is left when that is so, amid a sample too if that does not end SOON
        (`overlaid`), or after a sample if the next one would not be whole in time; and a picture at rest shows samples
        in the light that there is, as many as it needs, while that gets better. The picture that reaches the target is
        the same to the last bit however often it was left, as long as its first two samples were not made otherwise:
        which samples are drawn together depends on how many there are and are needed, not on what is due.
        """
        self.compare_as_shown()
        self.seconds = self.light_seconds = 0.0
        self.launch_seconds = seconds
        while not self.reached(target):
            wanted = self.samples < self._needed(target)  # else those there are wait for the rest of their light
            for _ in self._lit(due if wanted else lambda _: False):
                yield min(self.samples / self._needed(target), 1.0)
            before, begun = self.samples, self.seconds
            together = self._needed(target) - before if self._in_final_light else 1
            for part in self._sampled(self._level_of(together)):
                yield min((before + part * self._batch) / self._needed(target), 1.0)
                spent = self.seconds - begun
                tiles = self._fireflies is None and part < ALMOST  # what comes after them is short
                if tiles and self._left > SOON and spent > 0 and due(0):
                    return
            if pause() or due(max(0.0, self._left - SOON)):
                break
        if self.reached(target):
            self._forget_aside()

    def compare_as_shown(self) -> None:
        """From now on, tell the error of what is shown whenever samples have doubled."""
        pixels = self.width * self.height
        self._sums.compare_shown = partial(self._renderer.shown_difference.pieces, self.scene, pixels)

    def reached(self, target: Target) -> bool:
        """Whether there is nothing left to do for it: its error is met, or its samples are there."""
        return self._in_final_light and self.samples >= self._needed(target)

    def meets(self, target: Target) -> bool:
        """Whether it has the error that the target asks for, if it asks for one."""
        needed = 0 if target.error is None else self._sums.shown.samples_for(target.error)
        return needed is not None and self.samples >= needed

    def _needed(self, target: Target) -> int:
        """Samples, as far as is known."""
        expected = None if target.error is None else self._sums.shown.samples_for(target.error)
        return target.samples if expected is None else min(max(expected, target.least), target.samples)

    def _lit(self, due: Callable[[float], bool] = lambda _: False) -> Iterator[None]:
        """See to the light map before the next sample, or amid one; yields between launches. If the map becomes
        another, so do all samples.

        At rest it is left, and goes on later, when a sample is `due` and the light has had its share of the time.
        Fireflies cannot be told from two lights: a picture without them has one sample in each until the last.
        """
        light = self._light
        if light is None:
            return
        started, begun = time.perf_counter(), self.samples > 0 or self._sampling is not None
        shares, final = self._effort is LightEffort.RESTING, True
        if self._lighting is None:
            cutoff = self.scene.optics.caustics_cutoff
            meanwhile = partial(self._tracings.prepare, self.samples)  # which holds no picture that is given up
            self._lighting = iter(
                light.pieces(cutoff, self._effort, self.launch_seconds, first=not begun, meanwhile=meanwhile)
            )
            final = begun or not shares
        try:
            for _ in self._lighting:
                self._spent_on_light(time.perf_counter() - started)
                yield
                started = time.perf_counter()
                shared = self._light_spent >= LIGHT_FOR_SAMPLES * self._samples_spent
                other = self._fireflies is None or self._lit_by != light.version
                if shares and begun and shared and other and due(self._left):
                    final = False
                    break
            else:
                self._lighting = None
        except Exception:
            self._lighting = None  # it has ended before it was good enough
            raise
        self._spent_on_light(time.perf_counter() - started)
        if final:
            self._light_spent = self._samples_spent = 0.0
        if self._sampling is not None:  # which goes on in the light that there is now
            self._lit_by = self._lit_by if self._lit_by == light.version else MIXED
            self._in_final_light = final and self._lit_by != MIXED
            return
        anew = final or self._fireflies is not None
        if anew and self.samples > 0 and self._lit_by != light.version:
            yield from self._put_aside()
        self._lit_by = light.version if self.samples == 0 or self._lit_by == light.version else MIXED
        self._in_final_light = final
        self._light_errors.append(light.rmse)
        self._light_bounds.append(math.nan if light.figures is None else light.figures.bound)

    def _spent_on_light(self, seconds: float) -> None:
        self.light_seconds += seconds
        self._light_spent += seconds

    def _put_aside(self) -> Iterator[None]:
        """Make all samples anew, which are shown until they are there."""
        if self._effort is not LightEffort.RESTING or self._fireflies is not None:
            self.begin_anew()
            return
        yield from self._sums.put_aside()

    def begin_anew(self) -> None:
        """Forget all samples."""
        self._sums.restart()
        self._forget_aside()
        self._shown_samples = self._softened_samples = 0, 0

    def _forget_aside(self) -> None:
        self._sums.forget_aside()
        kept = self.samples
        self._light_errors = self._light_errors[len(self._light_errors) - kept :]
        self._light_bounds = self._light_bounds[len(self._light_bounds) - kept :]

    def _level_of(self, samples: int) -> int:
        """Of the batch that comes next, of at most so many samples. It does not depend on time: a batch adds a pixel's
        light in another order than samples by themselves, and the same scene is to have the same picture."""
        most = min(samples, self._sums.room, LARGEST_BATCH // (self.width * self.height)) if self._batches else 1
        return next((level for level in LEVELS if 4**level <= most), 0)

    @property
    def _batch(self) -> int:
        """Samples under way."""
        return 1 << 2 * self._level

    def _sampled(self, level: int) -> Iterator[float]:
        """The sample or batch under way, or the next one, of that level, as `_one_sample` makes it."""
        if self._sampling is None:
            self._level, self._sampling = level, self._one_sample()
        before = self.seconds
        try:
            for part in self._sampling:
                self._samples_spent += 0.0 if self._in_final_light else self.seconds - before
                before, self._part = self.seconds, part
                if part == 1:
                    self._sampling = None
                yield part
        except Exception:
            self._sampling = None  # it has ended
            raise
        if self._sums.samples_aside == 0:
            self._forget_aside()

    @property
    def _left(self) -> float:
        """s that the sample under way, or else the next one, is still expected to take."""
        if self._sampling is None:
            return self.sample_seconds
        if self._part > 0:
            return self._under_way_seconds * (1 - self._part) / self._part
        as_before = self._batch * self.sample_seconds - self._under_way_seconds
        return as_before if as_before > 0 else math.inf

    def _one_sample(self) -> Iterator[float]:
        """Yields the part of the tiles that are done, between launches, and at last 1."""
        device, batch = self._renderer.device, self._batch
        across, down = self._tiles_of_batch(self._level)
        count = across * down
        tracing = self._tracings.of(self.samples)
        kind = self.scene.sampling.filter
        places = np.array([jitter(self.samples + k, kind) for k in range(batch)])
        self._light_errors += self._light_errors[-1:] * (batch - 1)  # all see the light that `_lit` noted
        self._light_bounds += self._light_bounds[-1:] * (batch - 1)
        run, adds = self._sums.target()
        target, accumulate = (run, adds) if self._fireflies is None else (self._fireflies.sample, False)
        progress = np.zeros(progress_size(device.units), np.uint32)
        of_items = progress[OF_ITEMS:].reshape(device.units, 2)
        buffer, kept = self._allocate(progress.nbytes), self._allocate(device.units * tracing.kernel.kept_bytes)
        jitters = cl.Buffer(device.context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=places)
        start = time.perf_counter()
        self._under_way_seconds = self._part = 0.0
        if self._effort is LightEffort.RESTING:
            self._mark_tiles()
        self._tallied = self._level
        cl.enqueue_copy(device.queue, buffer, progress, is_blocking=False)
        while True:
            event = tracing.kernel.launch(
                device.queue,
                device.units,
                {
                    **tracing.inputs.of_sample(self.samples, self._level),
                    "image": target,
                    "accumulate": accumulate,
                    "tallies": self._tallies,
                    "jitter": jitters,
                    "level": self._level,
                    "steps": tracing.pace.steps(self.launch_seconds),
                    "count": count,
                    "progress": buffer,
                    "kept": kept,
                },
            )
            cl.enqueue_copy(
                device.queue, progress, buffer
            )  # which waits for it: once, as others may take the interpreter
            event.wait()  # which says what went wrong
            taken = time.perf_counter() - start
            self.seconds += taken
            self._under_way_seconds += taken
            under_way, steps = of_items.T
            tracing.pace.made(int(steps.max()), taken)
            done = min(int(progress[TILES_DEALT]), count) - int(under_way.sum())
            if done == count:
                break
            yield done / count
            start = time.perf_counter()
        self.sample_seconds = self._under_way_seconds / batch
        if self._fireflies is not None:
            self._fireflies.collect(run, add=adds, sample=self.samples)
        for _ in self._sums.added(batch):
            yield ALMOST
        yield 1.0

    @property
    def program(self) -> Any:  # noqa: ANN401 - pyopencl has no types
        """The built program that rendered this picture's last sample."""
        return self._tracings.of(max(0, self.samples - 1)).kernel.entry.program

    def linear(self, rows: slice = slice(None)) -> NDArray[np.floating[Any]]:
        """(height, width, 3) mean linear radiance, or those rows of it."""
        return self._sums.mean(rows)[..., :3]

    def cut_map(self) -> NDArray[np.floating[Any]]:
        """(height, width) mean weight that was dropped; times the largest radiance it bounds a pixel's error."""
        return self._sums.mean()[..., 3]

    def cut(self) -> float:
        """Mean of the whole picture's cut weight, of the last sample or batch."""
        return float(self._tally()[:, 1].sum(dtype=float)) / (self.width * self.height)

    def truncation_bound(self) -> float:
        """The most that dropped weight can be missing from the picture's mean radiance, averaged over the channels."""
        return self.cut() * largest_radiance(self.stage)

    def segments(self) -> int:
        """Interior segments of the last sample; of a batch the mean of its samples."""
        return int(self._tally()[:, 0].sum(dtype=float))

    def rgb(self) -> NDArray[np.uint8]:
        """(height, width, 3) tone-mapped, 8 bits. Needs no device if it is developed already."""
        for _ in self.develop_in_pieces():
            pass
        return self._shown

    def softened(self) -> NDArray[np.uint8]:
        """`rgb()`, filtered as a single sample of each pixel should be that is seen but for a moment."""
        for _ in self.develop_in_pieces(soft=True):
            pass
        return self._softened

    def develop_in_pieces(self, *, soft: bool = False) -> Iterator[None]:
        """Make `rgb()`, or with `soft` `softened()`, of the samples that there are, DEVELOPED pixels at a time; yields
        between them. What is filtered leaves the device once, when that is done."""
        there = self.samples, self._sums.samples_aside
        if there == (self._softened_samples if soft else self._shown_samples):
            return
        whole, later = self.width * self.height, self._sums.later > 0
        if not soft:
            shown = np.empty((self.height, self.width, 3), np.uint8)
            yield from self._fill(shown, 0, self.height, self.samples, later=later)
            self._shown, self._shown_samples = shown, there
            return
        developed = self._allocate(3 * whole)
        for _, end in self._developed_on_device(developed, 0, whole, self.samples, later=later):
            if end < whole:
                self._renderer.device.queue.finish()
                yield
        self._softened = self._renderer.softening.read(developed, self.width, self.height)
        self._softened_samples = there
        yield

    def overlaid(self, over: NDArray[np.uint8]) -> Iterator[NDArray[np.uint8]]:
        """Where tiles of the sample under way are done, the picture with that sample; elsewhere what was seen last
        (height, width, 3), of the same shape. So each pixel is at least as good as it was. Yields it between pieces of
        work; what comes last is whole."""
        shown = over.copy()
        done = ~np.isnan(self._read_tallies()[:, 0])
        new = (done & ~self._seen).reshape(self._tiles[::-1])
        developed = np.empty_like(shown)
        tile = self._tile
        masks: list[tuple[slice, NDArray[np.bool_]]] = []
        for number in np.flatnonzero(new.any(axis=1)):
            rows = slice(int(number) * tile, min((int(number) + 1) * tile, self.height))
            many = self.samples + self._batch
            for _ in self._fill(developed, rows.start, rows.stop, many, later=self.samples > 0):
                yield shown
            mask = np.repeat(new[number], tile)[: self.width]
            shown[rows][:, mask] = developed[rows][:, mask]
            masks.append((rows, mask))
        if self.samples == 0 and self._sums.samples_aside <= 1:
            softened = self._renderer.softening.softened(shown)
            for rows, mask in masks:
                shown[rows][:, mask] = softened[rows][:, mask]
        self._seen |= done
        yield shown

    def _fill(self, shown: NDArray[np.uint8], first: int, last: int, samples: int, *, later: bool) -> Iterator[None]:
        """Fill those rows of (height, width, 3), of so many samples of each pixel besides those that are put aside, of
        the earlier run and, with `later`, of the later one."""
        queue, flat, target = self._renderer.device.queue, shown.reshape(-1), self._allocate(shown.nbytes)
        pixels = first * self.width, last * self.width
        for begin, end in self._developed_on_device(target, *pixels, samples, later=later):
            cl.enqueue_copy(queue, flat[3 * begin : 3 * end], target, src_offset=3 * begin)
            yield

    def _developed_on_device(
        self,
        target: Any,  # noqa: ANN401 - pyopencl has no types
        first: int,
        last: int,
        samples: int,
        *,
        later: bool,
    ) -> Iterator[tuple[int, int]]:
        """As `_fill`, pixels in a buffer of the device, of which none is waited for; yields which are on their way."""
        sums, renderer = self._sums, self._renderer
        earlier, run = sums.buffers
        runs = (LATER if later else 0) | (ASIDE if sums.samples_aside else 0)
        if self._fireflies is not None:
            earlier, runs = self._fireflies.left_out(earlier, run, samples, both=later), 0
        aside = earlier if sums.aside is None else sums.aside
        many = samples + sums.samples_aside
        for begin in range(first, last, DEVELOPED):
            end = min(begin + DEVELOPED, last)
            items = math.ceil((end - begin) / DEVELOP_BLOCK / DEVELOP_GROUP) * DEVELOP_GROUP
            renderer.develop(
                renderer.device.queue, (items,), (DEVELOP_GROUP,), earlier, run, aside, np.int32(runs), target,
                np.int32(begin), np.int32(end), *film_arguments(self.scene, many),
            )  # fmt: skip
            yield begin, end

    def _mark_tiles(self) -> None:
        """A sample begins that may be shown before it is whole: none of its tiles is done."""
        if self.samples > 0 or self._sums.samples_aside > 0:
            self._tallies_before = self._tally()
        else:  # what their buffer holds is another picture's
            self._tallies_before[:] = 0
        self._seen[:] = False
        across, down = self._tiles_of_batch(self._level)
        unknown = np.full((across * down, TALLIES), np.nan, np.float32)
        cl.enqueue_copy(self._renderer.device.queue, self._tallies, unknown)

    def _tiles_of_batch(self, level: int) -> tuple[int, int]:
        """Columns and rows of tiles, which have all samples of a batch and as many fewer pixels."""
        return math.ceil((self.width << level) / self._tile), math.ceil((self.height << level) / self._tile)

    def _read_tallies(self) -> NDArray[np.float32]:
        """By tile of a single sample: segments, and the weight that was cut, of a sample; NaN of those that the sample,
        or batch, under way does not have yet."""
        across, down = self._tiles_of_batch(self._tallied)
        tallies = np.empty((down, across, TALLIES), np.float32)
        cl.enqueue_copy(self._renderer.device.queue, tallies, self._tallies)
        parts = 1 << self._tallied
        whole = np.zeros((self._tiles[1] * parts, self._tiles[0] * parts, TALLIES), np.float32)
        whole[:down, :across] = tallies
        by_tile = whole.reshape(self._tiles[1], parts, self._tiles[0], parts, TALLIES).sum(axis=(1, 3), dtype=float)
        return np.asarray(by_tile / parts**2, np.float32).reshape(-1, TALLIES)

    def _tally(self) -> NDArray[np.float32]:
        """By tile: segments, and the weight that was cut; of the last sample."""
        if self.samples_seen == 0:
            return np.zeros_like(self._tallies_before)
        tallies = self._read_tallies()
        missing = np.isnan(tallies)
        if self.samples == 0 and missing.any() and not missing.all():  # as of those that are done
            return np.where(missing, np.nanmean(tallies, axis=0), tallies)
        return np.where(missing, self._tallies_before, tallies)

    def error_estimate(self) -> float:
        """Root mean square error of `linear()` that its samples and its light map let expect, in radiance; NaN below
        two samples."""
        light, own = self.light_error(), self._sums.radiance_error()
        return own if math.isnan(light) else math.hypot(own, light)

    def shown_error(self) -> float:
        """Root mean square error of what is shown, over pixels and colours from 0 (black) to 1 (white), that its
        samples let expect: what more of them would take away. NaN below two samples, and without `refine_until`."""
        return self._sums.shown_error()

    def light_error(self) -> float:
        """The light map's part of that, as on a white surface; NaN without a map, or before its passes tell."""
        known = [error for error in self._light_errors if not math.isnan(error)]
        return float(np.mean(known)) if known else math.nan

    def light_bound(self) -> float:
        """Of the light that meets stones the part that floor and walls may miss at most, since it was cut, not
        followed, or lands beyond the map; NaN without a map."""
        return float(np.mean(self._light_bounds)) if self._light_bounds else math.nan

    def shows_shadows_only(self) -> bool:
        """Whether its map shows what stones take of the light, and not what goes through them."""
        return self._light is not None and self._light.maker is Maker.NOTHING

    def _allocate(self, size: int) -> Any:  # noqa: ANN401 - pyopencl has no types
        return self._renderer.allocate(size)

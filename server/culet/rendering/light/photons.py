"""Light maps by photons: for stones that are not convex, or have more facets than beams are good for.

Photons go through the kernels' own stones, so that they know nothing that a picture does not. A pass is a number of
them, spread over what each stone shows to each emitter; where they land they are spread over a paraboloid whose radius
falls with their density, and from pass to pass (C. Knaus and M. Zwicker, Progressive Photon Mapping: A Probabilistic
Approach, ACM TOG 30, 25, 2011), so that the mean of passes has no error in the end.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.emitters.light_map import LEVELS, SIZE, Figures, MapFrame, surfaces
from culet.rendering.emitters.ray import LightRay
from culet.rendering.features import END, Features, features_of
from culet.rendering.kernel_inputs.footprint import REACH
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.kernel_inputs.stone_table import grouped
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.device import Device
from culet.rendering.opencl.layout import buffers, constants, struct
from culet.rendering.opencl.making import alone
from culet.rendering.programs.build import Variant, build, recipe
from culet.rendering.stones.placed_stone import PlacedStone, origin_of, placed_stones
from culet.scene.model import Scene
from culet.stage import Stage

Array = NDArray[np.float64]

_KERNEL = constants("photons.cl")
CELLS, COUNTS, LANDING_NUMBERS = (_KERNEL[name] for name in ("CELLS", "COUNTS", "LANDING_NUMBERS"))
BATCH = constants("tile.cl")["TILE_OF_ONE"] ** 2, constants("tile.cl")["TILE_OF_MANY"] ** 2
"""Photons that a work-item shoots at a time: of one stone, and of several."""
CUTOFF = 0.05
"""Weight below which a photon lives on by chance: it is then as likely to bring this much as it was to bring less."""
LANDINGS = 8
"""Of a photon, for which there is room: what a stone reflects, what it takes away, and what leaves it again and again.
A brilliant makes 3.5 of them."""
JOBS = 64
"""Of a launch, at most: what a launch lets land stays some tens of megabytes."""
IN_FOOTPRINT = 20.0
"""Landings within a footprint of the first pass. Of shadows, which lie evenly, fewer would do; but so a stone of index
1 takes away just what it lets through."""
SHRINKING = 2 / 3
"""Alpha of Knaus and Zwicker: the square of the radius falls with passes as k^(alpha - 1)."""
RADII = (1.0, 24.0)
"""Texels: at less than 0.71 a footprint could fall between texels; more would cost more than photons do."""
FIRST_JOB = 0.02
"""s. A job that nobody has timed yet."""


@dataclass(frozen=True)
class Shooting:
    """What a pass of photons has done."""

    photons: int
    landings: int
    segments: int
    landed: float
    """Flux on the map, what is taken away included: with `outside`, `elsewhere`, `cut` and what is absorbed it is 0."""
    elsewhere: float
    """Flux that left the room, or met a mirror, or went into a surface that a stone reaches through; less what would
    have gone there without the stones."""
    outside: float
    overflown: float


class Photons:
    """The programs of a device, by what stages need."""

    def __init__(self, device: Device, *, lanes: int | None = None) -> None:
        self._device = device
        self._variant = Variant(lanes or device.lanes_for(np.float32))
        self._programs: dict[Features, Any] = {}

    def maps(self, stage: Stage, frame: MapFrame) -> PhotonMaps:
        """Passes over a stage."""
        return PhotonMaps(self, self._device, self._variant, stage, frame)

    def program(self, features: Features) -> Any:  # noqa: ANN401 - pyopencl has no types
        """Built for these features; waits for the compiler if need be."""
        if features not in self._programs:
            options = [*self._variant.options, *features.options]
            with alone(kernel_cache.folder(), recipe(self._device, "photons.cl", options)):
                self._programs[features] = build(self._device, "photons.cl", options)
        return self._programs[features]

    def is_ready(self, stage: Stage) -> bool:
        """Whether `maps` would not wait for a compiler."""
        return needed(stage) in self._programs

    def prepare(self, stage: Stage) -> None:
        """Make it so, in any thread."""
        self.program(needed(stage))


def needed(stage: Stage) -> Features:
    """The program of photons for a stage."""
    features = features_of(stage)
    return Features(
        geometry=features.geometry,
        stones=features.stones,
        lights=0,
        lamps=0,
        boxes=0,
        head=0,
        backdrop=0,
        glare=1,
        dispersion=features.dispersion,
        absorption=features.absorption,
        fresnel=features.fresnel,
        end=END["roulette"],
        spectral=features.spectral,
        polarised=features.polarised,
        few_mirrors=features.few_mirrors,
        camera_inside=0,
    )


@dataclass(eq=False)
class PhotonMaps:
    """Of one stage. Mutable: it knows how long its photons take."""

    _of: Photons
    _device: Device
    _variant: Variant
    stage: Stage
    frame: MapFrame
    figures: Figures | None = None
    """Of the last pass."""
    shooting: Shooting | None = None
    """Of the last pass."""
    _job_seconds: float = FIRST_JOB
    _batch: int = field(init=False)
    _inputs: Inputs = field(init=False)

    def __post_init__(self) -> None:
        scene = self.stage.scene
        optics = scene.optics.model_copy(update={"cutoff": CUTOFF, "end": "roulette"})
        stage = self.stage.showing(scene.model_copy(update={"optics": optics}))
        self._features = needed(self.stage)
        self._program = self._of.program(self._features)
        self._shoot, self._count, self._spread, self._join = (
            cl.Kernel(self._program, name) for name in ("shoot", "count", "spread", "join")
        )
        self._inputs = Inputs(self._device, stage, 16, 16, self._features, np.float32)
        self._batch = BATCH[self._features.stones - 1]
        self._inputs.of_sample(0)
        self._steps = self._inputs.chain_steps

    def pieces(
        self,
        target: Any,  # noqa: ANN401 - pyopencl has no types
        rays: Sequence[LightRay],
        *,
        number: int,
        photons: int,
        seconds: float = math.inf,
        follow: bool = True,
    ) -> Iterator[float]:
        """Fill the target with pass `number`: at least so many photons of each channel, of these rays, whose colours
        sum to the lights'. Launches of about so many seconds each; yields the part that is done between them. Without
        `follow` only what stones take away is shown: what goes through them counts as unresolved."""
        started = time.perf_counter()
        device, frame = self._device, self.frame
        cl.enqueue_fill_buffer(device.queue, target, np.zeros(1, np.float32), 0, frame.nbytes)
        stones = grouped(placed_stones(self.stage))
        bundles = [bundle for ray in rays for bundle in bundles_of(ray, self.stage.scene, stones, frame)]
        given = self._inputs.of_sample(number)
        counts = np.zeros((device.units, COUNTS))
        total = np.zeros(COUNTS)
        shot = 0
        if bundles:
            steps = self._steps
            rounds = max(1, math.ceil(photons / (len(bundles) * self._batch)))
            table = bundle_table(bundles, rounds * self._batch, number, frame, origin_of(self.stage.scene, stones))
            jobs = len(bundles) * rounds * steps
            capacity = LANDINGS * self._batch * math.ceil(JOBS / device.units)
            buffers_ = _Buffers.of(device, frame, table, origin_of(self.stage.scene, stones), capacity)
            first = 0
            while first < jobs:
                begun = time.perf_counter()
                many = JOBS if math.isinf(seconds) else int(seconds / self._job_seconds) * device.units
                last = min(jobs, first + min(max(many, device.units), JOBS))
                self._launch(given, buffers_, len(bundles), first, last, counts, follow=follow)
                whole = (last - first) / (len(bundles) * steps)  # rounds of all bundles; or some bundles in one round
                self._land(buffers_, target, number, max(1.0, whole) / rounds)
                total += counts.sum(axis=0)
                taken = time.perf_counter() - begun
                self._job_seconds += 0.5 * (taken * device.units / (last - first) - self._job_seconds)
                shot += (last - first) * self._batch
                first = last
                if first < jobs:
                    yield first / jobs
        self.shooting = Shooting(
            photons=shot, landings=int(total[_KERNEL["LANDINGS"]]), segments=int(total[_KERNEL["SEGMENTS_MADE"]]),
            landed=total[_KERNEL["LANDED"]], elsewhere=total[_KERNEL["ELSEWHERE"]],
            outside=total[_KERNEL["OUTSIDE"]], overflown=total[_KERNEL["OVERFLOWN"]],
        )  # fmt: skip
        self.figures = Figures(
            incident=float(total[_KERNEL["INCIDENT"]]),
            cut=float(total[_KERNEL["CUT_FLUX"]]),
            unresolved=float(total[_KERNEL["OVERFLOWN"]] + (0 if follow else total[_KERNEL["INCIDENT"]])),
            outside=float(abs(total[_KERNEL["OUTSIDE"]])),
            rmse=math.nan,
            seconds=time.perf_counter() - started,
        )
        yield 1.0

    @property
    def photon_seconds(self) -> float:
        """s that a photon of each channel takes, as far as that is known."""
        return self._job_seconds * self._steps / (self._batch * self._device.units)

    def join(self, target: Any, made: Any, keep: float, gain: float) -> None:  # noqa: ANN401
        """Make the target `keep` times what it was, plus `gain` times a pass."""
        device = self._device
        self._join(
            device.queue, (device.units,), (1,), target, made, np.int32(self.frame.nbytes // 4), np.float32(keep),
            np.float32(gain),
        )  # fmt: skip
        device.queue.finish()

    def _launch(
        self,
        given: dict[str, Any],
        to: _Buffers,
        bundles: int,
        first: int,
        last: int,
        counts: Array,
        *,
        follow: bool,
    ) -> None:
        device = self._device
        self._shoot(
            device.queue, (device.units,), (1,), *(given[name] for name in buffers()), to.frame, to.bundles,
            np.int32(bundles), np.int32(first), np.int32(last), np.int32(follow), to.landings, np.int32(to.capacity),
            to.counts,
        )  # fmt: skip
        cl.enqueue_copy(device.queue, counts, to.counts)

    def _land(self, to: _Buffers, target: Any, number: int, part: float) -> None:  # noqa: ANN401
        """Spread what has landed in a launch that is such a part of a pass."""
        device, frame = self._device, self.frame
        shape = 2, frame.held, LEVELS, CELLS, CELLS
        cells = np.zeros(shape, np.int32)
        cl.enqueue_copy(device.queue, to.cells, cells)
        self._count(
            device.queue, (2,), (1,), to.frame, to.landings, np.int32(to.capacity), to.counts, np.int32(device.units),
            to.cells,
        )  # fmt: skip
        cl.enqueue_copy(device.queue, cells, to.cells)
        channels = 1 if self._features.dispersion == 0 or self._features.spectral else 3
        radii = footprints(cells / (part * channels), number)
        cl.enqueue_copy(device.queue, to.radii, np.ascontiguousarray(radii, np.float32))
        self._spread(
            device.queue, (device.units,), (1,), to.frame, to.landings, np.int32(to.capacity), to.counts,
            np.int32(device.units), to.radii, target,
        )  # fmt: skip
        device.queue.finish()


def footprints(cells: Array, number: int) -> Array:
    """Radii in texels, from the landings of a whole pass by kind, surface, level and cell (2, S, L, C, C)."""
    size = cells.shape[-1]
    padded = np.pad(cells, [(0, 0)] * 3 + [(1, 1)] * 2, mode="edge")
    near = sum(padded[..., i : i + size, j : j + size] for i in range(3) for j in range(3)) / 9
    texels = (SIZE / size) ** 2
    wanted = IN_FOOTPRINT * (number + 1) ** (SHRINKING - 1)
    return np.asarray(np.clip(np.sqrt(wanted * texels / (math.pi * np.maximum(near, 1e-3))), *RADII))


@dataclass(frozen=True, eq=False)
class _Buffers:
    frame: Any
    bundles: Any
    landings: Any
    counts: Any
    cells: Any
    radii: Any
    capacity: int

    @classmethod
    def of(cls, device: Device, frame: MapFrame, table: NDArray[np.void], origin: Array, capacity: int) -> _Buffers:
        flags, cells = cl.mem_flags, 4 * 2 * frame.held * LEVELS * CELLS * CELLS

        def uploaded(array: NDArray[Any]) -> Any:  # noqa: ANN401
            return cl.Buffer(device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=array)

        def held(size: int) -> Any:  # noqa: ANN401
            return cl.Buffer(device.context, flags.READ_WRITE, size)

        return cls(
            uploaded(frame_struct(frame, origin)), uploaded(table),
            held(4 * LANDING_NUMBERS * capacity * device.units), held(8 * COUNTS * device.units), held(cells),
            held(cells), capacity,
        )  # fmt: skip


def frame_struct(frame: MapFrame, origin: Array) -> NDArray[np.void]:
    """`map_frame_t`, in the kernels' frame about that origin."""
    row = np.zeros((), struct("map_frame_t", np.float32))
    for number, surface in enumerate(surfaces()):
        row["along"][number], row["across"][number] = surface.along, surface.across
        row["centre"][number] = np.array(frame.centres[number]) - surface.coordinates(origin)
    row["half_size"], row["held"] = frame.halves, frame.held
    return row


@dataclass(frozen=True, eq=False)
class Bundle:
    """Light of one ray at one stone."""

    ray: LightRay
    stone: int
    """Its place in the kernels' table."""
    centre: Array
    radius: float
    axis: Array
    """The way of the light to the stone's middle."""
    distance: float
    """R from a point light to there; 0: from infinity."""
    flux: Array
    """(3,) through the circle, R^2 times irradiance over pi."""
    spread: float
    growth: float


def bundles_of(ray: LightRay, scene: Scene, stones: Sequence[PlacedStone], frame: MapFrame) -> Iterator[Bundle]:
    """What of a ray's light may meet stones. A point light has the irradiance of its colour at the stones' middle."""
    colour = np.array(ray.colour)
    for number, stone in enumerate(stones):
        radius = REACH * stone.scale
        if ray.position is None:
            assert ray.towards is not None  # noqa: S101 - a ray has one or the other
            axis = -np.array(ray.towards)
            yield Bundle(ray, number, stone.centre, radius, axis, 0.0, colour * (math.pi * radius**2), 0.0, 0.0)
            continue
        way = stone.centre - np.array(ray.position)
        distance = float(np.linalg.norm(way))
        squared = float(np.sum((np.array(frame.middle) - ray.position) ** 2))
        if distance <= 0 or squared <= 0:
            continue
        sine = radius / distance
        spread = 1 + math.sqrt(1 - 1e-12) if sine >= 1 else sine**2 / (1 + math.sqrt(1 - sine**2))
        yield Bundle(
            ray, number, stone.centre, radius, way / distance, distance,
            colour * (squared * 2 * math.pi * spread), spread, 1 / squared,
        )  # fmt: skip


def bundle_table(
    bundles: Sequence[Bundle], photons: int, number: int, frame: MapFrame, origin: Array
) -> NDArray[np.void]:
    """`bundle_t`s for so many photons of each bundle and channel, of pass `number`."""
    rows = np.zeros(len(bundles), struct("bundle_t", np.float32))
    for place, (row, bundle) in enumerate(zip(rows, bundles, strict=True)):
        other = np.eye(3)[np.abs(bundle.axis).argmin()]
        first = np.cross(bundle.axis, other)
        first /= np.linalg.norm(first)
        row["axis"], row["across"] = bundle.axis, (first, np.cross(bundle.axis, first))
        row["distance"], row["spread"], row["radius"] = bundle.distance, bundle.spread, bundle.radius
        row["centre"] = bundle.centre - origin
        row["flux"] = bundle.flux / photons
        row["growth"], row["stone"] = bundle.growth, bundle.stone
        turn = 1 + number * 0.6180339887498949 + place * 0.7548776662466927
        row["shift"] = turn % 1, (turn * 0.5698402909980532 + number * 0.3819660112501051) % 1
    return rows

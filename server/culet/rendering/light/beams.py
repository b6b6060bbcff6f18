"""Light maps by exact beams: each way of light through a convex stone is a polygon of even light where it lands."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.chains import GROUPS, chain_table, chains_of_stones, is_coloured, is_spectral
from culet.rendering.emitters.light_map import ABOUT, LEVELS, SIZE, SURFACES, Figures, MapFrame, surfaces
from culet.rendering.emitters.ray import LightRay
from culet.rendering.features import FRESNEL
from culet.rendering.light.solids import Solids, takes_beams
from culet.rendering.opencl.device import Device, Real
from culet.rendering.opencl.layout import constants, struct
from culet.rendering.opencl.zeros import zeros
from culet.rendering.programs.build import build
from culet.rendering.stones.placed_stone import PlacedStone, placed_stones
from culet.scene.model import Scene
from culet.stage import Stage

STRIDE = constants("raster.cl")["MAP_STRIDE"]
PIECE = 0.06
"""Diameter of the parts in which light from a point enters a stone, in distances from the point, at most. Of the light
of a point 8 R away 0.3 % falls between facets then."""
FIRST_JOBS = 64
"""Of a launch, while nobody knows how long they take."""
AS_BEFORE = 0.5
"""Of a launch's time, for which a pass begins with jobs that take as long as those of the pass before."""
ALMOST = 1 - 2**-20
"""The part that is done when the light is thrown, but not summed."""


NO_WAIT = 1e-4
"""s. A launch that is waited for no longer may have ended before."""


@dataclass(frozen=True)
class BeamTally:
    """What was counted, as `tally_t` has it: fluxes in R^2 times irradiance over pi, mean of the channels."""

    incident: float
    landed: float
    """On maps."""
    outside: float
    """On surfaces that have a map, beyond it."""
    away: float
    """Past the room's surfaces, or on one that has no map."""
    behind: float
    """Out of stones beyond a surface of the room that they reach through."""
    absorbed: float
    cut: float
    unresolved: float
    doubt: float
    beams: float


class Beams:
    """Makes light maps of convex stones on one device; one thread at a time. Its buffers are kept for the next maps."""

    def __init__(
        self, device: Device, real: Real = np.float32, *, items: int | None = None, like: Beams | None = None
    ) -> None:
        """`items`: work-items at a time, a core each. `like`: another one of the same device and precision, whose
        programs this one uses, too."""
        self.device, self.real = device, real
        self.items = items or device.units
        self.tally: BeamTally | None = None
        """Of the last pass."""
        self._programs: dict[tuple[int, ...], Any] = {} if like is None else like._programs
        self._paces: dict[_Kind, float] = {} if like is None else like._paces
        """s that a job took."""
        self._scratch: dict[tuple[int, int], tuple[Any, ...]] = {}
        self.clean = True
        """Whether what is kept is all 0, as a pass that is done leaves it."""

    def make(
        self,
        stage: Stage,
        rays: Sequence[LightRay],
        frame: MapFrame,
        target: Any,  # noqa: ANN401 - pyopencl has no types
        *,
        cutoff: float,
        number: int = 0,
        keep: float = 0.0,
        gain: float = 1.0,
        piece: float = PIECE,
    ) -> Figures:
        """See `pieces`; the target is a buffer."""
        found = self.pieces(
            stage, rays, frame, lambda: target, cutoff=cutoff, seconds=math.inf, number=number, keep=keep, gain=gain,
            piece=piece,
        )  # fmt: skip
        try:
            while True:
                next(found)
        except StopIteration as end:
            figures: Figures = end.value
            return figures

    def pieces(
        self,
        stage: Stage,
        rays: Sequence[LightRay],
        frame: MapFrame,
        target: Callable[[], Any],
        *,
        cutoff: float,
        seconds: float,
        number: int = 0,
        keep: float = 0.0,
        gain: float = 1.0,
        piece: float = PIECE,
        meanwhile: Callable[[], None] | None = None,
    ) -> Generator[float, None, Figures]:
        """Throw the light of these rays: the target, of `frame.nbytes`, becomes `keep` times what it was, plus `gain`
        times what shadows and caustics add to each texel's radiance of a white surface. In launches of about so many
        seconds; yields the part that is done, and returns the figures. The target is asked for when all light is
        thrown: until then it needs no memory.

        `cutoff`: flux of a beam that ends, in R^2 of the brightest emitter's irradiance. `number` of the pass chooses
        the wavelengths of a spectral scene. Stones that take no beams are left out: see `takes_beams`. `meanwhile` is
        called while the first launch is under way, if launches are to be short.
        """
        began, queue = time.perf_counter(), self.device.queue
        stones = [stone for stone in placed_stones(stage) if takes_beams(stone.shape)]
        points = [ray for ray in rays if ray.position is not None]
        parallel = [ray for ray in rays if ray.position is None]
        scratch = self._buffers(frame.held, len(points))
        chains, bands, first_chains = _chains(stage.scene, stones, number, self.real)
        origin = np.array(frame.middle)
        room = _room(stage.scene, frame, origin, self.real)
        room["cutoff"], room["piece"] = cutoff, piece
        room["stones"], room["bands"], room["points"] = len(stones), bands, len(points)
        gauged = sorted({ray.emitter for ray in parallel if ray.gauges})
        room["gauges"] = len(gauged)
        seeping = self._upload(np.zeros((self.items, max(1, len(gauged)), 2, 4), np.float32))
        solids = Solids.of(stones, first_chains, origin, room["surface"][room["present"] != 0].astype(float), self.real)
        room["sunk"] = solids.sunk
        room["entries"] = int(solids.solids["last_entry"].max(initial=0))
        arrays = [self._upload(array) for array in (
            solids.planes, solids.vertices, solids.start, solids.corners, solids.across, solids.entries, chains,
        )]  # fmt: skip
        solid_buffer = self._upload(solids.solids)
        tally_type = struct("tally_t", self.real, "light_beam.cl")
        tallies = np.zeros(self.items, tally_type)
        tally_buffer = self._upload(tallies)
        brightest = _brightness(rays)
        point_lights = self._upload(_lights(points, brightest, gauged, stones, frame, self.real))
        self.clean = False
        beside = iter([] if meanwhile is None else [meanwhile])
        for diverging, group in enumerate((parallel, points)):
            if not group or not stones:
                continue
            room["lights"] = len(group)
            light_buffer = (
                point_lights if diverging else self._upload(_lights(group, brightest, gauged, stones, frame, self.real))
            )
            program = self._program(diverging, solids.most_facets, len(stones) > 1, stage.scene.optics.polarised)
            buffers = (
                self._upload(room), light_buffer, solid_buffer, *arrays, *scratch, seeping, tally_buffer,
            )  # fmt: skip
            # Of several stones a job follows all bands of a light.
            entries = int(room["entries"]) * len(group) * (bands if len(stones) == 1 else 1)
            size = len(stones).bit_length(), solids.planes.size.bit_length()
            throw = partial(self._launches, program, buffers, cutoff, seconds, size, beside)
            if gauged and not diverging:
                band = 1 + bands // 2 if not is_spectral(stage.scene) and not is_coloured(stage.scene) else 0
                for _ in throw("gauge_light", entries, band):
                    yield 0.0
            for _ in throw("cast_shadows", len(group) * len(stones)):
                yield 0.0
            if any(ray.follows for ray in group):
                yield from throw("throw_light", entries)
        self._sum(self._upload(room), point_lights, scratch, target(), keep, gain)
        cl.enqueue_copy(queue, tallies, tally_buffer)
        self.clean = True
        self.tally = BeamTally(**{name: float(tallies[name].sum()) for name in tally_type.names or ()})
        return self._figures(self.tally, frame, cutoff, time.perf_counter() - began)

    def _figures(self, tally: BeamTally, frame: MapFrame, cutoff: float, seconds: float) -> Figures:
        area = max(1, len(frame.matte)) * (2 * frame.halves[0]) ** 2
        return Figures(
            incident=tally.incident,
            cut=tally.cut,
            unresolved=max(tally.unresolved, 0.0),
            outside=tally.outside,
            rmse=max(math.sqrt(tally.doubt / area) * _of_doubt(cutoff), tally.cut / area),
            seconds=seconds,
        )

    def _program(self, diverging: int, most_facets: int, several: bool, polarised: bool) -> Any:  # noqa: ANN401
        key = diverging, most_facets, int(several), int(polarised)
        if key not in self._programs:
            choices = {
                "DIVERGING": diverging,
                "MOST_FACETS": most_facets,
                "SEVERAL": int(several),
                "POLARISED": int(polarised),
            }
            options = [*self._options, *(f"-D{name}={value}" for name, value in choices.items())]
            program = build(self.device, "beams.cl", options)
            self._programs[key] = _Kernels(
                *(cl.Kernel(program, name) for name in ("gauge_light", "cast_shadows", "throw_light"))
            )
        return self._programs[key]

    @property
    def _options(self) -> list[str]:
        return [f"-DREAL={'double' if self.real is np.float64 else 'float'}"]

    def _launches(
        self,
        program: _Kernels,
        buffers: Sequence[Any],
        cutoff: float,
        seconds: float,
        size: tuple[int, int],
        beside: Iterator[Callable[[], None]],
        name: str,
        jobs: int,
        *more: int,
    ) -> Iterator[float]:
        """All jobs of a kernel, in launches of about so many seconds; yields the part that is done, between them.
        `size`: of the scene, within a factor of two. What is `beside` them is called during the first one."""
        kernel, kind = getattr(program, name), _Kind(name, id(program), math.frexp(cutoff)[1], size)
        done, chunk = 0, jobs
        if math.isfinite(seconds):
            known = self._paces.get(kind)
            chunk = FIRST_JOBS if known is None else max(1, int(AS_BEFORE * seconds / known))
        while done < jobs:
            end, start = min(done + chunk, jobs), time.perf_counter()
            self._launch(kernel, buffers, done, end, *more)
            if math.isfinite(seconds):
                for call in beside:
                    call()
                waiting = time.perf_counter()
                self.device.queue.finish()
                ended = time.perf_counter()
                pace = max(ended - start, 1e-6) / (end - done)
                if ended - waiting < NO_WAIT:  # the launch may have taken less than what was called
                    pace = min(pace, self._paces.get(kind, pace))
                self._paces[kind] = pace
                chunk = max(1, min(2 * chunk, int(seconds / pace)))
                yield ALMOST * end / jobs
            done = end

    def _launch(self, kernel: Any, buffers: Sequence[Any], begin: int, end: int, *more: int) -> None:  # noqa: ANN401
        kernel(self.device.queue, (self.items,), (1,), *buffers, *map(np.int32, (begin, end, *more)))

    def _sum(self, room: Any, points: Any, scratch: tuple[Any, ...], target: Any, keep: float, gain: float) -> None:  # noqa: ANN401
        if (-1,) not in self._programs:
            self._programs[-1,] = cl.Kernel(build(self.device, "light_sum.cl", self._options), "sum_map")
        self._programs[-1,](
            self.device.queue, (self.items,), (1,), room, points, *scratch, np.int32(self.items), target,
            np.float32(keep), np.float32(gain),
        )  # fmt: skip

    def _buffers(self, held: int, points: int) -> tuple[Any, ...]:
        """Where light and the shadows of points accumulate, of all work-items, and which texels do; empty."""
        key = held, points
        if key not in self._scratch or not self.clean:
            self._scratch.clear()
            rows = self.items * held * LEVELS * SIZE
            sizes = 16 * rows * STRIDE, 4 * rows * STRIDE * points, 4 * rows, 4 * rows * points
            self._scratch[key] = tuple(zeros(self.device, max(size, 16)) for size in sizes)
            self.clean = True
        return self._scratch[key]

    def _upload(self, array: NDArray[Any]) -> Any:  # noqa: ANN401
        flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self.device.context, flags, hostbuf=np.ascontiguousarray(array))


class _Kind(NamedTuple):
    """Of jobs that take about as long as each other."""

    kernel: str
    program: int
    cutoff: int
    """Its power of two."""
    size: tuple[int, int]
    """Of the stones' number and of their facets', the powers of two: a beam is cut by all stones."""


@dataclass(frozen=True)
class _Kernels:
    gauge_light: Any
    cast_shadows: Any
    throw_light: Any


def _room(scene: Scene, frame: MapFrame, origin: NDArray[np.float64], real: Real) -> NDArray[np.void]:
    """`throwing_t` but for what is thrown, relative to the origin."""
    room = np.zeros((), struct("throwing_t", real, "light_beam.cl"))
    room["half_size"] = frame.halves
    room["maps"] = frame.held
    room["fresnel_kind"] = FRESNEL[scene.optics.fresnel]
    present = [scene.floor.kind != "none", *[scene.walls.kind != "none"] * (SURFACES - 1)]
    for number, surface in enumerate(surfaces()):
        normal = np.array(surface.normal)
        room["surface"][number, :3], room["surface"][number, 3] = normal, surface.offset - normal @ origin
        room["across"][number], room["up"][number] = surface.along, surface.across
        room["centre"][number] = np.array(frame.centres[number]) - surface.coordinates(origin)
        room["present"][number], room["mapped"][number] = present[number], number in frame.matte
    return room


def _brightness(rays: Sequence[LightRay]) -> dict[int, float]:
    """Of each emitter that is followed, over that of the brightest."""
    sums: dict[int, float] = {}
    for ray in rays:
        if ray.follows:
            sums[ray.emitter] = sums.get(ray.emitter, 0.0) + ray.brightness
    brightest = max(sums.values(), default=0.0)
    return {emitter: value / brightest if brightest > 0 else 1.0 for emitter, value in sums.items()}


LEAST_SQUARED = 1e-6
"""R^2 from the middle of the stones to a point, at least."""
FAINTEST = 1e-9
"""Of an emitter's light over that of the brightest: what is fainter is cut as if it were so bright."""


def _lights(
    rays: Sequence[LightRay],
    brightness: dict[int, float],
    gauged: Sequence[int],
    stones: Sequence[PlacedStone],
    frame: MapFrame,
    real: Real,
) -> NDArray[np.void]:
    """(N,) `light_t`; one of nothing if there is none."""
    rows = np.zeros(max(1, len(rays)), struct("light_t", real, "light_beam.cl"))
    rows["inside"] = -1
    origin, extent = np.array(frame.middle), frame.halves[0] - ABOUT
    for number, (row, ray) in enumerate(zip(rows, rays, strict=False)):
        place = np.array(ray.towards if ray.position is None else ray.position, dtype=float)
        row["place"] = place if ray.position is None else place - origin
        row["squared"] = 1
        if ray.position is not None:
            # A point among the stones counts, for cut-offs and figures, as if it were at their rim.
            row["squared"] = max(float(((place - origin) ** 2).sum()), extent**2, LEAST_SQUARED)
            depths = [stone.depth(place) for stone in stones]
            row["inside"] = int(np.argmax(depths)) if max(depths, default=0) > 0 else -1
        row["colour"][:3] = ray.colour
        row["dimness"] = 1 / max(brightness.get(ray.emitter, 1.0), FAINTEST)
        row["follows"] = ray.follows and any(ray.colour)
        row["shade"] = number
        row["gauge"] = gauged.index(ray.emitter) if ray.emitter in gauged and not ray.follows else -1
        row["gauges"] = ray.gauges
    return rows


def _chains(
    scene: Scene, stones: Sequence[PlacedStone], number: int, real: Real
) -> tuple[NDArray[np.void], int, list[int]]:
    """Indices of refraction with what they light, how many each stone has, and where each stone's begin. Absorption is
    per R."""
    if not stones:
        return np.zeros(1, struct("chain_t", real)), 1, []
    sets, kinds = chains_of_stones(scene)
    table = chain_table(scene, number, np.float64, common=False)
    each = len(table) // len(kinds)
    rows = table.reshape(len(kinds), each)
    if is_spectral(scene):
        rows = rows[:, number % GROUPS :: GROUPS]
    elif not is_coloured(scene) and (rows["eta"] == rows["eta"][:, :1]).all():
        rows = rows[:, :1]
        rows["share"] = 1
    bands = rows.shape[1]
    flat = np.zeros(len(kinds) * bands, struct("chain_t", real))
    for name in ("eta", "absorption", "share"):
        flat[name] = rows[name].reshape(flat[name].shape)
    scales = np.repeat([stone.scale for stone in kinds], bands)
    flat["absorption"] /= scales
    return flat, bands, [sets[stone.number] * bands for stone in stones]


def _of_doubt(cutoff: float) -> float:
    """The error of a map over the root mean square of what beams from one to three times the cut-off gave it."""
    return float(np.clip(1.16 * (cutoff / 1e-3) ** 0.156, 0.6, 1.5))

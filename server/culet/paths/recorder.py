"""Follows the light of one pixel by the renderer's own chains, and keeps what each of them met."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.errors import CuletError, SceneError
from culet.paths.program import PathKernel, is_uncached, make_path, precompile_path
from culet.rendering.chains import GROUPS, first_sample, is_spectral, wavelengths_of
from culet.rendering.features import ESTIMATOR, Features, features_of
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.lighting import Lighting
from culet.rendering.opencl.device import Device, Real
from culet.rendering.opencl.layout import buffers, constants, struct
from culet.rendering.programs.build import Variant
from culet.rendering.projection import Projection
from culet.rendering.renderer import jitter
from culet.rendering.stones.placed_stone import PlacedStone
from culet.stage import Stage

EVENTS = 4096
"""That are kept of a pixel, at most. A brilliant's light has some 140, of sampled wavelengths up to 1000."""
STEPS = 2**17
"""Of a launch: some tens of milliseconds."""
LAUNCHES = 64
"""At most, after which a pixel's light is given up: some seconds."""
LIGHT_SECONDS = 0.05
"""s of a launch that makes a light map."""
KINDS = constants("record.cl")


class GivenUpError(CuletError):
    """Nobody waits for the record any more."""

    title = "given up"


@dataclass(frozen=True, eq=False)
class PixelRecord:
    """What the kernel wrote down of a pixel, with what it takes to read it."""

    stage: Stage
    """As it was seen."""
    events: NDArray[np.void]
    """(N,) `happening_t` of record.cl, in the order in which they happened; no event comes before its parent."""
    value: NDArray[np.float64]
    """(3,) the pixel's radiance in one sample, linear."""
    cut: float
    """Weight that was dropped, mean of the channels."""
    left_out: int
    """Events for which there was no room."""
    stones: tuple[PlacedStone, ...]
    """By their numbers in the events."""
    parameters: NDArray[np.void]
    """What the kernel knew of the scene, `parameters_t`."""
    projection: Projection
    wavelengths: tuple[float, ...] | None
    """nm, of each chain; None: of the three channels."""
    chains: NDArray[np.void]
    """(S N,) `chain_t`: N rows for each set of stones."""
    polarised: bool
    """Whether chains carry the polarisation of light."""
    pixel: tuple[int, int, int, int]
    """Its column and row, of a picture of that width and height."""


class PathRecorder:
    """Of one device. One thread at a time may ask."""

    def __init__(
        self, device: Device, real: Real = np.float32, *, apart: bool = False, light_seconds: float = math.inf
    ) -> None:
        """Programs are built when they are first needed, with `apart` by processes of their own where the driver's
        cache does not have them, so that no other launch of this one waits for a compiler. A scene's light map may take
        `light_seconds`."""
        self._device, self._real, self._apart, self._light_seconds = device, real, apart, light_seconds
        self._pool = cl.tools.MemoryPool(cl.tools.ImmediateAllocator(device.queue))
        self._lighting = Lighting(device, self._pool.allocate)
        self._programs: dict[Features, PathKernel] = {}

    def record(
        self,
        stage: Stage,
        width: int,
        height: int,
        column: int,
        row: int,
        *,
        wavelengths: Sequence[float] = (),
        effort: LightEffort = LightEffort.PATIENT,
        waited_for: Callable[[], bool] = lambda: True,
    ) -> PixelRecord:
        """The first sample of a pixel of a picture of that size, or of `wavelengths` (nm) in place of the scene's own.

        SceneError for the classic estimator, which follows no chains, for light that has no end, and for a light map
        that takes too long; GivenUpError once it is not `waited_for`, which is asked before each launch.
        """
        needed = features_of(stage)
        if needed.estimator != ESTIMATOR["chain"]:
            raise SceneError(
                f"optics.estimator: expected chain, whose light is followed event by event, got "
                f"{stage.scene.optics.estimator}",
                "optics.estimator",
            )
        stage = first_sample(stage)
        spectral = bool(wavelengths) or is_spectral(stage.scene)
        features = replace(needed.general, spectral=int(spectral), few_mirrors=needed.few_mirrors)
        try:
            return self._record(stage, features, (width, height), (column, row), wavelengths, effort, waited_for)
        finally:
            self._lighting.forget()
            self._pool.free_held()

    def _record(
        self,
        stage: Stage,
        features: Features,
        size: tuple[int, int],
        pixel: tuple[int, int],
        wavelengths: Sequence[float],
        effort: LightEffort,
        waited_for: Callable[[], bool],
    ) -> PixelRecord:
        light = self._lighting.of(stage) if features_of(stage).light_map != 0 else None
        if light is not None:
            until = time.monotonic() + self._light_seconds
            for _ in light.pieces(stage.scene.optics.caustics_cutoff, effort, LIGHT_SECONDS, first=True):
                _check(waited_for)
                if time.monotonic() > until:
                    raise SceneError(
                        f"expected light on floor and walls that is found within {self._light_seconds:g} s, got more: "
                        "a higher optics.caustics_cutoff makes it end sooner",
                        "optics.caustics_cutoff",
                    )
        bound = None if light is None else light.bound
        inputs = Inputs(self._device, stage, *size, features, self._real, bound, wavelengths)
        given = inputs.of_sample(0)
        first = np.array(jitter(0, stage.scene.sampling.filter))
        kernel, kept_bytes = self._program(features)
        queue, flags = self._device.queue, cl.mem_flags
        head = np.zeros((), struct("record_t", self._real, "record.cl"))
        head["most"] = EVENTS
        happening = struct("happening_t", self._real, "record.cl")
        record = cl.Buffer(self._device.context, flags.READ_WRITE | flags.COPY_HOST_PTR, hostbuf=head)
        place = cl.Buffer(self._device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=first)
        events, kept = self._allocate(EVENTS * happening.itemsize), self._allocate(kept_bytes)
        for launch in range(LAUNCHES):
            _check(waited_for)
            kernel(
                queue, (1,), (1,), *(given[name] for name in buffers()), record, events, *map(np.int32, pixel),
                place, kept, np.int32(launch == 0), np.int32(STEPS),
            )  # fmt: skip
            cl.enqueue_copy(queue, head, record)
            if head["done"]:
                break
        else:
            raise SceneError(
                f"expected light that comes to its end within {LAUNCHES * STEPS} steps, got more: a higher "
                f"optics.cutoff or fewer max_bounces make it end",
                "optics.cutoff",
            )
        count = int(head["count"])
        found = np.zeros(min(count, EVENTS), happening)
        if len(found):
            cl.enqueue_copy(queue, found, events)
        return PixelRecord(
            stage=stage,
            events=found,
            value=head["radiance"].astype(float),
            cut=float(head["cut"]) / 3,
            left_out=max(0, count - EVENTS),
            stones=inputs.shown,
            parameters=inputs.parameters,
            projection=inputs.projection,
            wavelengths=_wavelengths(stage, features, wavelengths),
            chains=inputs.chains,
            polarised=bool(features.polarised),
            pixel=(*pixel, *size),
        )

    def _allocate(self, size: int) -> Any:  # noqa: ANN401 - pyopencl has no types
        return self._pool.allocate(size)

    def _program(self, features: Features) -> PathKernel:
        """Built once."""
        found = self._programs.get(features)
        if found is None:
            variant = Variant(lanes=1, real=self._real)
            if self._apart and is_uncached(self._device, features, variant):
                precompile_path(features, variant)
            found = self._programs[features] = make_path(self._device, features, variant)
        return found


def _check(waited_for: Callable[[], bool]) -> None:
    if not waited_for():
        raise GivenUpError("nobody waits for this light any more")


def _wavelengths(stage: Stage, features: Features, given: Sequence[float]) -> tuple[float, ...] | None:
    """Of each chain's row."""
    if not features.spectral:
        return None
    if given:
        return tuple(float(wavelength) for wavelength in given for _ in range(GROUPS))
    return tuple(wavelengths_of(stage.scene, 0).tolist())

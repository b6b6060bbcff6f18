"""Pictures of scenes, refined sample by sample."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.geometry.polygons import edges_of_facets
from culet.geometry.stone import Stone
from culet.rendering.device import Device, Real, open_device
from culet.rendering.features import Features, Geometry, features_of
from culet.rendering.parameters import parameters, shown_surfaces
from culet.rendering.program import Programs, Variant, build
from culet.rendering.projection import placement, world_planes
from culet.rendering.shadows import shadow_planes
from culet.rendering.tree import tree_of
from culet.scene.model import Scene

SOURCES = {"chain": "render.cl", "classic": "classic.cl"}
"""Of each estimator; both have a kernel `render` with the same arguments."""
TALLIES = 2
"""Numbers for each tile, as in tile.cl."""
TONE_MAPS = {"none": 0, "srgb": 1, "classic": 2}


class Renderer:
    """Makes pictures on one device. One thread at a time may refine them."""

    def __init__(
        self,
        device: Device | None = None,
        *,
        real: Real = np.float32,
        lanes: int | None = None,
        tile: int = 32,
        background_compile: bool = False,
    ) -> None:
        """Open the device (DeviceError if none works). With `background_compile` a picture never waits for a special
        program: the general one serves until it is ready."""
        self.device = device or open_device()
        self.variant = Variant(lanes=lanes or self.device.lanes_for(real), real=real, tile=tile)
        self.programs = Programs(self.device)
        self.background_compile = background_compile
        self.pool = cl.tools.MemoryPool(cl.tools.ImmediateAllocator(self.device.queue))
        self.develop = cl.Kernel(build(self.device, "film.cl", self.variant.options), "develop")

    def picture(
        self, scene: Scene, stone: Stone | None, width: int, height: int, *, features: Features | None = None
    ) -> Picture:
        """An empty picture of the scene, to be refined. `features` asks for another program than the scene needs."""
        return Picture(self, scene, stone, width, height, features)

    def describe(self) -> dict[str, str | int]:
        """Device, driver and lanes, for reports."""
        return {
            "device": self.device.name,
            "driver": self.device.driver,
            "units": self.device.units,
            "lanes": self.variant.lanes,
            "precision": "double" if self.variant.real is np.float64 else "single",
        }


def jitter(sample: int) -> tuple[float, float]:
    """Where in its pixel a sample lies, from the corner: the centre first, then the R2 sequence (M. Roberts, The
    unreasonable effectiveness of quasirandom sequences, 2018)."""
    return (0.5 + sample * 0.7548776662466927) % 1, (0.5 + sample * 0.5698402909980532) % 1


class Picture:
    """A scene seen at a size: sums of linear radiance on the device, one more sample of each pixel at a time."""

    def __init__(
        self, renderer: Renderer, scene: Scene, stone: Stone | None, width: int, height: int, features: Features | None
    ) -> None:
        self.scene, self.width, self.height = scene, width, height
        self.samples = 0
        self.seconds = 0.0
        """Spent by the last refinement."""
        self._renderer = renderer
        real = renderer.variant.real
        stone = stone if scene.stones else None
        features = features or features_of(scene, stone)
        get = renderer.programs.best if renderer.background_compile else renderer.programs.exact
        self._kernel = get(features, replace(renderer.variant, source=SOURCES[scene.optics.estimator]))

        shadow_start, shadows = np.zeros(1, np.int32), np.zeros((1, 4))
        facets = np.zeros((1, 4))
        struct = parameters(scene, stone, width, height, shadow_start, real)
        if stone is not None and features.geometry == Geometry.HULL:
            facets = world_planes(scene, stone)
            if features.lights != 0:
                shadow_start, shadows = _shadow_volumes(scene, stone, facets)
                struct["shadow_start"][: len(shadow_start)] = shadow_start
        self._tiles = math.ceil(width / renderer.variant.tile), math.ceil(height / renderer.variant.tile)
        self._image = self._allocate(width * height * 4 * np.dtype(real).itemsize)
        self._tallies = self._allocate(TALLIES * 4 * self._tiles[0] * self._tiles[1])
        self._inputs = [self._upload(struct), self._upload(facets.astype(real)), self._upload(shadows.astype(real))]
        self._mesh = [None, None, None]
        if stone is not None and features.geometry == Geometry.MESH:
            tree = tree_of(stone)
            self._mesh = [
                self._upload(array) for array in (tree.boxes.astype(real), tree.links, tree.corners.astype(real))
            ]

    def refine(self, samples: int = 1) -> None:
        """Add samples to every pixel; returns when they are there."""
        for _ in self.refine_in_bands(samples, self.height):
            pass

    def refine_in_bands(self, samples: int, rows: int) -> Iterator[float]:
        """The same in bands of about `rows` rows; yields the part that is done, between them."""
        tile = self._renderer.variant.tile
        tiles = max(1, math.ceil(rows / tile))
        bands = math.ceil(self._tiles[1] / tiles)
        queue = self._renderer.device.queue
        self.seconds = 0.0
        for sample in range(samples):
            x, y = jitter(self.samples)
            for band in range(bands):
                start = time.perf_counter()
                count = min(tiles, self._tiles[1] - band * tiles)
                event = self._kernel(
                    queue, (self._tiles[0], count), (1, 1), self._image, *self._inputs, *self._mesh,
                    np.float64(x), np.float64(y), np.int32(band * tiles), np.int32(self.samples > 0),
                    self._tallies,
                )  # fmt: skip
                event.wait()
                self.seconds += time.perf_counter() - start
                if band == bands - 1:
                    self.samples += 1
                yield (sample + (band + 1) / bands) / samples

    @property
    def program(self) -> Any:  # noqa: ANN401 - pyopencl has no types
        """The built program that renders this picture."""
        return self._kernel.program

    def linear(self) -> NDArray[np.floating[Any]]:
        """(height, width, 3) mean linear radiance."""
        return self._mean()[..., :3]

    def cut_map(self) -> NDArray[np.floating[Any]]:
        """(height, width) mean weight that was dropped; times the largest radiance it bounds a pixel's error."""
        return self._mean()[..., 3]

    def cut(self) -> float:
        """Mean of the whole picture's cut weight, of the last sample."""
        return float(self._tally()[:, 1].sum(dtype=float)) / (self.width * self.height)

    def segments(self) -> int:
        """Interior segments of the last sample."""
        return int(self._tally()[:, 0].sum(dtype=float))

    def rgb(self) -> NDArray[np.uint8]:
        """(height, width, 3) tone-mapped, 8 bits."""
        shown = np.empty((self.height, self.width, 3), np.uint8)
        target = self._allocate(shown.nbytes)
        film, pixels = self.scene.film, self.width * self.height
        self._renderer.develop(
            self._renderer.device.queue, (math.ceil(pixels / 16),), None, self._image, target, np.int32(pixels),
            np.float32(film.exposure / max(1, self.samples)), np.int32(TONE_MAPS[film.tone_map]),
        )  # fmt: skip
        cl.enqueue_copy(self._renderer.device.queue, shown, target)
        return shown

    def _tally(self) -> NDArray[np.float32]:
        """By tile: segments, and the weight that was cut; of the last sample."""
        tallies = np.empty((self._tiles[0] * self._tiles[1], TALLIES), np.float32)
        cl.enqueue_copy(self._renderer.device.queue, tallies, self._tallies)
        return tallies

    def _mean(self) -> NDArray[np.floating[Any]]:
        sums = np.empty((self.height, self.width, 4), self._renderer.variant.real)
        cl.enqueue_copy(self._renderer.device.queue, sums, self._image)
        return sums / max(1, self.samples)

    def _allocate(self, size: int) -> Any:  # noqa: ANN401 - pyopencl has no types
        return self._renderer.pool.allocate(size)

    def _upload(self, array: NDArray[Any]) -> Any:  # noqa: ANN401
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self._renderer.device.context, flags, hostbuf=np.ascontiguousarray(array))


def _shadow_volumes(
    scene: Scene, stone: Stone, facets: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Where each light's planes begin, and all of them."""
    centre, rotation = placement(scene)
    surfaces, vertices, edges = shown_surfaces(scene, centre), stone.vertices @ rotation.T, edges_of_facets(stone)
    volumes = [
        shadow_planes(facets, vertices, edges, np.array(light.position) - centre, surfaces) for light in scene.lights
    ]
    starts = np.cumsum([0, *map(len, volumes)]).astype(np.int32)
    return starts, np.vstack([*volumes, np.zeros((1, 4))])

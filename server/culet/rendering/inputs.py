"""What the kernels read of a scene, on the device."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape
from culet.rendering.chains import chain_table, is_spectral
from culet.rendering.device import Device, Real
from culet.rendering.features import Features, Geometry, shape_on
from culet.rendering.parameters import parameters, shown_surfaces
from culet.rendering.projection import placement, world_planes
from culet.rendering.shadows import shadow_planes
from culet.rendering.tree import tree_of
from culet.scene.model import Scene
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage


class Inputs:
    """Buffers of one scene, by the kernels' names; of them only `scene` and `chains` differ by sample."""

    def __init__(
        self,
        device: Device,
        stage: Stage,
        width: int,
        height: int,
        features: Features,
        real: Real,
    ) -> None:
        scene, shape = stage.scene, shape_on(stage)
        self._device, self._scene, self._real = device, scene, real
        self._common = features.dispersion == 0
        self._changes = shape is not None and (is_spectral(scene) or scene.optics.end == "roulette")
        self._sample = -1
        shadow_start, shadows, facets = np.zeros(1, np.int32), np.zeros((1, 4)), np.zeros((1, 4))
        self._struct = parameters(scene, shape, width, height, real)
        mesh: dict[str, Any] = dict.fromkeys(("boxes", "links", "corners"))
        if shape is not None and features.geometry == Geometry.HULL:
            facets = world_planes(scene, shape)
            if features.lights != 0:
                shadow_start, shadows = _shadow_volumes(scene, shape, facets)
                self._struct["shadow_start"][: len(shadow_start)] = shadow_start
        elif shape is not None:
            tree = tree_of(shape)
            rows = {"boxes": tree.boxes.astype(real), "links": tree.links, "corners": tree.corners.astype(real)}
            mesh = {name: self._upload(array) for name, array in rows.items()}
        self._has_stone = shape is not None
        self._panorama = None
        panorama = stage.panorama
        if isinstance(scene.environment, ImageEnvironment) and panorama is not None:
            self._struct["panorama_height"], self._struct["panorama_width"] = panorama.shape[:2]
            self._struct["panorama_turn"] = scene.environment.turn_degrees / 360
            self._struct["panorama_scale"] = scene.environment.scale
            self._panorama = device.panorama(panorama)
        self._fixed = {
            "facets": self._upload(facets.astype(real)),
            "shadows": self._upload(shadows.astype(real)),
            **mesh,
        }

    def of_sample(self, sample: int) -> dict[str, Any]:
        """The kernels' arguments for that sample."""
        if self._sample < 0 or (self._changes and sample != self._sample):
            chains = self._chains(sample)
            self._struct["sample"], self._struct["chains"] = sample, len(chains)
            self._uploaded = self._upload(self._struct), self._upload(chains)
            self._sample = sample
        struct, chains = self._uploaded
        return {"scene": struct, **self._fixed, "chains": chains, "panorama": self._panorama}

    def _chains(self, sample: int) -> NDArray[np.void]:
        scene = self._scene if self._has_stone else Scene()
        return chain_table(scene, sample, self._real, common=self._common)

    def _upload(self, array: NDArray[Any]) -> Any:  # noqa: ANN401 - pyopencl has no types
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self._device.context, flags, hostbuf=np.ascontiguousarray(array))


def _shadow_volumes(
    scene: Scene, shape: Shape, facets: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Where each light's planes begin, and all of them."""
    centre, rotation = placement(scene)
    surfaces, vertices, edges = shown_surfaces(scene, centre), shape.vertices @ rotation.T, edges_of_facets(shape)
    volumes = [
        shadow_planes(facets, vertices, edges, np.array(light.position) - centre, surfaces) for light in scene.points
    ]
    starts = np.cumsum([0, *map(len, volumes)]).astype(np.int32)
    return starts, np.vstack([*volumes, np.zeros((1, 4))])

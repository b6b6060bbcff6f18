"""What the kernels read of a scene, on the device."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.chains import GROUPS, chain_table, chains_of_stones, is_spectral
from culet.rendering.emitters.light_map import BoundMap
from culet.rendering.features import Features
from culet.rendering.kernel_inputs.footprint import out_of_sight
from culet.rendering.kernel_inputs.lit_room import set_light_map
from culet.rendering.kernel_inputs.parameters import parameters
from culet.rendering.kernel_inputs.stone_columns import stone_columns
from culet.rendering.kernel_inputs.stone_table import StoneTable, grouped
from culet.rendering.opencl.device import Device, Real
from culet.rendering.opencl.layout import struct
from culet.rendering.projection import project
from culet.rendering.stones.placed_stone import placed_stones
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
        light_map: BoundMap | None = None,
        wavelengths: Sequence[float] = (),
    ) -> None:
        """`wavelengths`, nm, in place of the scene's own; then the program must be a spectral one."""
        scene, stones = stage.scene, placed_stones(stage)
        projection = project(scene, stones, width, height)
        # Stones that are left out still decide where the frame's origin is, so that all else keeps its bits.
        shown = [] if out_of_sight(scene, stones, projection, features, width, height) else grouped(stones)
        self._device, self._scene, self._real = device, scene, real
        self._common = features.dispersion == 0
        self._wavelengths = tuple(wavelengths)
        self.projection = projection
        """Of the picture's rays, and the frame's origin."""
        self.shown = tuple(shown)
        """The stones, by their rows in the table."""
        self._changes = bool(stones) and (is_spectral(scene) or scene.optics.end == "roulette")
        self._made: tuple[int, int] | None = None
        """The sample, and level, that was asked for last."""
        self.chains = np.zeros(0, struct("chain_t", real))
        """The table of the sample that was asked for last; of a batch each four neighbouring wavelengths of all of its
        samples, one sample after the other."""
        self._struct = parameters(stage, shown, projection, width, height, real)
        self._light_map = light_map
        if light_map is not None:
            set_light_map(self._struct, light_map.frame, stage, projection.origin)
        self._table = StoneTable.of(scene, shown, projection, width, height, features, real)
        self._struct["stones"], self._struct["groups"] = len(shown), len(self._table.groups) if shown else 0
        tree = self._table.tree
        rows: dict[str, NDArray[Any]] = {}
        if tree is not None:
            rows = {"boxes": tree.boxes, "links": tree.links, "corners": tree.corners}
        self._panorama = None
        panorama = stage.panorama
        if isinstance(scene.environment, ImageEnvironment) and panorama is not None:
            self._struct["panorama_height"], self._struct["panorama_width"] = panorama.shape[:2]
            self._struct["panorama_turn"] = scene.environment.turn_degrees / 360
            self._struct["panorama_scale"] = scene.environment.scale
            self._panorama = device.panorama(panorama)
        self._fixed = {
            **dict.fromkeys(("boxes", "links", "corners")),
            **{name: self._upload(array if name == "links" else array.astype(real)) for name, array in rows.items()},
            "groups": self._upload(self._table.groups),
            "facets": self._upload(self._table.facets.astype(real)),
            "blocks": self._upload(self._table.blocks.astype(real)),
            "rows": self._upload(self._table.rows.astype(real)),
            "shadows": self._upload(self._table.shadows.astype(real)),
        }

    def prepare(self, sample: int, level: int = 0) -> None:
        """Have on the device what `of_sample` tells, but for the light map, which may not be there yet."""
        if self._made is None or (self._changes and self._made != (sample, level)):
            scene = self._scene if self._scene.stones else Scene()
            many = 4**level if is_spectral(scene) else 1  # else samples do not differ
            tables = [
                chain_table(scene, sample + k, self._real, common=self._common, wavelengths=self._wavelengths)
                for k in range(many)
            ]
            count = len(tables[0]) // max(1, len(chains_of_stones(self._scene)[1]))  # of a stone
            chains = tables[0] if many == 1 else np.stack([table.reshape(-1, GROUPS) for table in tables], 1).ravel()
            self._struct["sample"], self._struct["chains"] = sample, count
            stones = self._table.stones.copy()
            stones["first_chain"] *= many * count
            self.chains = chains
            columns = stone_columns(stones, chains, many * count).astype(self._real)
            self._uploaded = tuple(self._upload(array) for array in (self._struct, stones, columns, chains))
            self._made = sample, level

    def of_sample(self, sample: int, level: int = 0) -> dict[str, Any]:
        """The kernels' arguments for that sample; or for a batch of 4^level, of which it is the first."""
        self.prepare(sample, level)
        struct, table, columns, chains = self._uploaded
        return {
            "scene": struct, "stones": table, "columns": columns, **self._fixed, "chains": chains,
            "panorama": self._panorama,
            "light_map": self._light_map.buffer if self._light_map else None,
        }  # fmt: skip

    @property
    def parameters(self) -> NDArray[np.void]:
        """What `scene` holds: of the sample that was asked for last."""
        return self._struct.copy()

    @property
    def chain_steps(self) -> int:
        """How often chains are followed for each ray: one for each index, or four neighbouring wavelengths at a time.
        Known once `of_sample` was asked."""
        groups = GROUPS if is_spectral(self._scene) else 1
        return -(-int(self._struct["chains"]) // groups)

    def _upload(self, array: NDArray[Any]) -> Any:  # noqa: ANN401 - pyopencl has no types
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self._device.context, flags, hostbuf=np.ascontiguousarray(array))

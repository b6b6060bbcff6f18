"""A scene's quantities as the kernels read them: `parameters_t` of parameters.cl."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.rendering.features import END, FRESNEL, SKY, SURFACE
from culet.rendering.kernel_inputs.lit_room import set_room_light
from culet.rendering.opencl.device import Real
from culet.rendering.opencl.layout import struct
from culet.rendering.projection import Projection
from culet.rendering.room.sky_colours import sky_colours
from culet.rendering.room.studio import least_shade, set_studio
from culet.rendering.room.surfaces import room_surfaces, shown_surfaces
from culet.rendering.stones.placed_stone import PlacedStone, by_shape, camera_stone, centres_of
from culet.scene.model import Scene
from culet.stage import Stage


def parameters(
    stage: Stage, stones: Sequence[PlacedStone], projection: Projection, width: int, height: int, real: Real
) -> NDArray[np.void]:
    """One struct; every position is relative to the stones' middle, subtracted in double precision.

    What depends on other buffers (the table of stones, chains, panorama) is left zero.
    """
    p, scene = np.zeros((), struct("parameters_t", real)), stage.scene
    origin = projection.origin
    p["foot"], p["foot_column"], p["foot_row"] = projection.foot
    p["direction"], p["direction_column"], p["direction_row"] = projection.direction
    p["reach"] = projection.reach
    p["cutoff"] = scene.optics.cutoff
    p["origin"] = origin
    p["sky_bottom"], p["sky_top"] = sky_colours(scene.environment)
    set_studio(p, scene, origin, width, height)
    p["surface"] = room_surfaces(origin)
    set_room_light(p, stage)
    for number, light in enumerate(scene.points):
        p["light"][number] = np.array(light.position) - origin
        p["light_colour"][number] = light.colour
    p["lights"] = len(scene.points)
    p["max_bounces"] = scene.optics.max_bounces
    p["width"], p["height"] = width, height
    p["floor_kind"], p["walls_kind"] = SURFACE[scene.floor.kind], SURFACE[scene.walls.kind]
    p["sky_kind"] = SKY[scene.environment.kind]
    p["fresnel_kind"] = FRESNEL[scene.optics.fresnel]
    p["end_kind"] = END[scene.optics.end]
    p["glare"] = scene.optics.glare
    p["least_shade"] = least_shade(len(stones))
    host = camera_stone(scene, stones)
    p["camera_inside"], p["camera_stone"] = host is not None, host or 0
    p["pierces"] = _pierce(scene, stones)
    return p


def _pierce(scene: Scene, stones: Sequence[PlacedStone]) -> bool:
    """Whether a stone reaches through one of the surfaces that are shown."""
    surfaces = shown_surfaces(scene, np.zeros(3))
    gaps = centres_of(stones) @ surfaces[:, :3].T - surfaces[:, 3]
    near = gaps < np.array([stone.scale for stone in stones]).reshape(-1, 1)
    if not near.any():
        return False
    for shape, numbers in by_shape([stones[number] for number in np.flatnonzero(near.any(axis=1)).tolist()]).items():
        members = [stones[number] for number in numbers]
        rotations = np.array([stone.rotation for stone in members])
        lowest = (shape.vertices @ (surfaces[:, :3] @ rotations).reshape(-1, 3).T).min(axis=0)
        depths = np.array([stone.scale for stone in members])[:, None] * lowest.reshape(len(members), -1)
        if (centres_of(members) @ surfaces[:, :3].T + depths < surfaces[:, 3]).any():
            return True
    return False

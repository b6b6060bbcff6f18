"""The light of floor and walls as the kernels read it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.rendering.emitters.light_map import MapFrame, surfaces
from culet.rendering.emitters.sources import studio_light
from culet.rendering.emitters.unshaded import sky_light
from culet.scene.room import MIRROR_ALBEDOS, MIRROR_SHARE, Plane, StudioFloor
from culet.stage import Stage


def set_room_light(p: NDArray[np.void], stage: Stage) -> None:
    """What the sky sends to each surface, and how much of it each shows."""
    scene = stage.scene
    if scene.optics.estimator != "classic" and (isinstance(scene.floor, Plane) or scene.walls.kind != "none"):
        p["sky_light"] = sky_light(stage)
    for number, surface in enumerate((scene.floor, scene.walls)):
        p["cells"][number] = 1
        if not isinstance(surface, Plane):
            continue
        if surface.kind == "mirror":
            p["albedo"][number] = MIRROR_SHARE * np.array(MIRROR_ALBEDOS)[:, None]
        else:
            p["albedo"][number] = surface.albedos
            if surface.checker != "off":
                p["cells"][number] = 1 / surface.checker.cell


def set_light_map(p: NDArray[np.void], frame: MapFrame, stage: Stage, origin: NDArray[np.float64]) -> None:
    """Where a light map lies; the kernels' frame has its origin there."""
    p["has_map"] = True
    for number, surface in enumerate(surfaces()):
        p["map_centre"][number] = np.array(frame.centres[number]) - surface.coordinates(origin)
    p["map_scale"] = 1 / np.array(frame.halves)
    p["floor_mapped"], p["mapped_surface"] = 0 in frame.matte, frame.matte[0]
    p["even_light"] = 1
    if isinstance(stage.scene.floor, StudioFloor) and 0 in frame.matte:
        p["even_light"], p["map_gain"] = studio_light(stage, np.array(frame.middle))

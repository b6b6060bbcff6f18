"""The largest radiance that a stage holds outside the stones: what a unit of dropped weight can be worth at most."""

from __future__ import annotations

import numpy as np

from culet.rendering.parameters import sky_colours
from culet.scene.emitters import boxes, discs
from culet.scene.room import StudioFloor
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage

MATTE_ALBEDO = 0.9
"""Of the checker's brighter cells, as in room.cl."""
AMBIENT = 0.2
"""Of the light that falls on a surface, as in room.cl."""


def largest_radiance(stage: Stage) -> float:
    """Of any channel, in any direction, from any place. A mirror shows a fifth of a surface's light and four fifths of
    something else, so it is no brighter than the brightest of both."""
    scene, environment = stage.scene, stage.scene.environment
    if isinstance(environment, ImageEnvironment) and stage.panorama is not None:
        brightest = float(stage.panorama.max()) * environment.scale
    else:
        brightest = float(np.max(sky_colours(environment)))
    radiances = [
        *(disc.radiance for disc in discs(scene.shown_lamps)),
        *(box.radiance for box in boxes(scene.shown_lamps)),
    ]
    brightest += float(np.sum(radiances, axis=0).max(initial=0))
    if scene.head is not None:
        brightest = max(brightest, *scene.head.radiance)
    if isinstance(scene.floor, StudioFloor):
        brightest = max(brightest, *scene.floor.colour)
    if scene.floor.kind in ("matte", "mirror") or scene.walls.kind != "none":
        light = AMBIENT + np.sum([light.colour for light in scene.points], axis=0).max(initial=0)
        brightest = max(brightest, MATTE_ALBEDO * float(light))
    return brightest

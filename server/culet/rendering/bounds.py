"""The largest radiance that a stage holds outside the stones: what a unit of dropped weight can be worth at most."""

from __future__ import annotations

import numpy as np

from culet.rendering.emitters.unshaded import sky_light
from culet.rendering.room.sky_colours import sky_colours
from culet.scene.emitters import boxes, discs
from culet.scene.room import Plane, StudioFloor
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage

CLASSIC_AMBIENT = 0.2
"""Of the light that falls on a surface, as in room.cl."""


def largest_radiance(stage: Stage, thrown: float = 0) -> float:
    """Of any channel, in any direction, from any place. A mirror shows a fifth of a surface's light and four fifths of
    something else, so it is no brighter than the brightest of both. `thrown` is the most that a light map holds."""
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
    points = np.sum([light.colour for light in scene.points], axis=0).max(initial=0) + thrown
    classic = scene.optics.estimator == "classic"
    surfaces = [surface for surface in (scene.floor, scene.walls) if isinstance(surface, Plane)]
    if all(surface.kind == "none" for surface in surfaces):
        return brightest  # without the time that the sky's light on surfaces takes
    for surface, light in zip((scene.floor, scene.walls), _sky_light(stage), strict=True):
        if isinstance(surface, Plane) and surface.kind != "none":
            albedo = 1.0 if surface.kind == "mirror" else float(np.max(surface.albedos))
            brightest = max(brightest, albedo * float((CLASSIC_AMBIENT if classic else light) + points))
    return brightest


def _sky_light(stage: Stage) -> tuple[float, float]:
    """The most of any channel on the floor, and on a wall."""
    light = sky_light(stage)
    return float(light[0].max()), float(light[1:].max())

"""The light of the sky on floor and walls as if there were no stones: a number for each, since surfaces are flat and
the sky is infinitely far.

All light here is told as the radiance of a white matte surface: irradiance over pi.

Walls hide a part of the sky; what they show in its place lights the room too. That is counted as between surfaces of
one radiosity each, a mirror's light as if it were matte: with what point lights add to it left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.rendering.emitters.lamp_field import Lamp, lamp_field
from culet.rendering.emitters.of_room import of_room
from culet.rendering.emitters.open_sky import OpenSky, ground_light, open_sky
from culet.rendering.emitters.panorama_light import panorama_on_surfaces
from culet.rendering.room.surfaces import shown
from culet.scene.emitters import BoxLamp, RoundLamp, Sun
from culet.scene.model import Scene
from culet.scene.room import MIRROR_ALBEDOS, MIRROR_REFLECTANCE, MIRROR_SHARE, Floor, Plane, StudioFloor
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage

Array = NDArray[np.float64]


def lamps_of(scene: Scene) -> tuple[tuple[int, Lamp], ...]:
    """The lamps that the sky shows, a sun as a disc, each with its number among the scene's emitters."""
    shown_lamps = set(map(id, scene.shown_lamps))
    return tuple(
        (number, emitter.disc if isinstance(emitter, Sun) else emitter)
        for number, emitter in enumerate(scene.emitters)
        if id(emitter) in shown_lamps and isinstance(emitter, RoundLamp | BoxLamp | Sun)
    )


def lamp_light(lamp: Lamp, surfaces: tuple[int, ...]) -> Array:
    """(4, 3) one lamp's light on floor and walls in a room of those surfaces; on others 0."""
    found = np.zeros((4, 3))
    projected = lamp_field(lamp, surfaces).projected
    found[list(surfaces)] = np.outer(projected[list(surfaces)], lamp.radiance) / np.pi
    return found


@of_room
def sky_light(stage: Stage) -> Array:
    """(4, 3) all the sky's light on floor and walls, and what the room hands on; 0 on surfaces that are not there."""
    scene, surfaces = stage.scene, shown(stage.scene)
    if not surfaces:
        return np.zeros((4, 3))
    sky, environment = open_sky(surfaces), scene.environment
    if isinstance(environment, ImageEnvironment) and stage.panorama is not None:
        light = environment.scale * panorama_on_surfaces(stage.panorama, environment.turn_degrees, surfaces)
    else:
        light = ground_light(environment, sky)
    light = light + np.sum([lamp_light(lamp, surfaces) for _, lamp in lamps_of(scene)], axis=0, initial=0)
    light[[number for number in range(4) if number not in surfaces]] = 0
    found = handed_on(scene, light, sky)
    found.flags.writeable = False
    return found


def handed_on(scene: Scene, light: Array, sky: OpenSky) -> Array:
    """(4, 3) the same with what floor and walls send to each other: B = R (L + F B), solved for L + F B."""
    if not sky.others.any():
        return light
    found = np.empty_like(light)
    for channel in range(3):
        returned, own = np.zeros(4), np.zeros(4)
        for number in shown(scene):
            returned[number], own[number] = _returned(scene.floor if number == 0 else scene.walls, channel)
        radiosity = np.linalg.solve(np.eye(4) - returned[:, None] * sky.others, own + returned * light[:, channel])
        found[:, channel] = light[:, channel] + sky.others @ radiosity
    return found


def _returned(surface: Floor | Plane, channel: int) -> tuple[float, float]:
    """The part of its light that a surface returns, and the radiosity that it has of itself."""
    if isinstance(surface, StudioFloor):
        return 0.0, surface.colour[channel]
    if surface.kind == "mirror":
        return MIRROR_REFLECTANCE + MIRROR_SHARE * sum(MIRROR_ALBEDOS) / 2, 0.0
    return sum(albedo[channel] for albedo in surface.albedos) / 2, 0.0

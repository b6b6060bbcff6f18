"""What throws shadows and caustics: point lights, the sky's lamps, and a panorama's bright spots.

Of ambient skies nothing does: a clear stone gives an even sky back what it takes of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from culet.rendering.emitters.lamp_field import Lamp, lamp_field, normals
from culet.rendering.emitters.of_room import of_room
from culet.rendering.emitters.panorama_light import panorama_light, turned
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.unshaded import lamp_light, lamps_of, sky_light
from culet.rendering.room.surfaces import shown
from culet.scene.emitters import BoxLamp, PointLight, RoundLamp
from culet.scene.room import FLOOR_Y, StudioFloor
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage

Array = NDArray[np.float64]
Triple = tuple[float, float, float]

SHADOWS = 48
"""Rays of a wide lamp in a pass, past one stone: of 16 the outlines show in motion. A core takes 2 to 4 ms
more for them than for those."""
FEWEST_SHADOWS = 16
"""The same, past several stones, of which each ray's shadows take their time."""
MOVING_SHADOWS = 1200
"""Of stones on surfaces by rays, in the pass of a moving picture: a core takes 0.05 ms for each at most. Twelve stones
in a corner under six lamps then have FEWEST_MOVING rays of each lamp, whose outlines show for as long as they move."""
FEWEST_MOVING = 4
COMPACT_DEGREES = 1.0
"""Half angle of a lamp up to which the light that goes through a stone makes flecks: at 4 degrees they are blurred to
a third, at 24 to nothing."""


@dataclass(frozen=True, eq=False)
class Source:
    """One emitter, as it throws shadows and caustics."""

    emitter: int
    """Its number in the scene; spots are counted after the last emitter."""
    light: PointLight | Lamp
    shown: tuple[int, ...]
    """Surfaces of the room, which may hide parts of a lamp."""

    @property
    def compact(self) -> bool:
        """Whether its light makes flecks behind a stone."""
        match self.light:
            case PointLight():
                return True
            case BoxLamp(half_width_degrees=width, half_height_degrees=height):
                return max(width, height) <= COMPACT_DEGREES
            case RoundLamp(half_angle_degrees=angle):
                return angle <= COMPACT_DEGREES
            case other:
                assert_never(other)

    @property
    def colour(self) -> Triple:
        """Irradiance over pi of something that faces all of it, by channel."""
        if isinstance(self.light, PointLight):
            return self.light.colour
        red, green, blue = np.array(self.light.radiance) * lamp_field(self.light, self.shown).solid_angle / np.pi
        return float(red), float(green), float(blue)

    @property
    def white(self) -> Array:
        """(4, 3) a lamp's light on floor and walls past no stone, as the radiance of a white matte surface; of a point,
        whose light differs from place to place, 0."""
        return np.zeros((4, 3)) if isinstance(self.light, PointLight) else lamp_light(self.light, self.shown)

    def rays(self, number: int, shadows: int, *, caustics: bool) -> list[LightRay]:
        """Those of a pass of that number. The mean over passes is the source's light. A lamp that makes no flecks is
        taken apart into `shadows` rays of equal light."""
        if isinstance(self.light, PointLight):
            return [LightRay(self.colour, position=self.light.position, follows=caustics, emitter=self.emitter)]
        if self.compact:
            return [
                LightRay(self.colour, _towards(self.light, self.shown, number), follows=caustics, emitter=self.emitter)
            ]
        red, green, blue = self.colour
        share = red / shadows, green / shadows, blue / shadows
        first = number * shadows + 1
        return [
            LightRay(
                share, _towards(self.light, self.shown, each), follows=False, gauges=caustics and each == first,
                emitter=self.emitter,
            )
            for each in range(first, first + shadows)
        ]  # fmt: skip


@lru_cache(maxsize=4096)
def _towards(lamp: Lamp, surfaces: tuple[int, ...], number: int) -> Triple:
    """A direction of a lamp's open part: its middle, then a sequence that is spread as its light is."""
    middle = np.array(lamp.direction) / np.linalg.norm(lamp.direction)
    is_open = bool((normals(surfaces) @ middle > 0).all())
    x, y, z = middle if number == 0 and is_open else lamp_field(lamp, surfaces).sample(number)
    return float(x), float(y), float(z)


def sources_of(stage: Stage) -> tuple[Source, ...]:
    """All that send light to a surface that can have a map; on a studio floor only compact ones are shown."""
    return _sources_of(stage) if stage.shapes and stage.scene.optics.estimator != "classic" else ()


@of_room
def _sources_of(stage: Stage) -> tuple[Source, ...]:
    scene, surfaces = stage.scene, shown(stage.scene)
    if not surfaces:
        return ()
    matte = scene.floor.kind == "matte" or scene.walls.kind == "matte"
    if not matte and not isinstance(scene.floor, StudioFloor):
        return ()
    found = [
        Source(number, emitter, surfaces)
        for number, emitter in enumerate(scene.emitters)
        if isinstance(emitter, PointLight) and any(emitter.colour)
    ]
    lamps = [*lamps_of(scene), *enumerate(spots_of(stage), len(scene.emitters))]
    lit = [Source(number, lamp, surfaces) for number, lamp in lamps if any(lamp.radiance)]
    return (*found, *(source for source in lit if (matte or source.compact) and source.white.any()))


def spots_of(stage: Stage) -> tuple[Lamp, ...]:
    """Of a sky's picture, as the scene turns it."""
    environment = stage.scene.environment
    if not isinstance(environment, ImageEnvironment) or stage.panorama is None:
        return ()
    found = []
    for spot in panorama_light(stage.panorama).spots:
        x, y, z = turned(np.array(spot.direction), environment.turn_degrees / 360)
        red, green, blue = (environment.scale * part for part in spot.radiance)
        found.append(spot.model_copy(update={"direction": (x, y, z), "radiance": (red, green, blue)}))
    return tuple(found)


def mapped_surfaces(stage: Stage) -> tuple[int, ...]:
    """Surfaces that need a light map: matte ones that a source can reach past a stone, and a studio floor if a compact
    one is among them. None does where kernels find all that is thrown by themselves."""
    scene, sources = stage.scene, sources_of(stage)
    if not sources or _throws_sharp_shadows_alone(stage, sources):
        return ()
    studio = isinstance(scene.floor, StudioFloor) and any(source.compact for source in sources)
    floor = (0,) if scene.floor.kind == "matte" or studio else ()
    return (*floor, 1, 2, 3) if scene.walls.kind == "matte" else floor


def _throws_sharp_shadows_alone(stage: Stage, sources: tuple[Source, ...]) -> bool:
    """Whether one stone throws the hard shadows of points, and nothing else, onto surfaces that are lit point by point:
    kernels then ask whether the stone is in the way, which takes less time than to look a map up, and is exact. Past
    several stones a map takes less."""
    points = all(isinstance(source.light, PointLight) for source in sources)
    studio = isinstance(stage.scene.floor, StudioFloor)
    return stage.scene.optics.caustics == "off" and len(stage.shapes) == 1 and points and not studio


def rays_of(stage: Stage, number: int, *, moving: bool = False) -> list[LightRay]:
    """All rays of a pass, of all sources; as many of a wide lamp as are fitting for so many stones."""
    caustics = stage.scene.optics.caustics == "on"
    sources, stones = sources_of(stage), max(1, len(stage.scene.stones))
    shadows = max(FEWEST_SHADOWS, SHADOWS // stones)
    if moving:
        wide = sum(not source.compact for source in sources)
        share = MOVING_SHADOWS // max(1, wide * stones * len(mapped_surfaces(stage)))
        shadows = max(FEWEST_MOVING, min(shadows, share))
    return [ray for source in sources for ray in source.rays(number, shadows, caustics=caustics)]


def studio_light(stage: Stage, middle: Array) -> tuple[Array, Array]:
    """(3,) the part of a studio floor's light that comes from no source, and (3,) 1 over all its light, as the radiance
    of a white matte surface; a point's light is taken below the stones' middle.

    The floor shows its colour where all its light reaches it.
    """
    of_lamps, of_points = np.zeros(3), np.zeros(3)
    foot = np.array([middle[0], FLOOR_Y, middle[2]])
    for source in sources_of(stage):
        of_lamps += source.white[0]
        if isinstance(source.light, PointLight):
            way = np.array(source.light.position) - foot
            of_points += np.array(source.light.colour) * max(0.0, way[1] / max(float(np.linalg.norm(way)), 1e-30))
    of_sources, everything = of_lamps + of_points, sky_light(stage)[0] + of_points
    with np.errstate(divide="ignore", invalid="ignore"):
        even = np.where(everything > 0, np.clip(1 - of_sources / everything, 0, 1), 1)
        return even, np.where(everything > 0, 1 / everything, 0)

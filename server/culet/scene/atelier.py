"""The atelier: a dark room with soft boxes around the stone, small lamps for the fire, and a floor to stand on.

Boxes of 25 to 40 degrees make facets that switch between bright and dark; lamps of 2 to 3 degrees make flashes of some
pixels. Nothing stands where the table mirrors into the camera, else a veil lies over it.
"""

from __future__ import annotations

import math

from culet.scene.fields import Colour, Vector
from culet.scene.studio import BoxLamp, Lamp, StudioEnvironment

BOX_ELEVATION, BOX_TURN = 42.0, 45.0
LOW_ELEVATION = 14.0
LAMPS = (
    (11.6, 40), (36.8, 42), (84.1, 53), (105.4, 40), (135.5, 31), (147.9, 63),
    (176.7, 69), (229.7, 60), (237.8, 34), (290.3, 44), (314.1, 31), (331.7, 47),
)  # fmt: skip
"""Azimuth and elevation of the small lamps, degrees: spread around, and high and low without order."""


def towards(azimuth_degrees: float, elevation_degrees: float) -> Vector:
    """The unit vector there; azimuth from +z, where the default camera is, to +x."""
    azimuth, elevation = math.radians(azimuth_degrees), math.radians(elevation_degrees)
    level = math.cos(elevation)
    return (
        round(level * math.sin(azimuth), 4), round(math.sin(elevation), 4), round(level * math.cos(azimuth), 4)
    )  # fmt: skip


def grey(radiance: float) -> Colour:
    """The same in all channels."""
    return radiance, radiance, radiance


def boxes(count: int, radiance: float, *, fade: float = 0.45, half_height: float = 14) -> tuple[BoxLamp, ...]:
    """Soft boxes around the stone, brighter above than below."""
    return tuple(
        BoxLamp(
            shape="box", direction=towards(BOX_TURN + 360 * k / count, BOX_ELEVATION), radiance=grey(radiance),
            half_width_degrees=15, half_height_degrees=half_height, fade=fade, softness=0.4,
        )
        for k in range(count)
    )  # fmt: skip


def low_boxes(count: int, radiance: float) -> tuple[BoxLamp, ...]:
    """A ring of boxes just above the floor, whose gaps leave dark facets among bright ones."""
    return tuple(
        BoxLamp(
            shape="box", direction=towards(360 * (k + 0.5) / count, LOW_ELEVATION), radiance=grey(radiance),
            half_width_degrees=82 / count, half_height_degrees=10, softness=0.4,
        )
        for k in range(count)
    )  # fmt: skip


def small_lamps(radiance: float, half_angle_degrees: float = 2.6, count: int = len(LAMPS)) -> tuple[Lamp, ...]:
    """Warm and cold by turns, by a twentieth."""
    return tuple(
        Lamp(
            direction=towards(azimuth, elevation), half_angle_degrees=half_angle_degrees,
            radiance=tuple(round(radiance * (1 + 0.05 * side * (1 if k % 2 else -1)), 3) for side in (1, 0, -1)),
        )
        for k, (azimuth, elevation) in enumerate(LAMPS[:count])
    )  # fmt: skip


def atelier() -> StudioEnvironment:
    """The default light."""
    return StudioEnvironment(ambient=grey(0.045), lamps=(*boxes(5, 1.9), *low_boxes(7, 1.1), *small_lamps(10)))

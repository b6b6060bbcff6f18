"""The atelier: a dark room with soft boxes around the stone, small lamps for the fire, and a floor to stand on.

Boxes of 25 to 40 degrees make facets that switch between bright and dark; lamps of 2 to 3 degrees make flashes of some
pixels. Nothing stands where the table mirrors into the camera, else a veil lies over it.
"""

from __future__ import annotations

import math

from culet.scene.emitters import BoxLamp, RoundLamp
from culet.scene.fields import Colour, Vector

BOX_ELEVATION, BOX_TURN = 42.0, 45.0
LOW_ELEVATION = 14.0
PLACES = (
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


def boxes(
    radiance: float, *, count: int = 5, fade: float = 0.45, half_width: float = 17, half_height: float = 17
) -> tuple[BoxLamp, ...]:
    """Soft boxes around the stone, brighter above than below."""
    return tuple(
        BoxLamp(
            direction=towards(BOX_TURN + 360 * k / count, BOX_ELEVATION), radiance=grey(radiance),
            half_width_degrees=half_width, half_height_degrees=half_height, fade=fade, softness=0.4,
        )
        for k in range(count)
    )  # fmt: skip


def low_boxes(radiance: float, *, count: int = 7) -> tuple[BoxLamp, ...]:
    """A ring of boxes just above the floor, with a quarter of it left dark between them."""
    return tuple(
        BoxLamp(
            direction=towards(360 * (k + 0.5) / count, LOW_ELEVATION), radiance=grey(radiance),
            half_width_degrees=90 / count, half_height_degrees=12, softness=0.4,
        )
        for k in range(count)
    )  # fmt: skip


def small_lamps(radiance: float, *, half_angle_degrees: float = 2.6, count: int = len(PLACES)) -> tuple[RoundLamp, ...]:
    """Warm and cold by turns, by a twentieth."""
    warm, cold = (
        (round(radiance * (1 + part), 3), radiance, round(radiance * (1 - part), 3)) for part in (0.05, -0.05)
    )
    return tuple(
        RoundLamp(
            direction=towards(azimuth, elevation), half_angle_degrees=half_angle_degrees,
            radiance=warm if k % 2 else cold,
        )
        for k, (azimuth, elevation) in enumerate(PLACES[:count])
    )  # fmt: skip


AMBIENT = grey(0.038)
LAMPS: tuple[RoundLamp | BoxLamp, ...] = (*boxes(2.1), *low_boxes(1.1), *small_lamps(11))
"""The default light."""

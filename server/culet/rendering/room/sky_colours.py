"""The radiance of skies that need no picture, before their lamps."""

from __future__ import annotations

from typing import assert_never

from culet.scene.sky import (
    ConstantEnvironment,
    DarkEnvironment,
    Environment,
    GradientEnvironment,
    HalfEnvironment,
    ImageEnvironment,
    LightEnvironment,
    StudioEnvironment,
)


def sky_colours(environment: Environment) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Radiance at the bottom and at the top; equal where it is the same everywhere. Dark and light are the report's."""
    match environment:
        case ConstantEnvironment(radiance=radiance):
            return radiance, radiance
        case HalfEnvironment(radiance=radiance):
            return (0, 0, 0), radiance
        case GradientEnvironment(bottom=bottom, top=top):
            return bottom, top
        case StudioEnvironment(ambient=ambient):
            return ambient, ambient
        case LightEnvironment():
            return (0.7, 0.85, 1), (0.7, 0.85, 1)
        case DarkEnvironment() | ImageEnvironment():  # of a picture, which is looked up, nobody sees this
            return (0.05, 0.05, 0.1), (0.2, 0.2, 0.3)
        case _:
            assert_never(environment)

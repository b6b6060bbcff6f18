"""The default scene of version 0.1: what times and errors are compared with, whatever the default becomes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from culet.scene.backdrop import NoBackdrop
from culet.scene.camera import Camera
from culet.scene.emitters import PointLight, RoundLamp
from culet.scene.film import Film
from culet.scene.model import SPIN, Scene
from culet.scene.patch import emitters_under
from culet.scene.room import Plane
from culet.scene.sky import StudioEnvironment
from culet.scene.stone import StoneSettings

LEGACY_POINTS = (
    PointLight(position=(-4, 6, 4), colour=(1, 0.2, 0.2)),
    PointLight(position=(4, 6, 4), colour=(0.2, 0.5, 1)),
)
LEGACY_LAMPS = (
    RoundLamp(direction=(-0.6, 1, 0.35), half_angle_degrees=24, radiance=(1.5, 1.45, 1.35)),
    RoundLamp(direction=(0.9, 0.75, -0.4), half_angle_degrees=16, radiance=(1.1, 1.3, 1.6)),
    RoundLamp(direction=(0.25, 0.9, 0.9), half_angle_degrees=6, radiance=(8, 8, 8)),
    RoundLamp(direction=(-0.9, 0.45, -0.9), half_angle_degrees=5, radiance=(9, 8, 7)),
    RoundLamp(direction=(0.7, 0.3, 1), half_angle_degrees=4, radiance=(10, 10, 11)),
    RoundLamp(direction=(-0.2, 1, -0.35), half_angle_degrees=5, radiance=(9, 9, 9)),
)
LEGACY_DEFAULT = Scene(
    stones=(StoneSettings(position=(0, 0.5, 0), orientation=(0.93670, 0.33047, 0, 0.11566), spin=SPIN, mass=2),),
    emitters=(*LEGACY_LAMPS, *LEGACY_POINTS),
    floor=Plane(kind="mirror"),
    walls=Plane(kind="none"),
    environment=StudioEnvironment(ambient=(0.03, 0.035, 0.05)),
    backdrop=NoBackdrop(),
    head=None,
    camera=Camera(position=(0, 2.4, 4.6), target=(0, 0.1, 0), fov_degrees=40),
    film=Film(exposure=1, tone_map="srgb"),
)
"""A diamond that floats over a mirror floor under six round lamps, lit red and blue."""

_WHOLE: dict[str, Any] = json.loads(LEGACY_DEFAULT.model_dump_json())


def legacy(changes: Mapping[str, Any] | None = None) -> Scene:
    """As Scene.read reads it, but what is not there is the legacy default's: in the scene, its parts and its stones."""
    return Scene.read(_in_full(changes or {}))


def _in_full(changes: Mapping[str, Any]) -> dict[str, Any]:
    """The whole document; under another sky it has the point lights alone, if it names no emitters."""
    whole = _WHOLE | {name: _filled(name, value) for name, value in changes.items()}
    environment = whole["environment"]
    if "emitters" not in changes and isinstance(environment, dict):
        whole["emitters"] = emitters_under(environment.get("kind"), whole["emitters"])
    return whole


def _filled(name: str, value: Any) -> Any:  # noqa: ANN401 - JSON
    base = _WHOLE.get(name)
    if name == "stones" and isinstance(value, list):
        return [_WHOLE["stones"][0] | stone if isinstance(stone, dict) else stone for stone in value]
    if isinstance(base, dict) and isinstance(value, dict) and value.get("kind", base.get("kind")) == base.get("kind"):
        return base | value
    return value

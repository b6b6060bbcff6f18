"""Several stones at rest: three that touch each other, and a dozen that fell into a corner.

Where they lie was computed by `python -m culet.study.contacts.piles`.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from culet.scene.atelier import LAMPS
from culet.scene.backdrop import NoBackdrop
from culet.scene.camera import Camera
from culet.scene.emitters import PointLight
from culet.scene.model import Scene
from culet.scene.motion import MotionLaws
from culet.scene.optics import SPECTRAL_AT_REST
from culet.scene.room import Plane
from culet.scene.stone import StoneSettings

_PILES: dict[str, list[dict[str, Any]]] = json.loads(files("culet.scene").joinpath("piles.json").read_text())


def _pile(name: str) -> tuple[StoneSettings, ...]:
    return tuple(StoneSettings.model_validate(stone) for stone in _PILES[name])


TRIO = Scene(
    stones=_pile("trio"),
    camera=Camera(position=(0, 7.4, 11.4), target=(0.05, -0.5, 0.35), fov_degrees=20),
    optics=SPECTRAL_AT_REST,
)
HEAP = Scene(
    stones=_pile("heap"),
    emitters=(*LAMPS, PointLight(position=(2, 5, 2), colour=(0.3, 0.3, 0.3))),
    floor=Plane(kind="matte"),
    walls=Plane(kind="matte"),
    backdrop=NoBackdrop(),
    camera=Camera(position=(-1.2, 4.6, 1.5), target=(-3.75, -0.3, -6.1), fov_degrees=32),
    simulation=MotionLaws(friction=0.5),
)

"""Named scenes: the default and its kin, instruments of the trade, coloured stones, the report's own and figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

from culet.errors import NotFoundError
from culet.scene.atelier import atelier
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.model import (
    Camera,
    DarkEnvironment,
    Environment,
    Film,
    ImageEnvironment,
    LightEnvironment,
    Optics,
    Plane,
    Scene,
    Simulation,
    StoneSettings,
)
from culet.scene.studio import GradientBackdrop, Head, StudioFloor

RESTING_Y = -0.373345
"""Height of the default cut's centre where it rests on its pavilion as the default orientation has it."""

_CLASSIC_STONE = StoneSettings(
    material="classic", absorption=(0.02, 0.02, 0.02), position=(0, 4, 0), orientation=(1, 0, 0, 0)
)

CLASSIC = Scene(
    stones=(_CLASSIC_STONE,),
    floor=Plane(kind="mirror"),
    walls=Plane(kind="mirror"),
    lights=LEGACY_DEFAULT.lights,
    environment=DarkEnvironment(kind="dark"),
    camera=Camera(position=(0, 2, 13), target=(0, 1.4, 0), fov_degrees=45),
    optics=Optics(fresnel="schlick", estimator="classic", max_bounces=12),
    film=Film(tone_map="classic"),
    simulation=Simulation(model="classic", inertia="cone", time_step=1 / 30),
)
"""The report's own scene, to its constants: material, estimator, tone map and simulation."""


def _classic(
    *,
    floor: str = "mirror",
    walls: str = "none",
    light: bool = False,
    absorption: tuple[float, float, float] = (0.02, 0.02, 0.02),
    position: tuple[float, float, float] = (0, 4, 0),
    camera: Camera = CLASSIC.camera,
) -> Scene:
    stone = _CLASSIC_STONE.model_copy(update={"absorption": absorption, "position": position})
    return CLASSIC.model_copy(
        update={
            "stones": (stone,),
            "floor": Plane.model_validate({"kind": floor}),
            "walls": Plane.model_validate({"kind": walls}),
            "environment": LightEnvironment(kind="light") if light else DarkEnvironment(kind="dark"),
            "camera": camera,
        }
    )


_CLOSE = Camera(position=(0, 2.2, 5.5), target=(0, 0.9, 0), fov_degrees=45)


def _tinted(absorption: tuple[float, float, float]) -> Scene:
    return _classic(floor="mirror", light=True, absorption=absorption, position=(0, 1, 0), camera=_CLOSE)


Group = Literal["diamonds", "instruments", "coloured stones", "the report"]


@dataclass(frozen=True)
class Preset:
    """A named scene."""

    name: str
    """As commands and REST take it."""
    title: str
    """What people call it."""
    summary: str
    """One sentence about it."""
    group: Group
    scene: Scene


def _studio(**fields: Any) -> Scene:  # noqa: ANN401 - a scene's fields
    """A diamond at rest in the atelier, with some fields of its own."""
    base = Scene(
        stones=(StoneSettings(position=(0, RESTING_Y, 0)),),
        floor=StudioFloor(kind="studio"),
        lights=(),
        environment=atelier(),
        backdrop=GradientBackdrop(kind="gradient"),
        head=Head(),
        camera=Camera(position=(0, 8.146, 11.032), target=(0, -0.473, 0), fov_degrees=13),
        film=Film(tone_map="neutral"),
    )
    return base.model_copy(update=fields)


def _face_up(environment: Environment, **fields: Any) -> Scene:  # noqa: ANN401 - a scene's fields
    """The table level and above, seen straight down, nothing below."""
    return Scene(
        stones=(StoneSettings(position=(0, 0.5, 0), orientation=(1, 0, 0, 0)),),
        floor=Plane(kind="none"),
        lights=(),
        environment=environment,
        camera=Camera(kind="orthographic", position=(0, 12.5, 0), target=(0, 0.5, 0), up=(0, 0, -1), height=2.4),
        film=Film(tone_map="neutral"),
    ).model_copy(update=fields)


_ALL = (
    Preset("default", "Atelier", "A diamond at rest under soft boxes, before a dark backdrop.", "diamonds", Scene()),
    Preset("white", "On white", "The same diamond on white, as shops show it.", "diamonds", _studio()),
    Preset(
        "fire",
        "Fire",
        "Many small lamps in the dark: the colours that a diamond makes of white.",
        "diamonds",
        _studio(),
    ),
    Preset("falling", "Falling", "A diamond tossed into the atelier: let it fall.", "diamonds", _studio()),
    Preset(
        "mirror", "Mirror floor", "A diamond that floats over a mirror, lit red and blue.", "diamonds", LEGACY_DEFAULT
    ),
    Preset(
        "matte",
        "Checkered floor",
        "A diamond over a checkered matte floor, lit by two lights.",
        "diamonds",
        LEGACY_DEFAULT.model_copy(update={"floor": Plane(kind="matte")}),
    ),
    Preset(
        "face-up",
        "Face up",
        "Straight down its table: the dark arrows are your own head.",
        "instruments",
        _face_up(atelier()),
    ),
    Preset(
        "aset",
        "ASET",
        "Red comes from above, green from aside, blue from the head; what is black leaks.",
        "instruments",
        _face_up(ImageEnvironment(kind="image", image="aset"), optics=Optics(glare=False), film=Film()),
    ),
    Preset(
        "ideal-scope",
        "Ideal-Scope",
        "Red comes back to you, black is your head, white leaks.",
        "instruments",
        _face_up(ImageEnvironment(kind="image", image="aset"), optics=Optics(glare=False), film=Film()),
    ),
    Preset("ruby", "Ruby", "A ruby of its own cut, red by chromium.", "coloured stones", _studio()),
    Preset(
        "sapphire", "Sapphire", "A sapphire of its own cut, blue by iron and titanium.", "coloured stones", _studio()
    ),
    Preset("emerald", "Emerald", "An emerald of its own cut, green by chromium.", "coloured stones", _studio()),
    Preset(
        "classic",
        "Its own scene",
        "The report's own scene, to its constants: a small stone in the dark.",
        "the report",
        CLASSIC,
    ),
    Preset(
        "report-fig1",
        "Fig. 1",
        "A falling diamond and its reflection, in the dark.",
        "the report",
        _classic(position=(0, 2, 0), camera=Camera(position=(0, 1.6, 8), target=(0, 0.6, 0), fov_degrees=45)),
    ),
    Preset(
        "light-walls",
        "Fig. 2",
        "Light sky, walls, checker.",
        "the report",
        _classic(floor="matte", walls="matte", light=True),
    ),
    Preset("dark-checker", "Fig. 3", "Dark sky, checker, no walls.", "the report", _classic(floor="matte")),
    Preset("tinted-blue", "Fig. 11, blue", "Final values: absorbs red and green.", "the report", _tinted((2, 1, 0.1))),
    Preset("tinted-red", "Fig. 11, red", "After Fig. 11: absorbs green and blue.", "the report", _tinted((0.1, 2, 1))),
    Preset(
        "tinted-green", "Fig. 11, green", "After Fig. 11: absorbs red and blue.", "the report", _tinted((2, 0.1, 1))
    ),
    Preset("tinted-yellow", "Fig. 11, yellow", "After Fig. 11: absorbs blue.", "the report", _tinted((0.1, 0.3, 2))),
)

PRESETS: Mapping[str, Preset] = MappingProxyType({each.name: each for each in _ALL})
"""By name, in the order in which they are shown."""


def preset(name: str) -> Scene:
    """The scene of that name, or NotFoundError with the names that exist."""
    try:
        return PRESETS[name].scene
    except KeyError:
        raise NotFoundError(f"no preset {name!r}; there are: {', '.join(PRESETS)}") from None

"""Named scenes: the default, the stone face up, the report's own, and its figures."""

from __future__ import annotations

from culet.errors import NotFoundError
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
from culet.scene.studio import StudioEnvironment

_CLASSIC_STONE = StoneSettings(
    material="classic", absorption=(0.02, 0.02, 0.02), position=(0, 4, 0), orientation=(1, 0, 0, 0)
)

CLASSIC = Scene(
    stones=(_CLASSIC_STONE,),
    floor=Plane(kind="mirror"),
    walls=Plane(kind="mirror"),
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


_FROM_ABOVE = Camera(position=(0, 12.5, 0.001), target=(0, 0.5, 0), fov_degrees=12)
"""Straight down, but for the thousandth of R that tells which way up the picture is; so far away that rays are nearly
parallel, as in the instruments of the trade."""


def _face_up(environment: Environment) -> Scene:
    """The table level and above, nothing below."""
    return Scene(
        stones=(StoneSettings(orientation=(1, 0, 0, 0)),),
        floor=Plane(kind="none"),
        environment=environment,
        camera=_FROM_ABOVE,
    )


PRESETS: dict[str, tuple[str, Scene]] = {
    "default": ("A diamond over a mirror floor.", Scene()),
    "matte": ("The same diamond over a checkered matte floor, lit by both lights.", Scene(floor=Plane(kind="matte"))),
    "face-up": ("The same diamond face up, seen straight down its table.", _face_up(StudioEnvironment())),
    "aset": (
        "Face up under the ASET: red from above, green from aside, blue from the head, black leaks.",
        _face_up(ImageEnvironment(kind="image", image="aset")),
    ),
    "classic": ("The report's own scene, to its constants: a small stone in the dark.", CLASSIC),
    "falling": (
        "The report's Fig. 1: a falling diamond and its reflection, in the dark.",
        _classic(position=(0, 2, 0), camera=Camera(position=(0, 1.6, 8), target=(0, 0.6, 0), fov_degrees=45)),
    ),
    "light-walls": (
        "The report's Fig. 2: light sky, walls, checker.",
        _classic(floor="matte", walls="matte", light=True),
    ),
    "dark-checker": ("The report's Fig. 3: dark sky, checker, no walls.", _classic(floor="matte")),
    "tinted-blue": ("The report's Fig. 11, final values: absorbs red and green.", _tinted((2, 1, 0.1))),
    "tinted-red": ("After the report's Fig. 11: absorbs green and blue.", _tinted((0.1, 2, 1))),
    "tinted-green": ("After the report's Fig. 11: absorbs red and blue.", _tinted((2, 0.1, 1))),
    "tinted-yellow": ("After the report's Fig. 11: absorbs blue.", _tinted((0.1, 0.3, 2))),
}
"""Name -> (one line about it, the scene)."""


def preset(name: str) -> Scene:
    """The scene of that name, or NotFoundError with the names that exist."""
    try:
        return PRESETS[name][1]
    except KeyError:
        raise NotFoundError(f"no preset {name!r}; there are: {', '.join(PRESETS)}") from None

"""The report's own scene, to its constants, and its figures."""

from __future__ import annotations

from culet.scene.backdrop import NoBackdrop
from culet.scene.camera import Camera
from culet.scene.film import Film
from culet.scene.legacy import LEGACY_POINTS
from culet.scene.model import SPIN, Scene
from culet.scene.motion import MotionLaws
from culet.scene.optics import Optics
from culet.scene.room import Plane
from culet.scene.sky import DarkEnvironment, LightEnvironment
from culet.scene.stone import StoneSettings

_CLASSIC_STONE = StoneSettings(
    id="stone",
    material="classic",
    absorption=(0.02, 0.02, 0.02),
    position=(0, 4, 0),
    orientation=(1, 0, 0, 0),
    spin=SPIN,
    mass=2,
)

CLASSIC = Scene(
    stones=(_CLASSIC_STONE,),
    floor=Plane(kind="mirror"),
    walls=Plane(kind="mirror"),
    emitters=LEGACY_POINTS,
    backdrop=NoBackdrop(),
    head=None,
    environment=DarkEnvironment(kind="dark"),
    camera=Camera(position=(0, 2, 13), target=(0, 1.4, 0), fov_degrees=45),
    optics=Optics(fresnel="schlick", estimator="classic", max_bounces=12),
    film=Film(tone_map="classic"),
    simulation=MotionLaws(model="classic", inertia="cone", time_step=1 / 30),
)
"""The report's own scene, to its constants: material, estimator, tone map and simulation."""


def classic(
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


def tinted(absorption: tuple[float, float, float]) -> Scene:
    return classic(floor="mirror", light=True, absorption=absorption, position=(0, 1, 0), camera=_CLOSE)

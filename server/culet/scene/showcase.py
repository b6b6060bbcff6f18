"""Stones in the light that shows them best: diamonds in the atelier, face up, and coloured stones on white."""

from __future__ import annotations

from culet.scene.atelier import AMBIENT, boxes, grey, low_boxes, small_lamps, towards
from culet.scene.backdrop import GradientBackdrop, NoBackdrop
from culet.scene.camera import Camera, Head
from culet.scene.cuts import BrilliantCut, EmeraldCut, OvalCut, PortugueseCut, PrincessCut
from culet.scene.emitters import AnyEmitter, BoxLamp
from culet.scene.fields import Colour
from culet.scene.film import Film
from culet.scene.model import SPIN, Scene
from culet.scene.optics import SPECTRAL_AT_REST, Optics
from culet.scene.room import Plane, StudioFloor
from culet.scene.sky import Environment, ImageEnvironment, StudioEnvironment
from culet.scene.stone import MaterialName, StoneSettings

WHITE = Scene(
    floor=StudioFloor(kind="studio", colour=grey(0.75), reflectance=0.1, shadow=0.6),
    backdrop=GradientBackdrop(kind="gradient", centre=(0.96, 0.965, 0.975), edge=(0.62, 0.635, 0.66)),
    environment=StudioEnvironment(ambient=AMBIENT),
    emitters=(*boxes(1.9), *low_boxes(1.1), *small_lamps(11)),
    optics=SPECTRAL_AT_REST,
)
FIRE = Scene(
    floor=StudioFloor(kind="studio", colour=grey(0.004)),
    backdrop=GradientBackdrop(kind="gradient", centre=(0.013, 0.013, 0.017), edge=(0.002, 0.002, 0.003)),
    environment=StudioEnvironment(ambient=grey(0.014)),
    emitters=(*boxes(0.3), *low_boxes(0.2, count=5), *small_lamps(26, half_angle_degrees=3.6)),
    optics=Optics(bands=16),
    film=Film(exposure=1.6),
)
"""Sixteen wavelengths, so that rainbows are smooth."""
FALLING = Scene(
    floor=StudioFloor(kind="studio", colour=grey(0.063)),
    environment=StudioEnvironment(ambient=grey(0.032)),
    emitters=(*boxes(3.2, half_width=18, half_height=18), *low_boxes(1.8), *small_lamps(11)),
    stones=(StoneSettings(position=(-0.6, 1.5, 0), velocity=(0.8, 1.5, 0), spin=(1.5, 5, -2)),),
    camera=Camera(position=(0, 7.2, 12), target=(0, 0, 0), fov_degrees=17),
    optics=SPECTRAL_AT_REST,
)

_FACE_UP_CAMERA = Camera(kind="orthographic", position=(0, 12.5, 0), target=(0, 0.5, 0), up=(0, 0, -1), height=2.4)
"""Straight down; rays are parallel, as in the instruments of the trade."""


def _face_up(environment: Environment, emitters: tuple[AnyEmitter, ...] = (), **more: object) -> Scene:
    """The table level and above, seen straight down."""
    stone = StoneSettings(position=(0, 0.5, 0), orientation=(1, 0, 0, 0), spin=SPIN)
    scene = Scene(stones=(stone,), environment=environment, emitters=emitters, camera=_FACE_UP_CAMERA)
    return scene.model_copy(update=more)


FACE_UP = _face_up(
    StudioEnvironment(ambient=grey(0.06)),
    (
        *(
            BoxLamp(
                direction=towards(22.5 + 45 * k, 50), radiance=grey(1.25), half_width_degrees=14.5,
                half_height_degrees=26, fade=0.2, softness=0.3,
            )
            for k in range(8)
        ),
        *small_lamps(14, half_angle_degrees=2.2, count=10),
    ),
    head=Head(half_angle_degrees=13),
    floor=StudioFloor(kind="studio", colour=grey(0.02), reflectance=0, shadow=0),
    backdrop=GradientBackdrop(kind="gradient", focus=(0, 0)),
)  # fmt: skip
"""Nearly a tent of eight boxes, whose gaps and the head draw the pattern."""


def _instrument(image: str) -> Scene:
    """Under a panorama of the trade's colours; what the stone's surface mirrors would mix with what comes out of it."""
    return _face_up(
        ImageEnvironment(kind="image", image=image), floor=Plane(kind="none"), backdrop=NoBackdrop(), head=None,
        optics=Optics(glare=False), film=Film(tone_map="srgb"),
    )  # fmt: skip


ASET = _instrument("aset")
IDEAL_SCOPE = _instrument("ideal-scope")


def _coloured(material: MaterialName, millimetres: float, exposure: float, **stone: object) -> Scene:
    """On white."""
    ground: Colour = grey(0.2)
    return Scene(
        millimetres=millimetres,
        stones=(StoneSettings.model_validate({"material": material, "spin": SPIN} | stone),),
        floor=StudioFloor(kind="studio", colour=grey(0.5), reflectance=0.1, shadow=0.6),
        backdrop=GradientBackdrop(kind="gradient", centre=(0.86, 0.865, 0.88), edge=(0.5, 0.51, 0.53)),
        environment=StudioEnvironment(ambient=ground),
        emitters=(*boxes(2.3, half_width=17, half_height=17), *low_boxes(1.8), *small_lamps(10, count=8)),
        optics=SPECTRAL_AT_REST,
        film=Film(exposure=exposure),
    )


def _steep(crown: float, pavilion: float) -> BrilliantCut:
    """Angles of a diamond would leave a window in a coloured stone."""
    return BrilliantCut(table_percent=55, crown_degrees=crown, pavilion_degrees=pavilion)


RUBY = _coloured("ruby", 1.5, 1.2, cut=_steep(38, 42.5), position=(0, -0.338769, 0))
SAPPHIRE = _coloured("sapphire", 4, 1, cut=_steep(40, 43), position=(0, -0.323153, 0))
EMERALD = _coloured("emerald", 4.5, 1.1, cut=_steep(40, 43.5), position=(0, -0.314927, 0))

PRINCESS = Scene(
    stones=(StoneSettings(cut=PrincessCut(), position=(0, -0.449614, 0), spin=SPIN),), optics=SPECTRAL_AT_REST
)
PORTUGUESE = Scene(
    stones=(StoneSettings(cut=PortugueseCut(), material="quartz", position=(0, -0.292772, 0), spin=SPIN),),
    optics=SPECTRAL_AT_REST,
)
CUTTERS_DESIGN = Scene(
    stones=(StoneSettings(mesh="standard-round-brilliant", material="quartz", position=(0, -0.407653, 0), spin=SPIN),),
    optics=SPECTRAL_AT_REST,
)
OVAL = _coloured(
    "sapphire", 4, 1, cut=OvalCut(crown_degrees=40, pavilion_degrees=43), position=(0, -0.532682, 0),
    orientation=(0.929570, 0.366168, -0.039696, 0.015637),
)  # fmt: skip
EMERALD_CUT = _coloured(
    "emerald", 4.5, 1.1, cut=EmeraldCut(), position=(0, -0.536143, 0),
    orientation=(0.908894, 0.414207, -0.044061, 0.020080),
)  # fmt: skip
"""As they lie on the floor, of which `with_cut` tells."""

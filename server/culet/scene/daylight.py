"""Stones on matte floors, in light that throws their shadows and their fire: a low sun, a window, two small lights."""

from __future__ import annotations

from culet.scene.atelier import grey, towards
from culet.scene.backdrop import NoBackdrop
from culet.scene.camera import Camera
from culet.scene.emitters import BoxLamp, Sun
from culet.scene.film import Film
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.model import Scene
from culet.scene.optics import Optics
from culet.scene.room import Checker, Plane
from culet.scene.sky import GradientEnvironment, StudioEnvironment

_CAMERA = Camera(position=(0, 4.2, 8.5), target=(0.35, -0.6, 0.5), fov_degrees=25)

SUN = Scene(
    emitters=(
        Sun(direction=towards(230, 20), colour=(2.2, 2.05, 1.8)),
        *(
            BoxLamp(
                direction=towards(azimuth, elevation), radiance=grey(1.2), half_width_degrees=16,
                half_height_degrees=16, fade=0.4, softness=0.4,
            )
            for azimuth, elevation in ((30, 50), (-60, 42))
        ),
    ),
    floor=Plane(kind="matte", albedo=(0.4, 0.38, 0.35), checker="off"),
    environment=GradientEnvironment(kind="gradient", bottom=(0, 0, 0), top=(0.1, 0.13, 0.2)),
    backdrop=NoBackdrop(),
    head=None,
    camera=_CAMERA,
    optics=Optics(bands=8),
    film=Film(exposure=0.85),
)  # fmt: skip
"""The sun at its true size, 20 degrees high: low enough that its shadow leaves the floor about the stone to the flecks.
Two faint boxes are there for the stone's own sake. Eight wavelengths draw each fleck's rainbow."""
WINDOW = Scene(
    emitters=(
        BoxLamp(
            direction=towards(-105, 28), radiance=(11, 10.8, 10.2), half_width_degrees=8, half_height_degrees=21,
            softness=0.1,
        ),
        BoxLamp(
            direction=towards(40, 35), radiance=grey(0.5), half_width_degrees=25, half_height_degrees=18, softness=0.4
        ),
    ),
    floor=Plane(kind="matte", albedo=(0.42, 0.36, 0.3), checker="off"),
    environment=StudioEnvironment(ambient=(0.05, 0.055, 0.065)),
    backdrop=NoBackdrop(),
    head=None,
    camera=_CAMERA,
    film=Film(exposure=1.4),
)  # fmt: skip
"""One tall soft lamp, and what the room gives back of it."""
MATTE = LEGACY_DEFAULT.model_copy(
    update={"floor": Plane(kind="matte", albedo=grey(0.5), checker=Checker(albedo=grey(0.33)))}
)
"""The floor is dark enough that flecks can be brighter than it is."""

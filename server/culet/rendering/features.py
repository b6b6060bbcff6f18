"""What kind of scene it is: the few, slowly changing choices that are compiled into a program."""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields, replace
from enum import IntEnum

from culet.geometry.shape import Shape
from culet.optics.dispersion import channel_indices
from culet.rendering.chains import is_coloured, is_spectral
from culet.rendering.mirrors import makes_finite_group
from culet.rendering.projection import camera_is_inside
from culet.scene.emitters import boxes, discs
from culet.scene.room import Floor, Plane
from culet.scene.sky import Environment
from culet.stage import Stage

RUNTIME = -1
"""The choice is left to the parameters; the program holds the code of every kind."""


class Geometry(IntEnum):
    """As in features.cl."""

    EMPTY = 0
    HULL = 1
    MESH = 2


MOST_HALF_SPACES = 1500
"""Facets up to which a convex stone is traced by half-spaces: their cost grows with the number, a tree's hardly. Of
balls, one of 600 facets takes 1.9 times as long by the tree, one of 1500 as long, one of 2000 0.8 times."""
ESTIMATOR = {"chain": 0, "classic": 1}
SURFACE = {"none": 0, "matte": 1, "mirror": 2, "studio": 3}
SKY = {"constant": 0, "light": 0, "studio": 0, "dark": 1, "gradient": 1, "half": 2, "image": 3}
FRESNEL = {"exact": 0, "schlick": 1}
END = {"cut": 0, "roulette": 1, "sky": 2}


@dataclass(frozen=True)
class Features:
    """One field for each feature of features.cl, by the same name in lower case."""

    geometry: int = Geometry.HULL
    floor: int = RUNTIME
    walls: int = RUNTIME
    lights: int = RUNTIME
    sky: int = RUNTIME
    lamps: int = RUNTIME
    boxes: int = RUNTIME
    head: int = RUNTIME
    backdrop: int = RUNTIME
    glare: int = RUNTIME
    dispersion: int = RUNTIME
    absorption: int = RUNTIME
    fresnel: int = RUNTIME
    end: int = RUNTIME
    spectral: int = 0
    polarised: int = 0
    few_mirrors: int = 0
    camera_inside: int = RUNTIME
    estimator: int = ESTIMATOR["chain"]

    @property
    def general(self) -> Features:
        """The program for every scene of this estimator and geometry, spectral or not, polarised or not. It reflects in
        its own precision."""
        return Features(
            geometry=self.geometry, spectral=self.spectral, polarised=self.polarised, estimator=self.estimator
        )

    @property
    def options(self) -> list[str]:
        """For the compiler; what is left to run time is not named."""
        return [
            f"-D{field.name.upper()}={int(value)}"
            for field, value in zip(fields(self), astuple(self), strict=True)
            if value != RUNTIME
        ]

    def without(self, name: str) -> Features:
        """The same with one feature left to run time."""
        return replace(self, **{name: RUNTIME})


def shape_on(stage: Stage) -> Shape | None:
    """The shape of the stage's stone, if there is one."""
    return stage.shapes[0] if stage.shapes else None


def geometry_of(shape: Shape | None) -> Geometry:
    """How a stone is traced."""
    if shape is None:
        return Geometry.EMPTY
    return Geometry.HULL if shape.convex and len(shape.planes) <= MOST_HALF_SPACES else Geometry.MESH


def features_of(stage: Stage) -> Features:
    """The program that holds what this stage needs, and nothing else."""
    scene, shape = stage.scene, shape_on(stage)
    kinds: tuple[Floor, Plane, Environment] = (scene.floor, scene.walls, scene.environment)
    floor, walls, environment = kinds
    optics = scene.optics
    lit = floor.kind in ("matte", "mirror") or walls.kind != "none"
    settings = scene.only_stone() if shape is not None else None
    indices = channel_indices(settings.material) if settings else (1.0, 1.0, 1.0)
    return Features(
        geometry=geometry_of(shape),
        floor=SURFACE[floor.kind],
        walls=SURFACE[walls.kind],
        lights=RUNTIME if scene.points and lit else 0,
        sky=SKY[environment.kind],
        lamps=RUNTIME if discs(scene.shown_lamps) else 0,
        boxes=RUNTIME if boxes(scene.shown_lamps) else 0,
        head=int(scene.head is not None),
        backdrop=int(scene.backdrop.kind != "none"),
        glare=int(optics.glare),
        dispersion=int(len(set(indices)) > 1),
        absorption=RUNTIME if shape is not None and is_coloured(scene) else 0,
        fresnel=FRESNEL[optics.fresnel],
        end=END[optics.end],
        spectral=int(is_spectral(scene)),
        polarised=int(optics.polarised and optics.estimator == "chain"),
        few_mirrors=int(shape is not None and makes_finite_group(shape)),
        camera_inside=int(shape is not None and camera_is_inside(scene, shape)),
        estimator=ESTIMATOR[optics.estimator],
    )

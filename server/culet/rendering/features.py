"""What kind of scene it is: the few, slowly changing choices that are compiled into a program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields, replace
from enum import IntEnum
from weakref import ref

from culet.errors import SceneError
from culet.geometry.shape import Shape
from culet.rendering.chains import disperses, is_coloured, is_spectral
from culet.rendering.emitters.sources import mapped_surfaces
from culet.rendering.stones.mirrors import makes_finite_group
from culet.rendering.stones.placed_stone import camera_stone, placed_stones
from culet.scene.emitters import boxes, discs
from culet.scene.model import Scene
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


class StoneCount(IntEnum):
    """As in features.cl."""

    ONE = 1
    MANY = 2


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
    light_map: int = RUNTIME
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
    alike: int = 0
    camera_inside: int = RUNTIME
    stones: int = StoneCount.ONE
    estimator: int = ESTIMATOR["chain"]

    @property
    def general(self) -> Features:
        """The program for every scene of this estimator and geometry, spectral or not, polarised or not. It reflects in
        its own precision."""
        return Features(
            geometry=self.geometry,
            spectral=self.spectral,
            polarised=self.polarised,
            stones=self.stones,
            estimator=self.estimator,
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


def by_half_spaces(shape: Shape) -> bool:
    """Whether a shape is traced by its half-spaces, or else by its triangles."""
    return shape.convex and len(shape.planes) <= MOST_HALF_SPACES


def geometry_of(shapes: Sequence[Shape]) -> Geometry:
    """How stones are traced."""
    if not shapes:
        return Geometry.EMPTY
    return Geometry.HULL if all(map(by_half_spaces, dict.fromkeys(shapes))) else Geometry.MESH


def stones_of(scene: Scene) -> StoneCount:
    """Which program the stones need: one of scale 1 has the frame to itself."""
    return (
        StoneCount.MANY if len(scene.stones) > 1 or any(stone.scale != 1 for stone in scene.stones) else StoneCount.ONE
    )


_latest: list[tuple[ref[Stage], Features]] = []
"""What was found last. Stages are compared by what they are, not by what they hold, which takes longer than to find."""


def features_of(stage: Stage) -> Features:
    """The program that holds what this stage needs, and nothing else. SceneError where the classic estimator is asked
    for more than one stone of scale 1. Of one stage it is asked several times for each frame, and found once."""
    for known, features in _latest:
        if known() is stage:
            return features
    features = _features_of(stage)
    _latest[:] = [(ref(stage), features)]
    return features


def _features_of(stage: Stage) -> Features:
    scene, shapes = stage.scene, stage.shapes
    kinds: tuple[Floor, Plane, Environment] = (scene.floor, scene.walls, scene.environment)
    floor, walls, environment = kinds
    optics, stones = scene.optics, stones_of(scene)
    if optics.estimator == "classic" and stones == StoneCount.MANY:
        raise SceneError(
            f"optics.estimator: expected chain, which takes any stones, or one stone of scale 1 for classic, got "
            f"classic and {len(scene.stones)} stones",
            "optics.estimator",
        )
    lit = floor.kind in ("matte", "mirror") or walls.kind != "none"
    return Features(
        geometry=geometry_of(shapes),
        floor=SURFACE[floor.kind],
        walls=SURFACE[walls.kind],
        lights=RUNTIME if scene.points and lit else 0,
        light_map=RUNTIME if mapped_surfaces(stage) else 0,
        sky=SKY[environment.kind],
        lamps=RUNTIME if discs(scene.shown_lamps) else 0,
        boxes=RUNTIME if boxes(scene.shown_lamps) else 0,
        head=int(scene.head is not None),
        backdrop=int(scene.backdrop.kind != "none"),
        glare=int(optics.glare),
        dispersion=int(disperses(scene)),
        absorption=RUNTIME if is_coloured(scene) else 0,
        fresnel=FRESNEL[optics.fresnel],
        end=END[optics.end],
        spectral=int(is_spectral(scene)),
        polarised=int(optics.polarised and optics.estimator == "chain"),
        few_mirrors=int(any(map(makes_finite_group, dict.fromkeys(shapes)))),
        alike=int(stones == StoneCount.MANY and geometry_of(shapes) == Geometry.HULL and len(set(shapes)) == 1),
        camera_inside=int(camera_stone(scene, placed_stones(stage)) is not None),
        stones=stones,
        estimator=ESTIMATOR[optics.estimator],
    )

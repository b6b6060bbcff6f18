"""Scenes that benchmarks measure: one list, so that every figure names what it is of."""

from __future__ import annotations

from functools import cache

import trimesh

from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.scene.camera import Camera
from culet.scene.cuts import PortugueseCut
from culet.scene.emitters import Sun
from culet.scene.legacy import LEGACY_DEFAULT, LEGACY_LAMPS, LEGACY_POINTS
from culet.scene.model import Scene
from culet.scene.optics import Optics
from culet.scene.room import FLOOR_Y, Plane
from culet.scene.sky import GradientEnvironment
from culet.scene.stone import MOST_STONES, IndexMaterial, StoneSettings
from culet.stage import NOTHING, Library, Stage
from culet.study.solids import ball

_STONE = StoneSettings(
    id="stone", material=IndexMaterial(ior=(2.41, 2.43, 2.45)), position=(0, 0, 0), orientation=(1, 0, 0, 0)
)

CHECKER = LEGACY_DEFAULT.model_copy(
    update={
        "stones": (_STONE,),
        "floor": Plane(kind="matte"),
        "emitters": (),
        "environment": GradientEnvironment(kind="gradient", bottom=(0.9, 0.9, 1), top=(0.2, 0.3, 0.6)),
        "camera": Camera(position=(0, 2.2, 3.2), target=(0, 0, 0), fov_degrees=45),
        "optics": Optics(max_bounces=64),
    }
)
"""The main job at its plainest: a brilliant of three indices over a checker without lights, 64 bounces."""

RING = "ring"
"""In place of the id of an upload."""

BALLS = {f"ball-{facets}": facets for facets in (30, 200, 1000)}
"""Likewise, of stones without symmetry: how many facets they have."""

_DEFAULT = Scene().stones[0]
_SCALE = 12**-0.5

TWELVE = Scene().model_copy(
    update={
        "stones": tuple(
            _DEFAULT.model_copy(
                update={
                    "id": f"stone-{4 * row + column}",
                    "scale": _SCALE,
                    "position": (
                        _SCALE * (2 * column - 3),
                        FLOOR_Y + _SCALE * (_DEFAULT.position[1] - FLOOR_Y),
                        _SCALE * (2 * row - 2),
                    ),
                }
            )
            for row in range(3)
            for column in range(4)
        )
    }
)
"""Twelve brilliants that stand side by side on the floor, and together cover what the default one covers."""


def _portuguese(sides: int, scale: float) -> Scene:
    """The default scene with another cut, of 12 facets a side and the table, which covers what its own stone covers."""
    cut = PortugueseCut(sides=sides, crown_rows=5, pavilion_rows=6)
    return Scene().model_copy(update={"stones": (_DEFAULT.model_copy(update={"cut": cut, "scale": scale}),)})


def _of_mesh(name: str) -> Scene:
    return LEGACY_DEFAULT.model_copy(update={"stones": (LEGACY_DEFAULT.stones[0].model_copy(update={"mesh": name}),)})


OUT_OF_VIEW = Scene().model_copy(
    update={
        "stones": tuple(
            _DEFAULT.model_copy(
                update={
                    "id": f"stone-{number}",
                    "position": (3 * (number % 8) - 10, _DEFAULT.position[1], 30 + 3 * (number // 8)),
                }
            )
            for number in range(MOST_STONES)
        )
    }
)
"""As many as there can be, behind the camera."""

CASES: dict[str, Scene] = {
    "checker": CHECKER,
    "checker, 256 bounces": CHECKER.model_copy(update={"optics": Optics()}),
    "checker, both lights": CHECKER.model_copy(update={"emitters": LEGACY_POINTS}),
    "mirror, both lights": CHECKER.model_copy(update={"emitters": LEGACY_POINTS, "floor": Plane(kind="mirror")}),
    "default": Scene(),
    "default, 193 facets": _portuguese(16, 1.02963),
    "default, 181 facets in pairs": _portuguese(15, 1.06282),
    "legacy default": LEGACY_DEFAULT,
    "legacy default, 8 bands": LEGACY_DEFAULT.model_copy(update={"optics": Optics(bands=8)}),
    "legacy default, polarised": LEGACY_DEFAULT.model_copy(update={"optics": Optics(polarised=True)}),
    "legacy default, mesh of 5 000 triangles": _of_mesh(RING),
    **{f"legacy default, {facets} facets without symmetry": _of_mesh(name) for name, facets in BALLS.items()},
    "default, twelve stones": TWELVE,
    "default, 64 stones out of view": OUT_OF_VIEW,
    "default, without stones": Scene().model_copy(update={"stones": ()}),
}
"""Name -> scene; the first is what the others are compared with."""


@cache
def ring() -> Shape:
    """A ring of 5 000 triangles, which is not convex."""
    torus = trimesh.creation.torus(major_radius=0.66, minor_radius=0.34, major_sections=50, minor_sections=50)
    return shape_from_mesh(torus.export(file_type="obj").encode(), "obj", name="ring.obj")


@cache
def _mesh(name: str) -> Shape:
    return ring() if name == RING else ball(BALLS[name])()


def stage_of(scene: Scene) -> Stage:
    """The stage of one of these scenes."""
    meshes = {stone.mesh: _mesh(stone.mesh) for stone in scene.stones if stone.mesh}
    return Stage.of(scene, Library(meshes) if meshes else NOTHING)


BARE = CHECKER.model_copy(
    update={
        "stones": (_STONE.model_copy(update={"material": IndexMaterial(ior=(2.43, 2.43, 2.43))}),),
        "floor": Plane(kind="none"),
        "optics": Optics(),
    }
)
"""A stone under a sky, with nothing that could be left out."""


def _lit_by_a_sun(height: float) -> Scene:
    """Over a matte floor; a sun below the floor lights nothing."""
    sun = Sun(shape="sun", direction=(1, height, 1), colour=(1, 1, 1))
    return BARE.model_copy(update={"floor": Plane(kind="matte"), "emitters": (sun,)})


UNDER_THE_SKY = BARE.model_copy(update={"environment": LEGACY_DEFAULT.environment})

FEATURE_CASES: dict[str, tuple[Scene, Scene]] = {
    "floor": (BARE, BARE.model_copy(update={"floor": Plane(kind="matte")})),
    "walls": (BARE, BARE.model_copy(update={"walls": Plane(kind="matte")})),
    "lights": (
        BARE.model_copy(update={"floor": Plane(kind="mirror")}),
        BARE.model_copy(update={"floor": Plane(kind="mirror"), "emitters": LEGACY_POINTS}),
    ),
    "light_map": (_lit_by_a_sun(-1), _lit_by_a_sun(1)),
    "sky": (BARE, UNDER_THE_SKY),
    "lamps": (UNDER_THE_SKY, UNDER_THE_SKY.model_copy(update={"emitters": LEGACY_LAMPS})),
    "dispersion": (BARE, BARE.model_copy(update={"stones": CHECKER.stones})),
    "absorption": (
        BARE,
        BARE.model_copy(update={"stones": (BARE.stones[0].model_copy(update={"absorption": (0.1, 0.2, 0.3)}),)}),
    ),
    "fresnel": (
        BARE.model_copy(update={"optics": Optics(fresnel="schlick")}),
        BARE,
    ),
    "camera_inside": (BARE, BARE.model_copy(update={"camera": Camera(position=(0, 0.1, 0), target=(0, 0.1, -1))})),
}
"""Feature -> a scene without it, and the same with it."""

"""`python -m culet.study.renderer.precision`: pixels that single precision shows otherwise than double, and why.

Where a picture is smooth, rounding is not seen: a pixel that changes by more than DECIDED is one where the picture is
steep. So the same picture is made again in double precision with stone and camera moved and turned at random, by a few
times what rounding does, and a pixel counts as explained if that changes it by half as much as single precision.
How it changes then tells why:

- in a step, and also with nothing but the stone under a smooth sky: another facet, or past the silhouette;
- in a step otherwise: another side of an edge in the room, of a checker's cell, a shadow, or the stone in a mirror;
- on a slope that is gentler where lamps have softer rims: a lamp's rim;
- on another slope: the critical angle, where that of the reflectance is infinite.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.rendering.renderer import Renderer
from culet.scene.emitters import PointLight
from culet.scene.legacy import LEGACY_LAMPS, legacy
from culet.scene.model import Scene
from culet.scene.room import Plane
from culet.scene.sky import GradientEnvironment
from culet.stage import Stage

Array = NDArray[np.float64]
SceneSettings = Mapping[str, Any]

DECIDED = 1e-4
"""Radiance."""
PERTURBATION = 2e-6
"""R, and radians: some ten times the rounding of a position on the stone, since that adds up over tens of bounces."""
TURNS = 64
"""Perturbed pictures. A pixel that is at an edge moves past it in half of them."""
STEP = 0.55
"""Largest gap between the sorted values of a pixel, as part of their range. Values of a step have one gap, near 1; on
a slope, or at the root of a uniform variable, as about the critical angle, it is 0.2 or so. From 0.4 to 0.7 are few."""
SMOOTH = 1e-5
"""Radiance by which a pixel of the stone alone changes where nothing is steep: below 7e-6 in 99 % of them."""
SOFTER = 0.7
"""Part of its change that is left of a pixel at a lamp's rim where all rims are as soft as can be: 0.2 to 0.4."""
SIZE = 640, 360
FARTHER: Mapping[str, float] = {"mirrors all around, absorption": 5e-6}
"""PERTURBATION of scenes where light takes a way several times as long, from mirror to mirror."""

_BARE: SceneSettings = {"floor": {"kind": "none"}, "emitters": []}
SCENES: Mapping[str, SceneSettings] = {
    "legacy default": {},
    "matte floor, lights": {"floor": {"kind": "matte"}},
    "matte floor, no lights": {"floor": {"kind": "matte"}, "emitters": [lamp.model_dump() for lamp in LEGACY_LAMPS]},
    "stone alone, gradient": {**_BARE, "environment": {"kind": "gradient"}},
    "stone alone, half": {**_BARE, "environment": {"kind": "half"}},
    "mirrors all around, absorption": {
        "walls": {"kind": "mirror"},
        "stones": [{"material": "classic", "absorption": [0.02, 0.3, 1]}],
    },
    "from inside": {
        "stones": [{"material": {"ior": [2.4, 2.4, 2.4]}, "position": [0, 0, 0]}],
        "camera": {"position": [0.1, 0, 0.1], "target": [0, 0, -1], "fov_degrees": 90},
    },
}


@dataclass(frozen=True)
class Verdict:
    """Of one scene."""

    pixels: int
    decided: int
    """Differ by more than DECIDED in some channel;"""
    facet: int
    room: int
    rim: int
    critical: int
    """what decided them,"""
    unexplained: int
    """and how many the perturbations do not move."""
    moved: float
    """Part of all pixels that the perturbations move by more than DECIDED."""
    mean: float
    """Difference of the whole picture, single less double, radiance."""
    sigma: float
    """Of that mean, if each decided pixel is as likely brighter as darker."""


def judge(
    single: Renderer, double: Renderer, scene: Scene, size: tuple[int, int] = SIZE, perturbation: float = PERTURBATION
) -> Verdict:
    """Compare the two and explain each pixel that differs."""
    exact = _radiance(double, scene, size)
    difference = _radiance(single, scene, size) - exact
    differs = np.abs(difference).max(axis=-1)
    decided = differs > DECIDED
    alone, soft = _alone(scene), _softened(scene)
    random = np.random.default_rng(1)
    moved, values = np.zeros(decided.shape), [exact[decided]]
    values_alone, values_soft = [], []
    for _ in range(TURNS):
        places = _perturbed(scene, random, perturbation)
        picture = _radiance(double, scene.model_copy(update=places), size)
        moved = np.maximum(moved, np.abs(picture - exact).max(axis=-1))
        values.append(picture[decided])
        values_alone.append(_radiance(double, alone.model_copy(update=places), size)[decided])
        values_soft.append(_radiance(double, soft.model_copy(update=places), size)[decided])
    explained = moved[decided] >= differs[decided] / 2
    steps = explained & is_step(np.array(values))
    slopes = explained & ~steps
    facet = steps & (_spread(np.array(values_alone)) > SMOOTH)
    rim = slopes & (_spread(np.array(values_soft)) < SOFTER * _spread(np.array(values)))
    return Verdict(
        pixels=decided.size,
        decided=int(decided.sum()),
        facet=int(facet.sum()),
        room=int((steps & ~facet).sum()),
        rim=int(rim.sum()),
        critical=int((slopes & ~rim).sum()),
        unexplained=int((~explained).sum()),
        moved=float((moved > DECIDED).mean()),
        mean=float(difference.mean()),
        sigma=float(np.sqrt((difference.mean(axis=-1)[decided] ** 2).sum()) / decided.size),
    )


def is_step(values: Array) -> NDArray[np.bool_]:
    """(N,) of (K, N, 3) values: whether those of a pixel lie at two levels, in the channel that varies most."""
    channel = (values.max(axis=0) - values.min(axis=0)).argmax(axis=-1)
    ordered = np.sort(np.take_along_axis(values, channel[None, :, None], axis=2)[..., 0], axis=0)
    step: NDArray[np.bool_] = np.diff(ordered, axis=0).max(axis=0) > STEP * (ordered[-1] - ordered[0])
    return step


def _spread(values: Array) -> Array:
    spread: Array = (values.max(axis=0) - values.min(axis=0)).max(axis=-1)
    return spread


def _radiance(renderer: Renderer, scene: Scene, size: tuple[int, int]) -> Array:
    picture = renderer.picture(Stage.of(scene), *size, effort=None)  # light maps are of single precision in all
    picture.refine()
    return picture.linear().astype(np.float64)


def _perturbed(scene: Scene, random: np.random.Generator, most: float) -> SceneSettings:
    """Stone and camera, each moved along and turned about each axis by up to `most`."""
    shift, turn, step, glance = random.uniform(-most, most, (4, 3))
    stone, camera = scene.stones[0], scene.camera
    w, vector = stone.orientation[0], np.array(stone.orientation[1:])
    turned = np.array([w - turn @ vector / 2, *(vector + (w * turn + np.cross(turn, vector)) / 2)])
    stone = stone.model_copy(
        update={
            "orientation": tuple(turned / np.linalg.norm(turned)),
            "position": tuple(np.array(stone.position) + shift),
        }
    )
    eye, target = np.array(camera.position), np.array(camera.target)
    target = target + step + np.linalg.norm(target - eye) * glance
    camera = camera.model_copy(update={"position": tuple(eye + step), "target": tuple(target)})
    return {"stones": (stone,), "camera": camera}


def _alone(scene: Scene) -> Scene:
    nothing = Plane(kind="none")
    sky = GradientEnvironment(kind="gradient")
    return scene.model_copy(update={"floor": nothing, "walls": nothing, "emitters": (), "environment": sky})


def _softened(scene: Scene) -> Scene:
    emitters = tuple(
        emitter if isinstance(emitter, PointLight) else emitter.model_copy(update={"softness": 1.0})
        for emitter in scene.emitters
    )
    return scene.model_copy(update={"emitters": emitters})


def table(single: Renderer, double: Renderer) -> Iterator[str]:
    """Lines of Markdown."""
    yield "| scene | pixels | facet | room | rim | critical | unexplained | moved | mean difference | its sigma |"
    yield "|---|" + "---|" * 9
    for name, settings in SCENES.items():
        v = judge(single, double, legacy(settings), perturbation=FARTHER.get(name, PERTURBATION))
        yield (
            f"| {name} | {v.decided} ({v.decided / v.pixels:.3%}) | {v.facet} | {v.room} | {v.rim} | {v.critical} "
            f"| {v.unexplained} | {v.moved:.1%} | {v.mean:+.1e} | {v.sigma:.1e} |"
        ).replace("%", " %")


if __name__ == "__main__":
    for line in table(Renderer(), Renderer(real=np.float64)):
        print(line, flush=True)

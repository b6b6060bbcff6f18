"""Polarised light, against closed forms and against a tracer of electric fields."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.renderer import Renderer
from culet.scene import Scene, StoneSettings
from culet.scene.legacy import legacy
from optics.closed_forms import DIAMOND
from rendering import ray_fields
from rendering.views import BARE, UPRIGHT, Array, radiance, take
from shared.stones import skew_block, slab

FINE = {"cutoff": 1e-9, "max_bounces": 65536}


def ray_scene(eye: Array, direction: Array, eta: float, sky: dict[str, object], **optics: object) -> Scene:
    """One pixel that sees along a ray."""
    return legacy(
        {
            **BARE,
            "stones": [{**UPRIGHT, "material": {"ior": [eta] * 3}}],
            "environment": sky,
            "camera": {
                "position": eye.tolist(),
                "target": (eye + direction).tolist(),
                "up": [0.3, 0.2, 0.9],
                "fov_degrees": 1e-3,
            },
            "optics": {**FINE, **optics},
        }
    )


@pytest.mark.parametrize(
    ("degrees", "polarised", "averaged"), [(0, 0.7064, 0.7064), (60, 0.6949, 0.6511), (75, 0.5808, 0.5032)]
)
def test_a_diamond_plate_passes_each_polarisation_by_itself(
    renderer: Renderer, exact: Renderer, degrees: float, polarised: float, averaged: float
) -> None:
    """T = mean over s and p of (1 - R)/(1 + R); with R averaged at each facet first, it is less."""
    stone, angle = slab(0.01), math.radians(degrees)
    sine, cosine = math.sin(angle), math.cos(angle)
    inner = math.sqrt(1 - (sine / DIAMOND) ** 2)
    r_s = ((cosine - DIAMOND * inner) / (cosine + DIAMOND * inner)) ** 2
    r_p = ((DIAMOND * cosine - inner) / (DIAMOND * cosine + inner)) ** 2
    closed = [np.mean([(1 - r) / (1 + r) for r in (r_s, r_p)]), (1 - (r_s + r_p) / 2) / (1 + (r_s + r_p) / 2)]
    assert closed == pytest.approx([polarised, averaged], abs=6e-5)
    eye = 3 * np.array([0, cosine, sine])
    # All light from below the horizon: what the plate passes.
    sky: dict[str, object] = {"kind": "gradient", "bottom": [1, 1, 1], "top": [0, 0, 0]}
    for used, tolerance in ((renderer, 3e-6), (exact, 3e-9)):
        for mode, expected in zip((True, False), closed, strict=True):
            pixel = radiance(take(used, ray_scene(eye, -eye, DIAMOND, sky, polarised=mode), stone, (1, 1)))[0, 0]
            passed = (pixel - (1 - cosine) / 2) / cosine  # the sky is (1 -+ cosine) / 2 where light leaves
            assert passed == pytest.approx(expected, abs=tolerance)


def half(direction: Array) -> float:
    return float(direction[1] > 0)


def gradient(direction: Array) -> float:
    return float(1 + direction[1]) / 2


NEARBY = 1e-6
"""Radians by which rays differ that single precision may take for each other, after dozens of reflections."""


def passes_an_edge(
    exact: Renderer, stone: Shape, eye: Array, direction: Array, eta: float, sky: dict[str, object]
) -> bool:
    """Whether rays that are NEARBY show different things: single precision may then show either."""
    random = np.random.default_rng(0)
    ways = direction + random.normal(0, NEARBY, (8, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    scenes = [ray_scene(eye, way, eta, sky, polarised=False) for way in ways]
    return bool(np.ptp([radiance(take(exact, scene, stone, (1, 1)))[0, 0, 0] for scene in scenes]) > 1e-4)


@pytest.mark.parametrize(("eta", "sky"), [(1.5, half), (2.42, gradient)], ids=["1.5, half", "2.42, gradient"])
@pytest.mark.parametrize("stone", [shape_of(StoneSettings(), {}), skew_block()], ids=["brilliant", "skew block"])
def test_rays_see_what_their_electric_fields_say(
    renderer: Renderer, exact: Renderer, stone: Shape, eta: float, sky: Callable[[Array], float]
) -> None:
    """Dozens of skew reflections each, many of them total: a wrong rotation, sign or phase shows in the third digit."""
    random = np.random.default_rng(3)
    kind: dict[str, object] = {"kind": "half" if sky is half else "gradient"}
    double: list[float] = []
    single: list[float] = []
    effect: list[float] = []
    steady = 0
    for _ in range(16):
        eye = random.normal(size=3)
        eye *= 3 / np.linalg.norm(eye)
        direction = 0.25 * random.uniform(-1, 1, 3) - eye
        direction /= np.linalg.norm(direction)
        fields = {mode: ray_fields.seen(stone, eta, eye, direction, sky, averaged=not mode) for mode in (True, False)}
        effect.append(abs(fields[True] - fields[False]))
        edge = passes_an_edge(exact, stone, eye, direction, eta, kind)
        steady += not edge
        for mode, expected in fields.items():
            scene = ray_scene(eye, direction, eta, kind, polarised=mode)
            for used, errors in ((exact, double), *(() if edge else ((renderer, single),))):
                errors.append(abs(radiance(take(used, scene, stone, (1, 1)))[0, 0, 0] - expected))
    assert steady >= 14  # 15 at least
    assert max(effect) > 2e-3  # measured 0.0035 to 0.053: what polarisation changes
    assert max(double) < 2e-9  # measured 9.4e-10, the cut-off
    assert np.median(single) < 3e-7  # measured 8.7e-8
    assert max(single) < 1e-4  # measured 2.3e-5, next to the critical angle

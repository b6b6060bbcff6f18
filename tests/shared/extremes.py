"""Scenes and stones at the ends of what is allowed, for every claim that must hold there too.

Those of the table in docs/explanation/accuracy.md, with what counts as wrong in them, are
`culet.study.renderer.extremes`.
"""

from __future__ import annotations

from typing import Any

from rendering.views import UPRIGHT
from shared.stones import needle, prism, slab


def point(*position: float) -> dict[str, Any]:
    """A light without light."""
    return {"shape": "point", "position": list(position), "colour": [0, 0, 0]}


GLOW: dict[str, Any] = {"environment": {"kind": "constant"}, "emitters": []}
"""A sky of radiance 1 and unlit surfaces below 1: no pixel may be brighter."""


def looking(position: list[float], target: list[float], **camera: object) -> dict[str, Any]:
    return {"camera": {"position": position, "target": target, **camera}}


SCENES: dict[str, dict[str, Any]] = {
    "at the centre": {"stones": [UPRIGHT], **looking([0, 0, 0], [1, 0, 0], fov_degrees=170)},
    "on the table": {"stones": [UPRIGHT], **looking([0, 0.30, 0], [0, 5, 0.1], fov_degrees=170)},
    "on the axis of symmetry": {"stones": [UPRIGHT], **looking([0, 3, 0], [0, 0, 0], up=[0, 0, -1])},
    "in the plane of the girdle": {"stones": [UPRIGHT], **looking([3, 0.1, 0], [-3, 0.1, 0], fov_degrees=1)},
    "in the floor": {**looking([0, -1, 5], [0, -1, 0])},
    "along the floor": {**looking([0, -0.999999, 5], [0, -0.999999, 0])},
    "below the floor": {**looking([0, -3, 3], [0, 0, 0])},
    "behind a wall": {"walls": {"kind": "mirror"}, **looking([0, 0, -20], [0, 0, 0])},
    "between mirrors": {"walls": {"kind": "mirror"}, **looking([0, 0, 7], [0, -0.5, -8], fov_degrees=120)},
    "far away": {**looking([3e5, 8e5, 6e5], [0, 0.5, 0], fov_degrees=1e-3)},
    "stone far away": {"stones": [{"position": [1e8, 5, 1e8]}], **looking([1e8, 5, 1e8 + 4], [1e8, 5, 1e8])},
    "widest": {"camera": {"fov_degrees": 170}},
    "opaque": {"stones": [{"absorption": [1e6, 1e6, 1e6]}]},
    "as opaque as can be": {"stones": [{"absorption": [1e18, 0, 1e18]}]},
    "index 1": {"stones": [{"material": {"ior": [1, 1, 1]}}]},
    "index just above 1": {"stones": [{"material": {"ior": [1 + 1e-6, 1 + 1e-6, 1 + 1e-7]}}]},
    "index 10": {"stones": [{"material": {"ior": [10, 10, 10]}}]},
    "indices 1 and 10": {"stones": [{"material": {"ior": [1, 10, 1.0001]}}]},
    "finest": {"optics": {"cutoff": 1e-9, "max_bounces": 65536}},
    "coarsest": {"optics": {"cutoff": 0.999999, "max_bounces": 1}},
    "sunk in the floor": {"stones": [{"position": [0, -1, 0]}]},
    "in a wall": {"walls": {"kind": "mirror"}, "stones": [{"position": [0, 0, -8]}]},
    "light in the stone": {"floor": {"kind": "matte"}, "emitters": [point(0, 0.5, 0)]},
    "light in the camera": {"floor": {"kind": "matte"}, "emitters": [point(0, 2.4, 4.6)]},
}  # fmt: skip
"""Views, materials and settings."""

THIN_STONES = {"needle": needle(), "leaf": slab(1e-5), "splinter": prism(0.5), "blade": prism(179)}
"""A thousand times as long as wide, and more."""

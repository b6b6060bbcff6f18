"""Stones for comparisons: the default brilliant, a step cut, one that is not convex, and a skew block."""

from __future__ import annotations

import math

import numpy as np
import trimesh

from culet.geometry.half_spaces import stone_from_half_spaces
from culet.geometry.load import stone_of
from culet.geometry.mesh import stone_from_mesh
from culet.geometry.stone import Stone
from culet.scene import StoneSettings


def brilliant() -> Stone:
    """The default cut: 57 facets and a girdle."""
    return stone_of(StoneSettings(), {})


def step_cut() -> Stone:
    """An emerald cut of 3 : 2 with three steps above and below the girdle, and a culet.

    It has 54 facets, since the lowest step ends before the corners. Each step lies on the girdle's outline or inside
    it: (inset, height, degrees from horizontal) of its outer edge.
    """
    outline = [(0.0, 0.72), (math.pi / 2, 1.08), (math.atan2(1.08, 0.72), 1.16)]
    sides = {(azimuth, distance) for a, distance in outline for azimuth in (a, -a, math.pi - a, math.pi + a)}
    distinct = {round(azimuth % (2 * math.pi), 9): distance for azimuth, distance in sides}
    steps = [(0.0, 0.03, 46), (0.10, 0.13, 38), (0.20, 0.21, 29)]
    steps += [(0.0, -0.03, -56), (0.22, -0.35, -45), (0.42, -0.55, -36)]
    planes = [[0, 1, 0, 0.27], [0, -1, 0, 0.73]]
    for azimuth, distance in distinct.items():
        across = (math.cos(azimuth), math.sin(azimuth))
        planes.append([across[0], 0, across[1], distance])
        for inset, height, degrees in steps:
            tilt = math.radians(degrees)
            sine, up = abs(math.sin(tilt)), math.copysign(math.cos(tilt), degrees)
            planes.append([across[0] * sine, up, across[1] * sine, (distance - inset) * sine + height * up])
    return stone_from_half_spaces("step cut", np.array(planes))


def ring() -> Stone:
    """A faceted torus, which is not convex: light that has left it may meet it again."""
    torus = trimesh.creation.torus(major_radius=0.66, minor_radius=0.34, major_sections=14, minor_sections=9)
    turn = np.array([[0.36, -0.48, 0.8], [0.8, 0.6, 0], [-0.48, 0.64, 0.6], [0, 0, 0]])
    turned = torus.apply_transform(np.column_stack([turn, [0, 0, 0, 1]]))
    return stone_from_mesh(turned.export(file_type="obj").encode(), "obj", name="ring")


def skew_block() -> Stone:
    """Six faces, no two of them parallel or at right angles: each reflection turns the plane of incidence."""
    planes = [
        [1, 0.2, 0.1, 0.6], [-1, 0.15, 0.25, 0.6], [0.15, 1, -0.2, 0.5],
        [0.25, -1, -0.3, 0.5], [-0.2, 0.1, 1, 0.6], [0.1, 0.3, -1, 0.6],
    ]  # fmt: skip
    return stone_from_half_spaces("skew block", np.array(planes))

"""The stones that tests of all parts try things on: cuts, prisms, what is not convex, what is thin, what is rough.

Those of the simulation, which do not lean on culet's own geometry, are in `trimesh_stones.py`; solids as polygons, and
files of them, in `geometry/shapes.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.scene import StoneSettings
from culet.study.solids import ball, box, tetrahedron
from geometry.shapes import obj, star_outline
from geometry.shapes import prism as extruded

__all__ = [
    "ball", "box", "brilliant", "needle", "prism", "ring", "skew_block", "slab", "star", "step_cut", "tetrahedron",
    "thorns",
]  # fmt: skip


def brilliant() -> Shape:
    """The default cut: 57 facets and a girdle."""
    return shape_of(StoneSettings(), {})


def step_cut() -> Shape:
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
    return shape_from_half_spaces("step cut", np.array(planes))


def ring() -> Shape:
    """A faceted torus, which is not convex: light that has left it may meet it again."""
    torus = trimesh.creation.torus(major_radius=0.66, minor_radius=0.34, major_sections=14, minor_sections=9)
    turn = np.array([[0.36, -0.48, 0.8], [0.8, 0.6, 0], [-0.48, 0.64, 0.6], [0, 0, 0]])
    turned = torus.apply_transform(np.column_stack([turn, [0, 0, 0, 1]]))
    return shape_from_mesh(turned.export(file_type="obj").encode(), "obj", name="ring")


def skew_block() -> Shape:
    """Six faces, no two of them parallel or at right angles: each reflection turns the plane of incidence."""
    planes = [
        [1, 0.2, 0.1, 0.6], [-1, 0.15, 0.25, 0.6], [0.15, 1, -0.2, 0.5],
        [0.25, -1, -0.3, 0.5], [-0.2, 0.1, 1, 0.6], [0.1, 0.3, -1, 0.6],
    ]  # fmt: skip
    return shape_from_half_spaces("skew block", np.array(planes))


def slab(half_height: float) -> Shape:
    """A plate between y = -half_height and half_height, of square outline; its corners are at distance 1."""
    half_width = math.sqrt((1 - half_height**2) / 2)
    planes = [
        [*(sign * np.eye(3)[axis]), extent]
        for axis, extent in enumerate((half_width, half_height, half_width))
        for sign in (1, -1)
    ]
    return shape_from_half_spaces("slab", np.array(planes))


def prism(apex_degrees: float) -> Shape:
    """A prism along z with its apex up: facet 0 faces -x, facet 1 faces +x, both half the apex angle from vertical."""
    half = math.radians(apex_degrees) / 2
    left, right = [-math.cos(half), math.sin(half), 0, 0], [math.cos(half), math.sin(half), 0, 0]
    return shape_from_half_spaces("prism", np.array([left, right, [0, -1, 0, 1], [0, 0, 1, 1], [0, 0, -1, 1.0]]))


def needle() -> Shape:
    """A thousand times as long as it is wide."""
    sides = [[x, y, 0, 0.001] for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    return shape_from_half_spaces("needle", np.array([*sides, [0, 0, 1, 1], [0, 0, -1, 1.0]]))


def star() -> Shape:
    """Ten dents and points between two flat faces."""
    return shape_from_mesh(obj(*extruded(star_outline(), 0.8)), "obj", name="star")


def thorns(seed: int) -> Callable[[], Shape]:
    """300 random directions, at random distances from the centre: skinny triangles, sharp peaks and dents."""

    def make() -> Shape:
        random = np.random.default_rng(seed)
        directions = random.normal(size=(300, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        triangles = ConvexHull(directions).simplices
        a, b, c = directions[triangles].transpose(1, 0, 2)
        inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
        triangles[inward] = triangles[inward][:, ::-1]
        return shape_from_mesh(obj(directions * random.uniform(0.3, 1, (300, 1)), triangles), "obj", name="thorns")

    return make

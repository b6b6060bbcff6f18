"""How far two stones are apart or overlap, against the Minkowski difference by Qhull; the hulls that they touch by."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from culet.geometry.shape import Shape
from culet.simulation.bodies import Body
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.solver.polyhedron import SolverHull, polyhedron_of
from culet.study.contacts.worlds import corners, triple, turned
from culet.study.solids import ball, box, brilliant, tetrahedron
from simulation.worlds import world

SHAPES = {
    "brilliant": brilliant,
    "tetrahedron": tetrahedron,
    "needle": box(1, 0.01, 0.01),
    "wafer": box(1, 0.01, 1),
    "ball": ball(40),
}


@pytest.mark.parametrize("one", SHAPES)
def test_the_distance_is_that_of_the_minkowski_difference(one: str) -> None:
    """Its facets are all axes that can separate; the origin's signed distance from the nearest is what is asked for."""
    rng = np.random.default_rng(7)
    first, shapes = SHAPES[one](), [make() for make in SHAPES.values()]
    overlaps = 0
    for k, second in enumerate(shapes * 2):
        way = triple(rng.normal(size=3) * 0.4 * (1 + k % 2))
        bodies = [Body("one", first, (0.0, 0.0, 0.0), turned(rng)), Body("other", second, way, turned(rng), scale=0.7)]
        moving = world(bodies, ())
        a, b = (corners(body, state) for body, state in zip(bodies, moving.state.bodies, strict=True))
        difference = (b[:, None] - a[None]).reshape(-1, 3)
        expected = float(ConvexHull(difference).equations[:, 3].max())
        assert moving.separation("one", "other") == pytest.approx(expected, abs=1e-12)  # measured 2e-15
        overlaps += expected < 0
    assert overlaps >= 2


@pytest.mark.parametrize("name", SHAPES)
def test_a_hull_is_closed_and_holds_all_corners(name: str) -> None:
    shape = SHAPES[name]()
    hull = polyhedron_of(shape)
    assert len(hull.vertices) - len(hull.edges) + len(hull.planes) == 2  # Euler
    assert (shape.vertices @ hull.planes[:, :3].T - hull.planes[:, 3]).max() < 1e-12
    for face, (begin, end) in enumerate(itertools.pairwise(hull.first.tolist())):
        loop = hull.vertices[hull.corners[begin:end]]
        assert abs(loop @ hull.planes[face, :3] - hull.planes[face, 3]).max() < 2e-6  # as flat as a facet is
        turning = np.cross(np.roll(loop, -1, axis=0) - loop, np.roll(loop, -2, axis=0) - np.roll(loop, -1, axis=0))
        assert (turning @ hull.planes[face, :3] > -1e-9).all()
    assert hull.thinned == 0


def test_a_hull_of_too_many_corners_keeps_the_farthest_and_says_how_much_is_missing() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(3000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = SolverHull.of(points, most=500)
    assert len(hull.vertices) == 500
    beyond = (points @ hull.planes[:, :3].T - hull.planes[:, 3]).max()
    assert hull.thinned == pytest.approx(beyond)
    assert 1e-4 < hull.thinned < 0.02  # measured 9e-3


def test_a_shape_that_is_not_convex_has_the_hull_of_its_corners(ring: Shape) -> None:
    hull = polyhedron_of(ring)
    assert float(np.ptp(hull.vertices[:, 0])) == pytest.approx(float(np.ptp(ring.vertices[:, 0])))
    moving = world([Body("one", ring, (0.0, 0.0, 0.0), IDENTITY), Body("other", ring, (0.0, 0.0, 0.0), IDENTITY)], ())
    assert moving.separation("one", "other") < -0.5

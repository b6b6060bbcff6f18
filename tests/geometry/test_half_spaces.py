"""Stones from half-spaces: from 4 facets to 5000, as round as a ball and as thin as a needle."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.polygons import edges_of_facets

CUBE = np.array([(*s * axis, 1.0) for s in (1, -1) for axis in np.eye(3)])


def random_planes(count: int, stretch: tuple[float, float, float]) -> NDArray[np.float64]:
    """Tangents of a ball, the ball stretched along turned axes."""
    random = np.random.default_rng(1)
    normals = random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    if count == 4:
        normals = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / np.sqrt(3)
    turned = np.linalg.qr(random.normal(size=(3, 3)))[0]
    return np.column_stack([(normals / stretch) @ turned.T, np.ones(count)])


@pytest.mark.parametrize("stretch", [(1, 1, 1), (1, 1, 1000), (1000, 1000, 1)], ids=["ball", "needle", "wafer"])
@pytest.mark.parametrize("count", [4, 50, 5000])
def test_simple_polyhedra_have_2f_minus_4_corners(count: int, stretch: tuple[float, float, float]) -> None:
    """Three facets meet at every corner of a random one, so V = 2F - 4 and E = 3F - 6 (Euler)."""
    stone = shape_from_half_spaces("random", random_planes(count, stretch))
    assert len(stone.planes) == count
    assert len(stone.vertices) == 2 * count - 4
    assert len(edges_of_facets(stone)) == 3 * count - 6
    assert np.linalg.norm(stone.vertices, axis=1).max() == pytest.approx(1, abs=1e-15)
    height = stone.vertices @ stone.planes[:, :3].T - stone.planes[:, 3]
    assert height.max() < 1e-11  # measured 7.3e-13, the wafer of 5000
    assert (height.max(axis=0) > -1e-11).all()  # every plane is touched


@pytest.mark.parametrize("size", [1e-12, 1e12])
def test_small_and_large_numbers_give_the_same_stone(size: float) -> None:
    planes = random_planes(50, (1, 1, 1000))
    wanted = shape_from_half_spaces("one", planes)
    found = shape_from_half_spaces("other", planes * [1, 1, 1, size])
    assert found.vertices == pytest.approx(wanted.vertices, abs=1e-11)


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_size_and_place_do_not_matter(size: float) -> None:
    planes = CUBE.copy()
    planes[:, 3] += planes[:, :3] @ [5, -7, 11]
    planes[:, 3] *= size
    stone = shape_from_half_spaces("cube", planes)
    assert abs(stone.vertices) == pytest.approx(np.full((8, 3), 3**-0.5), rel=1e-12, abs=0)
    # a cube of sides s = 2 / sqrt 3 has moments (s^2 + s^2) / 12
    assert stone.mass.volume == pytest.approx(8 * 3**-1.5, rel=1e-12, abs=0)
    assert np.diag(stone.mass.inertia) == pytest.approx(np.full(3, 2 / 9), rel=1e-12, abs=0)


def test_normals_may_have_any_length() -> None:
    scale = np.array([1, 20, 0.3, 4, 5, 6])[:, None]
    assert shape_from_half_spaces("cube", CUBE * scale).planes == pytest.approx(
        shape_from_half_spaces("cube", CUBE).planes
    )


def test_planes_that_bound_nothing_are_left_out_and_said() -> None:
    outside = np.array([(1, 1, 1, 9.0)])
    stone = shape_from_half_spaces("cube", np.vstack([CUBE, CUBE[:1], outside]))
    assert len(stone.planes) == 6
    assert stone.findings == ("2 half-spaces bound nothing and were left out.",)


@pytest.mark.parametrize(
    ("planes", "message"),
    [
        (CUBE[:3], "expected 4 to 100000 half-spaces"),
        (CUBE[:, :3], "expected 4 to 100000 half-spaces"),
        (np.where(CUBE == 1, np.nan, CUBE), "expected finite numbers, got 9 that are not"),
        (np.vstack([CUBE, [(0, 0, 0, 1)]]), "half-space 6 has a normal of length 0"),
        (np.vstack([CUBE, [(1, 0, 0, -2)]]), "no point lies inside all half-spaces"),
        (np.vstack([CUBE, [(1, 0, 0, -1)]]), "no point lies inside all half-spaces"),
        (CUBE[[0, 1, 3, 4]], "open to infinity"),
        (CUBE[[0, 1, 2, 3, 4]], "open to infinity"),
    ],
)
def test_what_is_no_stone_is_refused(planes: NDArray[np.float64], message: str) -> None:
    with pytest.raises(MeshError, match=message):
        shape_from_half_spaces("stone", planes)


def test_edges_run_counter_clockwise_about_their_first_facet() -> None:
    stone = shape_from_half_spaces("random", random_planes(50, (1, 1, 1)))
    for v0, v1, a, b in edges_of_facets(stone).tolist():
        along = stone.vertices[v1] - stone.vertices[v0]
        inward = np.cross(stone.planes[a, :3], along)  # into facet a, away from facet b
        assert inward @ stone.planes[b, :3] < 0
        for facet in (a, b):
            for corner in (v0, v1):
                assert abs(stone.vertices[corner] @ stone.planes[facet, :3] - stone.planes[facet, 3]) < 1e-12

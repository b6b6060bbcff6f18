"""Tensors against closed forms, Steiner's theorem and trimesh's integral."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from culet.geometry.shape import Shape
from culet.simulation.rigid_body.inertia import cone_apex_inertia, cone_inertia, inertia_tensor


def test_the_cone_about_its_centre_of_mass_is_trimeshs() -> None:
    cone = trimesh.creation.cone(radius=1.0, height=2.0, sections=2048)  # its axis is z
    x, y, z = np.diag(cone.moment_inertia / cone.volume)
    # measured 1.6e-6: what 2048 sides lack of a circle
    assert np.diag(cone_inertia(1, 2)) == pytest.approx([x, z, y], rel=1e-5)


def test_the_reports_cone_has_three_equal_moments() -> None:
    assert np.diag(cone_inertia()) == pytest.approx([0.3, 0.3, 0.3], rel=1e-15, abs=0)  # 3/80 (4 + 4) and 3/10


def test_formula_1_of_the_report_is_the_cone_about_its_apex() -> None:
    for radius, height in ((1.0, 2.0), (0.7, 1.3)):
        to_apex = 3 / 4 * height
        steiner = cone_inertia(radius, height) + np.diag([to_apex**2, 0, to_apex**2])
        assert cone_apex_inertia(radius, height) == pytest.approx(steiner, rel=1e-15, abs=0)
    assert np.diag(cone_apex_inertia()) == pytest.approx([51 / 20, 3 / 10, 51 / 20], rel=1e-15, abs=0)


def test_about_the_apex_the_order_of_the_moments_is_a_brilliants_reversed(double_cone: Shape) -> None:
    across, axis, _ = np.diag(inertia_tensor("polyhedron", double_cone))
    assert axis > 1.3 * across  # measured 1.57
    across, axis, _ = np.diag(inertia_tensor("cone_apex", double_cone))
    assert across > 8 * axis


def test_the_polyhedrons_tensor_is_the_boxs_closed_form(box: Shape) -> None:
    a, b, c = 6 / 7, 3 / 7, 2 / 7
    closed = np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) / 3
    assert inertia_tensor("polyhedron", box) == pytest.approx(closed, abs=1e-15)


def test_the_polyhedrons_tensor_is_trimeshs(double_cone: Shape) -> None:
    mesh = trimesh.Trimesh(double_cone.vertices, double_cone.triangles)
    assert inertia_tensor("polyhedron", double_cone) == pytest.approx(mesh.moment_inertia / mesh.volume, abs=1e-14)


def test_the_cones_do_not_look_at_the_stone(box: Shape, ring: Shape) -> None:
    assert (inertia_tensor("cone", box) == inertia_tensor("cone", ring)).all()
    assert (inertia_tensor("cone", box) == cone_inertia()).all()
    assert (inertia_tensor("cone_apex", box) == cone_apex_inertia()).all()

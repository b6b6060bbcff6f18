"""Mass properties against closed forms, and against trimesh."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from culet.geometry.brilliant import brilliant
from culet.geometry.mass import solid_integrals, surface_area
from culet.scene.cuts import BrilliantCut
from geometry.shapes import cube, fans, prism, star_outline


def test_a_box_has_the_textbook_tensor() -> None:
    """I_xx = (b^2 + c^2) / 12 for sides a, b, c."""
    corners, faces = cube()
    sides = np.array([1.0, 2.0, 5.0])
    answer = solid_integrals(corners * sides / 2 + [3, -4, 1], fans(faces))
    assert answer.volume == pytest.approx(10, rel=1e-12, abs=0)
    assert answer.centre == pytest.approx([3, -4, 1], rel=1e-12, abs=0)
    assert np.diag(answer.inertia) == pytest.approx([(4 + 25) / 12, (1 + 25) / 12, (1 + 4) / 12], rel=1e-12, abs=0)
    assert abs(answer.inertia - np.diag(np.diag(answer.inertia))).max() < 1e-14


def test_a_right_tetrahedron_has_the_textbook_tensor() -> None:
    """Legs 1 on the axes: V = 1/6, centre (1/4, 1/4, 1/4), about it I_xx = 3/40, I_xy = 1/80 per mass (Tonon)."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float64)
    answer = solid_integrals(corners, np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]))
    assert answer.volume == pytest.approx(1 / 6, rel=1e-12, abs=0)
    assert answer.centre == pytest.approx([0.25, 0.25, 0.25], rel=1e-12, abs=0)
    assert answer.inertia == pytest.approx(np.full((3, 3), 1 / 80) + np.eye(3) * (3 / 40 - 1 / 80), rel=1e-12, abs=0)


def test_a_pyramid_of_many_sides_has_its_closed_form() -> None:
    """On a regular n-gon of circumradius 1: area A = n/2 sin(2 pi/n), per mass I_axis = (2 + cos(2 pi/n)) / 10 and
    I_across = I_axis / 2 + 3 h^2 / 80; the cone is the limit 3/10 and 3/20 + 3 h^2 / 80."""
    n, height = 64, 2.0
    angle = 2 * math.pi * np.arange(n) / n
    corners = np.vstack([np.column_stack([np.cos(angle), np.zeros(n), -np.sin(angle)]), [(0, height, 0), (0, 0, 0)]])
    ring = [(k, (k + 1) % n) for k in range(n)]
    faces = np.array([(a, b, n) for a, b in ring] + [(b, a, n + 1) for a, b in ring])
    answer = solid_integrals(corners, faces)
    axis = (2 + math.cos(2 * math.pi / n)) / 10
    assert answer.volume == pytest.approx(n / 2 * math.sin(2 * math.pi / n) * height / 3, rel=1e-12, abs=0)
    assert answer.centre == pytest.approx([0, height / 4, 0], abs=1e-12)
    assert np.diag(answer.inertia) == pytest.approx(
        [axis / 2 + 3 * height**2 / 80, axis, axis / 2 + 3 * height**2 / 80], rel=1e-12
    )


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_trimesh_agrees_on_stones(offset: float) -> None:
    for corners, faces in (prism(star_outline(), 0.6), cube()):
        mesh = trimesh.Trimesh(corners, fans(faces), process=False)
        ours = solid_integrals(corners + offset, fans(faces))
        assert ours.volume == pytest.approx(mesh.volume, rel=1e-12, abs=0)
        assert ours.inertia == pytest.approx(np.asarray(mesh.moment_inertia) / mesh.volume, rel=1e-10, abs=1e-11)
    stone = brilliant(BrilliantCut())
    mesh = trimesh.Trimesh(stone.vertices, stone.triangles, process=False)
    assert stone.mass.volume == pytest.approx(mesh.volume, rel=1e-12, abs=0)
    assert stone.mass.inertia == pytest.approx(np.asarray(mesh.moment_inertia) / mesh.volume, rel=1e-12, abs=1e-13)
    assert np.asarray(mesh.center_mass) == pytest.approx([0, 0, 0], abs=1e-13)


def test_an_inside_out_surface_has_a_negative_volume() -> None:
    corners, faces = cube()
    assert solid_integrals(corners, fans(faces)[:, ::-1]).volume == pytest.approx(-8, rel=1e-12, abs=0)


def test_a_sheet_has_no_volume_and_no_tensor() -> None:
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float64)
    answer = solid_integrals(corners, np.array([(0, 1, 2), (0, 2, 1)]))
    assert answer.volume == 0
    assert not answer.inertia.any()
    assert surface_area(corners, np.array([(0, 1, 2), (0, 2, 1)])) == pytest.approx(1, rel=1e-15, abs=0)

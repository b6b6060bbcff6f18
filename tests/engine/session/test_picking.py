"""Which stone a line of sight strikes, and where: against the facets, and by planes against by triangles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from culet.engine.session.picking import Placed, corners, placed, struck
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.scene import Camera, Scene, StoneSettings, Vector
from culet.simulation.rigid_body.rotation import rotate
from culet.stage import Stage

STONE = shape_of(StoneSettings(), {})
HOLLOW = replace(STONE, convex=False)
"""The same solid, whose triangles are looked at, and not its planes."""
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
AHEAD = Camera(position=(0, 0, 5), target=(0, 0, 0), fov_degrees=90)
"""At distance 5 half the picture's height is 5 R."""
PARALLEL = Camera(position=(0, 0, 5), target=(0, 0, 0), kind="orthographic", height=10)


def at(position: Vector, name: str = "stone", scale: float = 1.0) -> Placed:
    return Placed(name, STONE, scale, position, UPRIGHT)


def hollow(stone: Placed) -> Placed:
    return stone._replace(shape=HOLLOW)


def test_a_line_of_sight_strikes_the_facet_in_front() -> None:
    met = struck(AHEAD, [at((0, 0, 0))], 0.02, 0.01)
    assert met is not None
    point = met.point
    slopes = [point[0] / (5 - point[2]), point[1] / (5 - point[2])]
    assert slopes == pytest.approx([0.02, 0.01], rel=1e-12)
    distances = STONE.planes[:, :3] @ np.array(point) - STONE.planes[:, 3]
    assert distances.max() == pytest.approx(0, abs=1e-12)
    assert point[2] > 0.5  # the near side


@pytest.mark.parametrize("where", [(0.3, 0.0), (0.0, 0.5), (-2.0, 0.0)])
def test_a_line_of_sight_past_the_stone_strikes_nothing(where: tuple[float, float]) -> None:
    assert struck(AHEAD, [at((0, 0, 0)), hollow(at((0, 0, 0)))], *where) is None


def test_a_stone_behind_the_camera_or_about_it_is_not_struck() -> None:
    for position in ((0, 0, 9), (0, 0, 5)):
        assert struck(AHEAD, [at(position), hollow(at(position))], 0, 0) is None


def test_of_several_stones_the_first_along_the_line_is_struck_in_whatever_order_they_are() -> None:
    near, far, beside = at((0, 0, 2), "near"), at((0, 0, -2), "far"), at((4, 0, 0), "beside")
    for stones in ([near, far, beside], [beside, far, near]):
        met = struck(AHEAD, stones, 0, 0)
        assert met is not None
        assert met.name == "near"
    met = struck(AHEAD, [near, far, beside], 0.8, 0)
    assert met is not None
    assert met.name == "beside"


def test_a_line_may_pass_within_the_ball_about_a_stone_and_strike_the_one_behind() -> None:
    """A rod that points at the camera is a tenth as wide as it is long: at 0.16 R the line is in its ball alone."""
    sides = np.concatenate([np.eye(3), -np.eye(3)])
    rod = shape_from_half_spaces("rod", np.column_stack([sides, [0.1, 0.1, 1, 0.1, 0.1, 1]]))
    stones = [Placed("rod", rod, 1.0, (0, 0, 2), UPRIGHT), at((0, 0, -2), "behind")]
    for x, name in ((0.05 / 5, "rod"), (0.16 / 5, "behind")):
        met = struck(PARALLEL, stones, x, 0)
        assert met is not None
        assert met.name == name


def test_a_stone_of_another_size_is_struck_where_its_own_surface_is() -> None:
    small, large = (struck(AHEAD, [at((0, 0, 0), scale=scale)], 0, 0) for scale in (1.0, 2.0))
    assert small is not None
    assert large is not None
    assert large.point[2] == pytest.approx(2 * small.point[2], rel=1e-12)
    assert struck(AHEAD, [at((0, 0, 0), scale=2)], 0.3, 0) is not None, "which passes by a stone of scale 1"


def test_of_a_stone_that_reaches_behind_the_camera_the_part_in_front_is_struck() -> None:
    """Two brilliants a third as large, before and behind the camera, as one shape that is not convex."""
    before, behind = 0.3 * STONE.vertices - (0, 0, 0.7), 0.3 * STONE.vertices + (0, 0, 0.7)
    pair = replace(
        HOLLOW,
        vertices=np.concatenate([before, behind]),
        triangles=np.concatenate([STONE.triangles, STONE.triangles + len(before)]),
    )
    camera = Camera(position=(0, 0, 0), target=(0, 0, -1))
    met = struck(camera, [Placed("pair", pair, 1.0, (0, 0, 0), UPRIGHT)], 0, 0)
    assert met is not None
    assert -0.7 < met.point[2] < -0.4


def test_planes_and_triangles_of_one_solid_are_struck_alike() -> None:
    """Two ways that have nothing in common but the line; measured 3e-15."""
    random, struck_at_all = np.random.default_rng(7), 0
    for _ in range(400):
        orientation = random.normal(size=4)
        a, b, c, d = (orientation / np.linalg.norm(orientation)).tolist()
        x, y, z = random.normal(size=3).tolist()
        stone = Placed("stone", STONE, float(random.uniform(0.2, 3)), (x, y, z), (a, b, c, d))
        eye_x, eye_y, eye_z = (8 * random.normal(size=3)).tolist()
        for kind in ("pinhole", "orthographic"):
            camera = Camera.model_validate(
                {"position": (eye_x, eye_y, eye_z), "target": (0, 0, 0), "kind": kind, "fov_degrees": 30, "height": 6}
            )
            place = random.uniform(-0.6, 0.6, 2).tolist()
            by_planes, by_triangles = struck(camera, [stone], *place), struck(camera, [hollow(stone)], *place)
            assert (by_planes is None) == (by_triangles is None)
            if by_planes is not None and by_triangles is not None:
                struck_at_all += 1
                assert math.dist(by_planes.point, by_triangles.point) < 1e-9
    assert struck_at_all > 100


def test_corners_are_turned_enlarged_and_moved_as_their_stone() -> None:
    orientation = (0.5, -0.5, 0.5, 0.5)
    found = corners(Placed("stone", STONE, 2.5, (1.0, -2.0, 3.0), orientation))
    assert len(found) == len(STONE.vertices)
    for corner, vertex in zip(found.tolist(), STONE.vertices.tolist(), strict=True):
        x, y, z = rotate(orientation, (vertex[0], vertex[1], vertex[2]))
        assert corner == pytest.approx([1 + 2.5 * x, -2 + 2.5 * y, 3 + 2.5 * z], abs=1e-12)


def test_the_stones_of_a_stage_are_placed_as_its_scene_has_them() -> None:
    scene = Scene.read({"stones": [{"id": "a", "position": [0, 1, 0]}, {"id": "b", "scale": 2, "position": [5, 1, 0]}]})
    first, second = placed(Stage.of(scene))
    assert (first.name, first.scale, first.position) == ("a", 1, (0, 1, 0))
    assert (second.name, second.scale, second.position) == ("b", 2, (5, 1, 0))
    assert first.shape is not None


def test_nothing_is_struck_where_there_is_nothing() -> None:
    assert struck(AHEAD, [], 0, 0) is None

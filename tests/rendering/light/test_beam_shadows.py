"""Shadows of stones: hard ones to their edge, soft ones as point by point, and the light that stones let into them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.rendering.emitters.ray import LightRay
from culet.rendering.light.beams import Beams
from culet.rendering.opencl.device import Device
from rendering.light.throwing import SLANTED, UPRIGHT, Array, lamp, sun, thrown
from shared.trimesh_stones import exact_box


@pytest.fixture(scope="module")
def beams(device: Device) -> Beams:
    return Beams(device)


def only_shadow(ray: LightRay) -> LightRay:
    return LightRay(ray.colour, ray.towards, ray.position, follows=False)


def hidden(shape: Shape, points: Array, ways: Array) -> Array:
    """(N,) whether rays from points (N, 3) along ways (N, 3) meet a convex shape, which is upright at the origin."""
    speed, gap = ways @ shape.planes[:, :3].T, shape.planes[:, 3] - points @ shape.planes[:, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = gap / speed
    begins = np.where(speed < 0, crossing, -np.inf).max(axis=1)
    ends = np.where(speed > 0, crossing, np.inf).min(axis=1)
    return np.asarray((begins < ends) & (ends > 0))


def places(made_for: Array, rows: Array) -> Array:
    """(N, 3) of some texels of the floor."""
    u, v = np.meshgrid(made_for, rows)
    return np.column_stack([u.ravel(), np.full(u.size, -1.0), v.ravel()])


@pytest.mark.parametrize("ray", [sun(), lamp(), lamp((3, 0.2, 1))], ids=["parallel", "point", "low point"])
def test_a_hard_shadow_lies_where_rays_to_the_light_meet_the_stone(
    beams: Beams, brilliant: Shape, ray: LightRay
) -> None:
    made = thrown(beams, [only_shadow(ray)], stones=[UPRIGHT])
    columns, rows = made.frame.texels(0, 0)
    points = places(columns[::4], rows[::4])
    ways = np.tile(SLANTED, (len(points), 1)) if ray.position is None else np.array(ray.position) - points
    cosine = ways[:, 1] / np.linalg.norm(ways, axis=1)
    shade = made.map[0, 0, ::4, ::4, 1].ravel() / -cosine
    expected = hidden(brilliant, points, ways)
    clear = abs(shade - 0.5) > 0.499
    assert clear.mean() > 0.97
    assert (shade[clear] > 0.5).tolist() == expected[clear].tolist()
    assert 0.001 < expected.mean() < 0.4


PILE: list[tuple[tuple[float, float, float], float]] = [
    ((0, -0.2, 0), 0.7),
    ((0.9, -0.4, -0.3), 0.5),
    ((-0.1, 1.3, -0.2), 0.6),
    ((0.5, 0.5, 0.9), 0.4),
    ((-0.6, 0.6, 0.7), 0.3),
    ((-0.3, 2.2, 0.1), 0.35),
]
"""Places and sizes of upright stones, each in the way of another's light."""


@pytest.mark.parametrize("ray", [sun(), sun((0.03, 1, 0.01)), lamp()], ids=["parallel", "from above", "point"])
@pytest.mark.parametrize("turn", [1, -1], ids=["in order", "reversed"])
@pytest.mark.parametrize("kind", ["brilliant", "box"])
def test_what_several_stones_hide_is_dark_once(
    beams: Beams, brilliant: Shape, ray: LightRay, turn: int, kind: str
) -> None:
    shape = brilliant if kind == "brilliant" else exact_box()
    pile = PILE[::turn]
    stones = [{**UPRIGHT, "position": list(place), "scale": scale} for place, scale in pile]
    made = thrown(beams, [only_shadow(ray)], shape, stones=stones)
    columns, rows = made.frame.texels(0, 0)
    points = places(columns[::4], rows[::4])
    ways = np.tile(np.array(ray.towards), (len(points), 1)) if ray.towards else np.array(ray.position) - points
    shade = made.map[0, 0, ::4, ::4, 1].ravel() / (-ways[:, 1] / np.linalg.norm(ways, axis=1))
    alone = [hidden(shape, (points - place) / scale, ways) for place, scale in pile]
    assert np.sum(alone, axis=0).max() >= 2, "in each other's light"
    expected, clear = np.any(alone, axis=0), abs(shade - 0.5) > 0.499
    assert clear.mean() > 0.96
    assert (shade[clear] > 0.5).tolist() == expected[clear].tolist()
    assert abs(shade[clear & expected] - 1).max() < 1e-3


def disc(middle: Array, degrees: float, count: int) -> Array:
    """(count, 3) directions of an even disc, by equal solid angles."""
    u = (np.arange(count) + 0.5) * 0.7548776662466927 % 1 * (1 - math.cos(math.radians(degrees)))
    v = (np.arange(count) + 0.5) * 0.5698402909980532 % 1 * 2 * math.pi
    side = np.cross(middle, [0, 0, 1.0])
    side /= np.linalg.norm(side)
    s = np.sqrt(1 - (1 - u) ** 2)
    return np.asarray(
        (1 - u)[:, None] * middle
        + s[:, None] * (np.cos(v)[:, None] * side + np.sin(v)[:, None] * np.cross(middle, side))
    )


@pytest.mark.parametrize(("degrees", "most"), [(6, 0.006), (24, 0.010)])
def test_64_rays_make_a_lamps_soft_shadow(beams: Beams, brilliant: Shape, degrees: float, most: float) -> None:
    """RMSE in parts of the lamp's light; measured 0.003 and 0.006."""
    middle = np.array([0.25, 0.9, 0.9]) / np.linalg.norm([0.25, 0.9, 0.9])
    some, many = disc(middle, degrees, 64), disc(middle, degrees, 1024)
    made = thrown(beams, [only_shadow(sun(way, (1 / 64,) * 3)) for way in some], stones=[UPRIGHT])
    columns, rows = made.frame.texels(0, 0)
    points = places(columns[8::16], rows[8::16])
    taken = np.zeros(len(points))
    for way in many:
        taken += hidden(brilliant, points, np.tile(way, (len(points), 1))) * way[1] / len(many)
    blurred = made.map[0, 0, :, :, 1].reshape(32, 16, 32, 16)[:, 6:11, :, 6:11].mean((1, 3)).ravel()
    assert np.sqrt(((blurred + taken) ** 2).mean()) < most * taken.max()


def test_a_wide_lamp_shines_into_its_shadow_what_the_stone_lets_through(beams: Beams) -> None:
    """Of a box that faces the light, (1 - R) / (1 + R): all of it in the box's own shadow."""
    index = 1.8
    r = ((index - 1) / (index + 1)) ** 2
    stone = {**UPRIGHT, "material": {"ior": [index] * 3}}
    lamps = [
        LightRay((0.5, 1.0, 0.25), towards=(0.0, 1.0, 0.0), follows=False, gauges=number == 0, emitter=3)
        for number in range(2)
    ]
    made = thrown(beams, lamps, exact_box(), stones=[stone], cutoff=1e-6)
    through = (1 - r) / (1 + r)
    assert made.at(0.01, 0.01) == pytest.approx(-2 * (1 - through) * np.array([0.5, 1, 0.25]), abs=1e-5)


def test_a_coloured_stone_colours_the_light_in_its_shadow(beams: Beams) -> None:
    index, absorption = 1.8, np.array([0.1, 1, 3])
    side = 2 * np.abs(exact_box().vertices[:, 1]).max()
    stone = {**UPRIGHT, "material": {"ior": [index] * 3}, "absorption": absorption.tolist()}
    ray = LightRay((1.0, 1.0, 1.0), towards=(0.0, 1.0, 0.0), follows=False, gauges=True)
    made = thrown(beams, [ray], exact_box(), stones=[stone], cutoff=1e-6)
    r, left = ((index - 1) / (index + 1)) ** 2, np.exp(-absorption * side)
    through = (1 - r) ** 2 * left / (1 - (r * left) ** 2)
    assert made.at(0.01, 0.01) == pytest.approx(through - 1, abs=1e-5)

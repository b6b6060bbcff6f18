"""Light maps at the ends of what is allowed: finite, nothing lost, and nowhere darker than without light."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.rendering.emitters.ray import LightRay
from culet.rendering.light.beams import Beams
from culet.rendering.opencl.device import Device
from rendering.light.throwing import UPRIGHT, Array, Thrown, lamp, sun, thrown
from shared.stones import needle, prism, skew_block, slab
from shared.trimesh_stones import exact_box


@pytest.fixture(scope="module")
def beams(device: Device) -> Beams:
    return Beams(device)


def unshaded(made: Thrown, ray: LightRay, surface: int, level: int) -> Array:
    """(512, 512) the light of a white surface without stones."""
    normal = np.array([(0, 1, 0), (0, 0, 1), (np.sqrt(0.75), 0, 0.5), (-np.sqrt(0.75), 0, 0.5)][surface])
    if ray.towards is not None:
        return np.full((512, 512), max(0.0, float(normal @ ray.towards)))
    columns, rows = made.frame.texels(surface, level)
    u, v = np.meshgrid(columns, rows)
    if surface == 0:
        points = np.stack([u, np.full_like(u, -1), v], axis=-1)
    else:
        along = np.array([normal[2], 0, -normal[0]])
        points = -8 * normal + u[..., None] * along + v[..., None] * np.array([0, 1, 0])
    way = np.array(ray.position) - points
    return np.asarray(np.maximum(way @ normal / np.linalg.norm(way, axis=-1), 0))


def check(made: Thrown, ray: LightRay, lost: float = 2e-6) -> None:
    assert np.isfinite(made.map).all()
    assert abs(made.lost()) < lost
    for surface in made.frame.matte:
        for level in (0, 1):
            least = (made.map[surface, level].min(axis=-1) + unshaded(made, ray, surface, level)).min()
            assert least > -2e-3  # rounding of sums along 512 texels


LIGHTS = {
    "slanted": sun(),
    "overhead": sun((0, 1, 0)),
    "grazing": sun((1, 0.002, 0.3)),
    "from below": sun((0.3, -1, 0.2)),
    "along an edge": sun((1, 1, 0)),
    "point": lamp(),
    "point overhead": lamp((0, 8, 0)),
    "point at a vertex": lamp((0, 1, 0)),
    "point 1e-6 R from the stone": lamp((0.1, 0.5 + 1e-6, 0.05)),
    "point beside": lamp((2, 0, 0)),
    "point on the floor": lamp((2, -0.999, 1)),
    "point below the floor": lamp((1, -3, 1)),
    "point far": lamp((-4e5, 6e5, 4e5)),
}


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
@pytest.mark.parametrize("walls", ["none", "matte"])
def test_every_light_leaves_a_sound_map(beams: Beams, light: LightRay, walls: str) -> None:
    for index in (1.3, 10):
        made = thrown(
            beams, [light], exact_box(), stones=[{**UPRIGHT, "material": {"ior": [index] * 3}}],
            walls={"kind": walls},
        )  # fmt: skip
        check(made, light)


SHAPES = {
    "thin plate": slab(0.002),
    "needle": needle(),
    "sharp prism": prism(3),
    "skew block": skew_block(),
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_every_shape_leaves_a_sound_map(beams: Beams, shape: Shape) -> None:
    for light in (sun(), sun((0, 1, 0)), lamp((1, 2, 0.5))):
        for index in (1.0, 2.4):
            made = thrown(beams, [light], shape, stones=[{**UPRIGHT, "material": {"ior": [index] * 3}}])
            check(made, light)


@pytest.mark.parametrize("height", [-1.0, -1.3, -0.6, -5.0])
def test_a_stone_through_the_floor_keeps_its_light_above_it(beams: Beams, height: float) -> None:
    for light in (sun(), lamp()):
        made = thrown(beams, [light], stones=[{"position": [0, height, 0]}])
        check(made, light)
    if height == -5:
        assert made.tally.incident == 0


def test_a_light_inside_a_stone_shines_out_of_it(beams: Beams) -> None:
    """All around; of index 1 as if the stone were not there, but for what the width of the beams' parts leaves."""
    light = lamp((0.1, 0.1, 0.2))
    made = thrown(beams, [light], exact_box(), stones=[{**UPRIGHT, "material": {"ior": [1, 1, 1]}}], cutoff=1e-5)
    assert made.tally.incident == pytest.approx(4 * np.pi, rel=1e-3)
    assert np.sqrt((made.map[0, 0] ** 2).mean()) < 0.02  # measured 0.008
    assert made.tally.unresolved < 1e-5
    for absorption in (0, 1):
        stone = {**UPRIGHT, "material": {"ior": [1.5] * 3}, "absorption": [absorption] * 3}
        check(thrown(beams, [light], exact_box(), stones=[stone]), light)


def test_a_light_inside_a_stone_that_it_may_not_leave_lights_nothing(beams: Beams) -> None:
    light = LightRay((1, 1, 1), position=(0.1, 0.1, 0.2), follows=False)
    made = thrown(beams, [light], exact_box(), stones=[UPRIGHT])
    assert abs(made.map[0, 0, :, :, 0] + unshaded(made, light, 0, 0)).max() < 1e-6


def test_random_stones_in_random_places_lose_nothing(beams: Beams) -> None:
    """The default cut at every angle, of indices from 1 to 10."""
    chance = np.random.default_rng(5)
    for _ in range(30):
        stone = {
            "orientation": (chance.normal(size=4)).tolist(),
            "position": [0, float(chance.uniform(-1.5, 2)), 0],
            "material": {"ior": [float(chance.uniform(1, 10))] * 3},
        }
        towards = chance.normal(size=3)
        light = sun(towards) if chance.random() < 0.5 else lamp(tuple(towards * chance.uniform(3, 9)))
        check(thrown(beams, [light], stones=[stone]), light)


def test_stones_in_each_others_way_lose_nothing(beams: Beams) -> None:
    stones = [
        {"position": [0, 0.9, 0], "scale": 0.6},
        {"position": [0.5, -0.3, 0.2], "scale": 0.5, "material": "ruby"},
        {"position": [-0.7, -0.4, -0.3], "scale": 0.5, "orientation": [0.3, 0.5, 0.1, 0.8]},
        {"position": [0.2, 2.2, 0.1], "scale": 0.4},
    ]
    for light in (sun(), sun((0.1, 1, 0)), lamp()):
        made = thrown(beams, [light], stones=stones, cutoff=1e-3)
        check(made, light)
        assert made.tally.unresolved < 0.02 * made.tally.incident
        alone = [thrown(beams, [light], stones=[stone], cutoff=1e-3).tally.incident for stone in stones]
        assert made.tally.incident < 1.000001 * sum(alone)
    below = [sun((0.1, 1, 0))]
    apart = sum(thrown(beams, below, stones=[stone], cutoff=1e-3).tally.incident for stone in stones)
    assert thrown(beams, below, stones=stones).tally.incident < 0.9 * apart  # they stand in each other's light


def test_a_stone_whose_light_another_takes_goes_without(beams: Beams) -> None:
    """A small one right behind a large one of so high an index that hardly anything comes through."""
    stones: list[dict[str, Any]] = [
        {"position": [0, 1, 0], "material": {"ior": [10] * 3}},
        {"position": [0, -0.6, 0], "scale": 0.2},
    ]
    both = thrown(beams, [sun((0, 1, 0))], stones=stones)
    large = thrown(beams, [sun((0, 1, 0))], stones=stones[:1])
    assert both.tally.incident == pytest.approx(large.tally.incident, rel=1e-6)

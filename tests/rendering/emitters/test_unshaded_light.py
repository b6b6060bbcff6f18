"""The sky's light on floor and walls, against sums over directions drawn by chance and over even ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.optics.panoramas import STUDIO as PICTURES
from culet.optics.panoramas import Panorama, directions, panorama_of
from culet.rendering.emitters.lamp_field import lamp_field
from culet.rendering.emitters.open_sky import open_sky
from culet.rendering.emitters.panorama_light import panorama_light
from culet.rendering.emitters.unshaded import lamps_of, sky_light
from culet.rendering.room.surfaces import shown
from culet.scene import PRESETS, Scene
from culet.scene.legacy import LEGACY_DEFAULT, LEGACY_LAMPS, legacy
from culet.scene.sky import ImageEnvironment
from culet.stage import Stage
from rendering.room_reference import SURFACES, lamp_share, sky
from rendering.views import Array
from shared.stages import staged

MATTE = {"kind": "matte"}
EVEN = 300_000
"""Directions of the whole sphere, and in a cone about a lamp."""


def spiral(count: int, middle: Array, half_angle: float) -> tuple[Array, float]:
    """(count, 3) even directions of a cone (R. Swinbank and R. J. Purser, Fibonacci grids, 2006), and the solid angle
    of each."""
    lowest = np.cos(half_angle)
    height = 1 - (1 - lowest) * (np.arange(count) + 0.5) / count
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    level = np.sqrt(1 - height**2)
    first = np.cross(middle, (0.6, 0.1, 0.7))
    first /= np.linalg.norm(first)
    second = np.cross(middle, first)
    ways = height[:, None] * middle + level[:, None] * (np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second)
    return ways, 2 * np.pi * (1 - lowest) / count


def received(ways: Array, solid_angle: float, radiance: Array, surfaces: tuple[int, ...]) -> Array:
    """(4, 3) light on the surfaces that are there, of what is not behind any of them."""
    seen = (ways @ SURFACES[list(surfaces), :3].T > 0).all(axis=1)
    found = np.zeros((4, 3))
    for number in surfaces:
        cosine = np.maximum(ways @ SURFACES[number, :3], 0) * seen
        found[number] = cosine @ radiance * solid_angle / np.pi
    return found


LAMPS: dict[str, dict[str, Any]] = {
    **{f"round {lamp.half_angle_degrees:g}": lamp.model_dump() for lamp in LEGACY_LAMPS},
    "half set": {"shape": "round", "direction": [0.3, 0.02, 1], "half_angle_degrees": 20, "radiance": [1, 2, 3]},
    "half a sky": {"shape": "round", "direction": [0.3, 1, 1], "half_angle_degrees": 80, "radiance": [1, 2, 3]},
    "behind a wall, half": {"shape": "round", "direction": [1, 1, 1.9], "half_angle_degrees": 9, "radiance": [3, 2, 1]},
    "sun": {"shape": "sun", "direction": [0.2, 0.4, 1], "colour": [1, 0.9, 0.8]},
    "setting sun": {"shape": "sun", "direction": [0.2, 0.001, 1], "colour": [1, 0.9, 0.8]},
    "box": {
        "shape": "box", "direction": [0.1, 0.7, 0.6], "half_width_degrees": 14, "half_height_degrees": 20,
        "radiance": [1, 2, 3], "fade": 0.5, "softness": 0.4,
    },
    "low wide box": {
        "shape": "box", "direction": [-0.1, 0.1, 0.5], "half_width_degrees": 60, "half_height_degrees": 14,
        "radiance": [0.5, 0.4, 0.3],
    },
    "hard box": {
        "shape": "box", "direction": [0, 1, 0.5], "half_width_degrees": 30, "half_height_degrees": 3, "softness": 0.02,
        "radiance": [0.5, 0.4, 0.3],
    },
}  # fmt: skip


@pytest.mark.parametrize("walls", ["none", "matte"])
@pytest.mark.parametrize("lamp", LAMPS.values(), ids=LAMPS.keys())
def test_a_floor_under_a_lamp_has_the_light_that_a_sum_over_directions_gives(lamp: dict[str, Any], walls: str) -> None:
    """Floor and walls, of lamps that are whole, and that floor or walls cut. Of its largest value."""
    scene = legacy({"emitters": [lamp], "floor": MATTE, "walls": {"kind": walls}})
    ((_, disc),) = lamps_of(scene)
    middle = np.array(disc.direction) / np.linalg.norm(disc.direction)
    widest = 1.5 * max(np.radians(getattr(disc, name, 0)) for name in ("half_angle_degrees", "half_width_degrees"))
    widest = max(widest, 1.5 * np.radians(getattr(disc, "half_height_degrees", 0)))
    ways, solid_angle = spiral(EVEN, middle, min(widest, np.pi))
    radiance = lamp_share(disc, ways)[:, None] * np.array(disc.radiance)
    expected = received(ways, solid_angle, radiance, shown(scene))
    found = np.outer(lamp_field(disc, shown(scene)).projected, disc.radiance) / np.pi
    found[[number for number in range(4) if number not in shown(scene)]] = 0
    assert found == pytest.approx(expected, abs=1e-3 * expected.max())


SKIES: dict[str, dict[str, Any]] = {
    "dark": {"kind": "dark"},
    "light": {"kind": "light"},
    "constant": {"kind": "constant", "radiance": [0.1, 2, 3]},
    "half": {"kind": "half", "radiance": [3, 2, 1]},
    "gradient": {"kind": "gradient", "bottom": [1, 0, 0.5], "top": [0, 2, 0.5]},
    "studio": {"kind": "studio"},
}
ROOMS = [("matte", "none"), ("none", "matte"), ("matte", "matte")]


@pytest.mark.parametrize(("floor", "walls"), ROOMS)
@pytest.mark.parametrize("environment", SKIES.values(), ids=SKIES.keys())
def test_every_sky_lights_floor_and_walls_through_what_they_leave_open(
    environment: dict[str, Any], floor: str, walls: str
) -> None:
    """Black surfaces, so that they hand nothing on."""
    black = {"albedo": [0, 0, 0], "checker": "off"}
    scene = legacy({"environment": environment, "floor": {"kind": floor, **black}, "walls": {"kind": walls, **black}})
    ways, solid_angle = spiral(EVEN, np.array([0, 1.0, 0]), np.pi)
    expected = received(ways, solid_angle, sky(scene, ways), shown(scene))
    assert sky_light(staged(scene)) == pytest.approx(expected, abs=1e-3 * expected.max())


@pytest.mark.parametrize(("floor", "walls"), ROOMS)
def test_a_white_room_under_an_even_sky_is_as_bright_as_the_sky(floor: str, walls: str) -> None:
    """The white furnace: what walls hide of the sky, they give back."""
    white = {"albedo": [1, 1, 1], "checker": {"albedo": [1, 1, 1]}}
    environment = {"kind": "constant", "radiance": [1, 2, 4]}
    scene = legacy({"environment": environment, "floor": {"kind": floor, **white}, "walls": {"kind": walls, **white}})
    light = sky_light(staged(scene))[list(shown(scene))]
    if floor == "none":  # walls see half a sky below
        assert (light > [0.99, 1.98, 3.96]).all()
    assert light == pytest.approx(np.tile([1, 2, 4], (len(light), 1)), rel=2e-4)  # measured 1.4e-4


def test_shares_of_the_view_add_up() -> None:
    """Of the open sky and of all other surfaces."""
    sky_seen = open_sky((0, 1, 2, 3))
    assert sky_seen.even + sky_seen.others.sum(axis=1) == pytest.approx(1, abs=1e-4)
    assert sky_seen.others[0, 2] == pytest.approx(sky_seen.others[0, 3], abs=1e-3)


def drawn(height: int, sun: tuple[float, float, float], sun_degrees: float, level: float) -> Panorama:
    """A blue sky over brown ground with a sun."""
    d = directions(height)
    picture = np.where(d[..., 1:2] > 0, (0.3, 0.5, 1.0), (0.2, 0.15, 0.1)) * (1.2 + d[..., :1])
    middle = np.array(sun) / np.linalg.norm(sun)
    picture[d @ middle > np.cos(np.radians(sun_degrees))] = level * np.array([1, 0.9, 0.8])
    return picture.astype(np.float32)


PANORAMAS = {
    **{name: (make(), 0) for name, make in PICTURES.items()},
    "sun": (drawn(512, (0.3, 0.4, 1), 1, 2000), 77),
    "low sun over the seam": (drawn(512, (0.01, 0.03, -1), 2, 500), 0),
    "coarse": (drawn(24, (0.3, 0.4, 1), 12, 9), -33),
    "odd": (drawn(333, (0.3, 0.4, 1), 3, 50), 10),
}


@pytest.mark.parametrize("walls", ["none", "matte"])
@pytest.mark.parametrize(("picture", "turn"), PANORAMAS.values(), ids=PANORAMAS.keys())
def test_a_panorama_lights_floor_and_walls(picture: Panorama, turn: float, walls: str) -> None:
    """Against looking it up in even directions, as kernels do: between its four nearest pixels."""
    environment = {"kind": "image", "turn_degrees": turn, "scale": 1.5}
    black = {"albedo": [0, 0, 0], "checker": "off"}
    scene = legacy({"environment": environment, "floor": {**MATTE, **black}, "walls": {"kind": walls, **black}})
    ways, solid_angle = spiral(EVEN, np.array([0, 1.0, 0]), np.pi)
    height, width = picture.shape[:2]
    u = (np.arctan2(ways[:, 0], -ways[:, 2]) / (2 * np.pi) - turn / 360) % 1 * width - 0.5
    v = np.arccos(np.clip(ways[:, 1], -1, 1)) / np.pi * height - 0.5
    left, upper = np.floor(u).astype(int), np.floor(v).astype(int)
    radiance = np.zeros(ways.shape)
    for down in (0, 1):
        for right in (0, 1):
            row, column = upper + down, left + right
            over_the_pole = (row < 0) | (row >= height)
            pixel = picture[np.clip(row, 0, height - 1), (column + over_the_pole * (width // 2)) % width]
            share = (u - left if right else 1 - u + left) * (v - upper if down else 1 - v + upper)
            radiance += share[:, None] * pixel
    expected = received(ways, solid_angle, 1.5 * radiance, shown(scene))
    assert sky_light(staged(scene, panorama=picture)) == pytest.approx(expected, abs=1e-3 * expected.max())


def test_a_panoramas_sun_is_a_lamp_of_the_same_light() -> None:
    """Its place, its size, and the light that it gives a surface that faces it, over the seam too."""
    for toward in ((0.3, 0.4, 1), (0.002, 0.3, -1)):
        (spot,) = panorama_light(drawn(1024, toward, 1, 5000)).spots
        middle = np.array(toward) / np.linalg.norm(toward)
        assert np.degrees(np.arccos(middle @ np.array(spot.direction))) < 0.05
        assert 0.9 < spot.half_angle_degrees < 1.25  # its rim is soft
        light = lamp_field(spot, ()).solid_angle * np.array(spot.radiance)
        expected = 2 * np.pi * (1 - np.cos(np.radians(1))) * 5000 * np.array([1, 0.9, 0.8])
        assert light == pytest.approx(expected, rel=0.02)  # the drawn disc has whole pixels


@pytest.mark.parametrize("name", PICTURES)
def test_an_instruments_sky_has_no_spots(name: str) -> None:
    assert panorama_light(PICTURES[name]()).spots == ()


@pytest.mark.parametrize("name", PICTURES)
def test_an_instruments_sky_is_summed_once(name: str) -> None:
    """Every pass of a light map asks for it: that took longer than the passes."""
    environment = ImageEnvironment(kind="image", image=name)
    assert panorama_light(panorama_of(environment, {})) is panorama_light(panorama_of(environment, {}))


@pytest.mark.parametrize("name", ["box", "round 6", "half set", "behind a wall, half"])
def test_directions_within_a_lamp_are_spread_as_its_light_is(name: str) -> None:
    """The mean over directions of a surface's cosine is the lamp's light on it: what many passes come to."""
    scene = legacy({"emitters": [LAMPS[name]], "floor": MATTE, "walls": MATTE})
    ((_, lamp),) = lamps_of(scene)
    field = lamp_field(lamp, shown(scene))
    ways = np.array([field.sample(number) for number in range(4096)])
    assert (ways @ SURFACES[:, :3].T > 0).all()
    cosines = np.maximum(ways @ SURFACES[:, :3].T, 0).mean(axis=0)
    assert field.solid_angle * cosines == pytest.approx(field.projected, rel=2e-3, abs=2e-3 * field.projected.max())


def test_lamps_that_the_sky_hides_light_nothing() -> None:
    bare, lamps = (legacy({"environment": {"kind": "dark"}, "emitters": e}) for e in ([], [LAMPS["sun"]]))
    assert sky_light(Stage(bare, (), None)) == pytest.approx(sky_light(Stage(lamps, (), None)))


def test_the_legacy_lamps_give_what_they_were_found_to_give() -> None:
    """By hand from the closed form: 0.161, 0.040, 0.047, 0.018, 0.009 and 0.050 of red, and 0.03 of the ground."""
    scene = LEGACY_DEFAULT.model_copy(update={"floor": PRESETS["matte"].scene.floor})
    light = sky_light(staged(scene))[0]
    assert light[0] == pytest.approx(0.161 + 0.040 + 0.047 + 0.018 + 0.009 + 0.050 + 0.03, abs=2e-3)
    assert sky_light(staged(Scene())).shape == (4, 3)

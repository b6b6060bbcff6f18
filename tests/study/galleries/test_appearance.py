"""What pictures look like, in numbers: on pictures whose answer is known, and of the presets."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.chains import is_spectral
from culet.rendering.features import Features
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS, Scene
from culet.stage import Stage
from culet.study.galleries.appearance import appearance, colour_parts, lab, stone_mask
from culet.study.galleries.gallery import WANTED, in_flight, shown
from shared.stages import staged

WIDE, SQUARE, SAMPLES = (320, 180), (180, 180), 8
"""A sixteenth of the full size's pixels: measures are as there, but for fire, which small pictures isolate."""
SMALL: dict[str, dict[str, tuple[float, float]]] = {
    "default": {"low": (0, 28), "dark": (0.06, 0.25), "isolated": (0, 0.7)},  # measured 24.3, 0.109, 0.58
    "white": {"low": (0, 37)},  # measured 34.7
    "fire": {"isolated": (0, 0.85)},  # measured 0.78
    "falling": {"lightness": (52, 100), "dark": (0, 0.12), "michelson": (0.18, 1)},
    "face-up": {"dark": (0.07, 0.14)},  # measured 0.0785
}
"""Where a small picture has another band than WANTED."""


def picture(*colours: tuple[int, int, int]) -> NDArray[np.uint8]:
    """Columns of these colours, in turns, 96 pixels wide and high."""
    row = np.array([colours[x * len(colours) // 96] for x in range(96)], np.uint8)
    return np.tile(row, (96, 1, 1))


ALL = np.ones((96, 96), bool)


def test_lightness_and_chroma_are_those_of_cie() -> None:
    """White is 100, 0, 0; sRGB's red, green and blue as the CIE's formulas give them (D65, to a hundredth)."""
    shown_colours = np.array([(1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)], float)
    expected = [(100, 0, 0), (53.24, 80.09, 67.20), (87.73, -86.18, 83.18), (32.30, 79.19, -107.86), (0, 0, 0)]
    assert lab(shown_colours) == pytest.approx(np.array(expected), abs=0.02)


def test_black_and_white_halves_are_half_dark_and_half_clipped_with_one_edge_of_contrast() -> None:
    found = appearance(picture((0, 0, 0), (255, 255, 255)), ALL)
    assert (found.dark, found.clipped) == (0.5, 0.5)
    assert found.lightness == pytest.approx(50, abs=0.01)
    assert (found.low, found.high) == pytest.approx((0, 100), abs=0.01)
    assert found.fire == 0
    pairs = 47 * 48 + 48 * 47  # of neighbouring cells, of which a column's 48 are across the edge
    assert found.michelson == pytest.approx(48 / pairs)


def test_coloured_pixels_among_grey_are_fire_and_alone_they_are_isolated() -> None:
    spots, alone = picture((128, 128, 128)), picture((128, 128, 128))
    spots[10:20, 10:20] = (255, 60, 60)
    alone[10:90:8, 10:90:8] = (255, 60, 60)
    assert appearance(spots, ALL).fire == pytest.approx(100 / 96**2)
    assert appearance(spots, ALL).isolated == 0
    assert appearance(alone, ALL).isolated == 1


def test_only_the_stones_pixels_count() -> None:
    mask = np.zeros((96, 96), bool)
    mask[:, :48] = True
    found = appearance(picture((0, 0, 0), (255, 255, 255)), mask)
    assert (found.dark, found.share) == (1, 0.5)
    assert found.surround == pytest.approx(100, abs=0.01)


@pytest.mark.parametrize("name", ["default", "face-up"])
def test_the_stones_pixels_are_those_that_it_changes(renderer: Renderer, brilliant: Shape, name: str) -> None:
    """A black stone before a white backdrop, by a pinhole and by parallel rays."""
    scene = PRESETS[name].scene
    stone = scene.stones[0].model_copy(update={"absorption": (1e6, 1e6, 1e6)})
    plain = Scene.read(
        {
            "stones": [stone.model_dump()],
            "camera": scene.camera.model_dump(),
            "floor": {"kind": "none"},
            "environment": {"kind": "constant", "radiance": [0, 0, 0]},
            "backdrop": {"kind": "plain", "colour": [1, 1, 1]},
        }
    )
    drawn = renderer.picture(staged(plain, brilliant), *WIDE, features=Features())
    drawn.refine()
    assert ((drawn.linear()[..., 0] < 0.5) == stone_mask(drawn.stage, *WIDE)).mean() > 0.999


@pytest.mark.parametrize("name", WANTED)
def test_a_preset_looks_as_it_should(renderer: Renderer, name: str) -> None:
    preset = PRESETS[name]
    general = Features(spectral=int(is_spectral(preset.scene)))
    if name == "falling":
        measures = in_flight(renderer, preset, WIDE, general)
    else:
        size = SQUARE if preset.group == "instruments" else WIDE
        measures = shown(renderer, preset, size, SAMPLES, general).measures
    for measure, band in {**WANTED[name], **SMALL.get(name, {})}.items():
        low, high = band
        assert low <= measures[measure] <= high, measure


def test_the_default_shows_no_lamp_beside_the_stone_and_its_reflection_whole(renderer: Renderer) -> None:
    """The backdrop is no brighter than its centre, and the picture's edge shows nothing but it."""
    preset = PRESETS["default"]
    stone = shown(renderer, preset, WIDE, 1, Features())
    empty = preset.scene.model_copy(update={"stones": ()})
    bare = renderer.picture(Stage.of(empty), *WIDE)
    bare.refine()
    assert bare.linear().max() <= 0.181
    background = bare.rgb()
    for edge in (np.s_[:3], np.s_[-3:], np.s_[:, :3], np.s_[:, -3:]):
        assert abs(stone.picture[edge].astype(int) - background[edge]).max() <= 12  # the contact shadow's far end


def test_colours_are_counted_by_the_brightest_channel() -> None:
    linear = np.zeros((4, 4, 3))
    linear[0], linear[1], linear[2], linear[3] = (1, 0.1, 0), (1, 0.5, 0), (0, 1, 0.9), (0.2, 0, 1)
    found = colour_parts(linear, np.ones((4, 4), bool))
    assert vars(found) == {"red": 0.5, "green": 0.25, "blue": 0.25, "pure_red": 0.25}

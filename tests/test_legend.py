"""Legends: what the colours of instruments mean, by the head that the scene has, and how far the stone is tilted."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from culet.errors import InputError
from culet.legend import drawn, legend_of, tilt_words
from culet.optics.panoramas import panorama_of
from culet.scene import Camera, Scene, preset
from culet.scene.patch import read_patched
from culet.scene.sky import ImageEnvironment
from culet.stills import render


def patched(name: str, **change: object) -> Scene:
    return read_patched(preset(name).model_dump(mode="json"), change)


def test_the_colours_of_an_instrument_are_told_with_the_head_that_the_scene_has() -> None:
    assert [line.text for line in legend_of(preset("aset"))] == [
        "From above, 45\u00b0 to 75\u00b0", "From aside, 0\u00b0 to 45\u00b0", "Your head, 75\u00b0 to 90\u00b0",
        "Leak", "Face up",
    ]  # fmt: skip
    wide = patched("ideal-scope", environment={"head_degrees": 22.5})
    assert "Comes back, 0\u00b0 to 67.5\u00b0" in [line.text for line in legend_of(wide)]
    assert legend_of(Scene()) == []


@pytest.mark.parametrize("name", ["aset", "ideal-scope"])
def test_the_head_fills_the_cone_that_it_is_said_to(name: str) -> None:
    """By solid angle: 1 - cos of the half angle, of the hemisphere."""
    for degrees in (10, 20):
        pixels = panorama_of(ImageEnvironment(kind="image", image=name, head_degrees=degrees), {})
        height = len(pixels)
        elevation = 90 - 180 * (np.arange(height) + 0.5) / height
        colour = (0, 0, 1) if name == "aset" else (0, 0, 0)
        head = (pixels[:, 0] == colour).all(axis=1) & (elevation > 0)
        assert np.array_equal(head, elevation >= 90 - degrees)


def test_a_head_that_nothing_said_is_the_instruments_own() -> None:
    for name, degrees in (("aset", 15), ("ideal-scope", 10)):
        said = panorama_of(ImageEnvironment(kind="image", image=name, head_degrees=degrees), {})
        assert np.array_equal(said, panorama_of(ImageEnvironment(kind="image", image=name), {}))


def test_a_tilt_is_told_with_its_side() -> None:
    assert tilt_words(Camera(position=(0, 10, 0), target=(0, 0, 0), up=(0, 0, -1))) == "Face up"
    assert tilt_words(Camera(position=(0, 1, 1), target=(0, 0, 0))) == "Tilted 45.0\u00b0 toward 0\u00b0"
    assert tilt_words(Camera(position=(1, 1, 0), target=(0, 0, 0))) == "Tilted 45.0\u00b0 toward 90\u00b0"


def test_a_legend_is_drawn_in_a_corner_and_leaves_the_rest() -> None:
    picture = render("aset", 320, 240, samples=1)
    told = picture.with_legend()
    changed = (told.rgb != picture.rgb).any(axis=2)
    assert changed[150:, :160].any()
    assert not changed[:100].any()
    for colour in ((255, 0, 0), (0, 255, 0), (0, 0, 255)):
        assert (told.rgb[120:, :40] == colour).all(axis=2).sum() > 50
    see_through = drawn(np.zeros((240, 320, 4), np.uint8), legend_of(preset("aset")))
    assert see_through[..., 3].max() == 255


def test_a_picture_without_room_or_without_a_legend_is_refused() -> None:
    with pytest.raises(InputError, match="legend: expected a picture of at least"):
        render("aset", 64, 36, samples=1).with_legend()
    with pytest.raises(InputError, match="expected an instrument's sky"):
        render("white", 64, 36, samples=1).with_legend()


def test_the_words_are_the_pages() -> None:
    """As the page's own list has them, numbers aside."""
    page = Path("client/web/src/words/english.ts").read_text(encoding="utf-8")
    said = page[page.index("export const legend") :].partition("};")[0]
    lines = [*legend_of(preset("aset")), *legend_of(preset("ideal-scope"))]
    texts = [line.text for line in lines] + [tilt_words(Camera(position=(0, 1, 1), target=(0, 0, 0)))]
    for text in texts:
        for words in re.findall(r"[A-Za-z][A-Za-z ,]*[a-z]", text):
            assert words in said, text

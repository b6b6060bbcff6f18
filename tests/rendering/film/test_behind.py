"""A colour behind live pictures: a plain backdrop of the radiance that a screen shows in it."""

from __future__ import annotations

import numpy as np
import pytest

from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.engine.painting.shares import Account
from culet.engine.session.session import Session
from culet.optics.tone import TONE_MAPS, tone_map
from culet.rendering.film.behind import before_its_colour
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.backdrop import PlainBackdrop
from culet.scene.fields import LARGEST_COMPONENT
from rendering.views import take
from shared.stages import staged

COLOURS = [(244, 241, 234), (16, 32, 64), (240, 192, 64), (0, 0, 0), (255, 255, 255)]


def shown_before(colour: tuple[int, int, int], name: str, exposure: float) -> np.ndarray:
    """0 to 255."""
    film = {"background": "#" + bytes(colour).hex(), "tone_map": name, "exposure": exposure}
    backdrop = before_its_colour(Scene.read({"film": film})).backdrop
    assert isinstance(backdrop, PlainBackdrop)
    return 255 * tone_map(exposure * np.array(backdrop.colour), name)


@pytest.mark.parametrize("name", TONE_MAPS)
def test_every_tone_map_shows_it(name: str) -> None:
    for colour in COLOURS:
        assert np.abs(shown_before(colour, name, exposure=2) - colour).max() < 2  # measured 1.9: neutral, of white


def test_a_colour_that_a_tone_map_never_shows_becomes_one_that_looks_like_it() -> None:
    red, green, blue = shown_before((255, 0, 0), "neutral", exposure=1)
    assert red > 230  # measured 236
    assert green == pytest.approx(blue, abs=0.1)
    assert green < 10  # measured 4.4


@pytest.mark.parametrize("exposure", [1e-7, 1e-320, 1e6])
def test_at_any_exposure_there_is_a_colour_that_a_scene_may_have(exposure: float) -> None:
    film = {"background": "#f4f1ea", "exposure": exposure}
    shown = Session("0" * 32, staged(Scene.read({"film": film}))).shown
    frame = FrameWork(WorkKind.FULL, shown, (64, 36), Account(None), begun_at=0)
    backdrop = frame.stage.scene.backdrop
    assert isinstance(backdrop, PlainBackdrop)
    assert max(backdrop.colour) <= LARGEST_COMPONENT
    assert Scene.read(frame.stage.scene.model_dump(mode="json")).backdrop == backdrop


def test_a_scene_without_a_colour_stays_as_it_is() -> None:
    for background in ("backdrop", "transparent"):
        scene = Scene.read({"film": {"background": background}})
        assert before_its_colour(scene) is scene


def test_it_is_what_a_corner_of_the_picture_has_and_the_stone_stays_as_it_was(renderer: Renderer) -> None:
    scene = Scene.read({"floor": {"kind": "none"}, "film": {"background": "#1f3a5f"}})
    plain, coloured = (take(renderer, each, size=(64, 36)).rgb() for each in (scene, before_its_colour(scene)))
    assert np.abs(coloured[0, 0].astype(int) - (0x1F, 0x3A, 0x5F)).max() <= 1
    assert (coloured[18, 32] == plain[18, 32]).all()

"""Caustics, and the colours of floor and walls, by the panel: the picture, its header and the scene follow."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from culet_protocol.frame import Flags
from e2e.conftest import BESIDE_PANEL, WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View, difference

FLECKS = 0.2
"""Mean difference, of 255, that the matte scene's caustics make at least. Measured: 0.6."""


@pytest.fixture
def view(view_of: ViewOf) -> View:
    """With the panel, and its colours of floor and walls unfolded."""
    view = view_of(viewport=WITH_PANEL).open()
    view.page.locator("#panel").get_by_role("button", name="Floor and walls").click()
    return view


def test_stones_throw_caustics_or_their_shadows_alone(view: View, server: Server) -> None:
    caustics = view.page.get_by_label("Caustics")
    assert caustics.is_checked()
    with_flecks, without = view.change(lambda: caustics.press("Space"))
    assert (with_flecks.pixels.shape[1], with_flecks.pixels.shape[0]) == tuple(BESIDE_PANEL.values())
    assert difference(with_flecks.pixels, without.pixels) > FLECKS
    assert not with_flecks.frame["flags"] & Flags.SHADOWS_ONLY
    assert without.frame["flags"] & Flags.SHADOWS_ONLY
    expect(view.page.locator("#status")).to_contain_text("shadows without caustics")  # told twice a second
    assert server.session(view.session)["scene"]["optics"]["caustics"] == "off"


def test_a_floor_has_the_colour_and_the_cells_that_one_chooses(view: View, server: Server) -> None:
    before, green = view.change(lambda: view.page.get_by_label("Floor", exact=True).fill("#00bc00"))
    floor = server.session(view.session)["scene"]["floor"]
    assert floor["albedo"] == [0, 0.5029, 0]  # 188 of 255, as sRGB encodes it
    assert view.scene["floor"] == floor
    assert green.pixels[-8:, :, 0].min() < 20 < before.pixels[-8:, :, 0].min()  # the cells of that colour have no red
    checkered = view.page.get_by_label("Floor, checkered")
    checker = floor["checker"]
    _, plain = view.change(checkered.click)
    assert server.session(view.session)["scene"]["floor"]["checker"] == "off"
    assert plain.pixels[-8:, :, 0].max() < 90  # what is red there is thrown by the stone
    assert view.page.get_by_role("spinbutton", name="Floor, cell, R").is_disabled()
    view.change(checkered.click)
    after = server.session(view.session)["scene"]["floor"]["checker"]
    assert after["cell"] == checker["cell"]
    assert after["albedo"] == pytest.approx(checker["albedo"], abs=0.005)  # a step of 8 bits


def test_a_cell_beyond_the_slider_is_said_and_a_mirror_has_no_colour(view: View) -> None:
    cell = view.page.get_by_role("spinbutton", name="Floor, cell, R")
    cell.fill("99")
    cell.press("Enter")
    view.page.get_by_text("99 is beyond the slider: 8 is taken.").wait_for()  # now: it goes by itself
    view.until("() => culet.state.scene.floor.checker.cell === 8")
    view.page.get_by_label("Mirror").click()
    view.until("() => culet.state.mirror")
    for label in ("Floor", "Walls"):
        assert (
            view.page.locator("#panel input[type=color]").and_(view.page.get_by_label(label, exact=True)).is_disabled()
        )
    assert view.page.get_by_label("Caustics").is_disabled()
    assert view.problems == []

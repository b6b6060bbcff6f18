"""The balance between speed and exactness: dragged, pinned, shared, and what comes of it plotted."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from culet_protocol.frame import Flags
from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View

PAGE = {"width": 800, "height": 450}
"""Pixels: enough for the governor to scale."""
PHONE = {"width": 390, "height": 844}
FINE = {
    "optics": {"cutoff": 0.005, "bands": 4},
    "floor": {"kind": "matte"},
    "stones": [{"position": [0, 500, 0]}],
    "simulation": {"restitution": 0.97},
}
"""More than a moving frame gets unless it is pinned; falls for ten seconds, and then bounces for long."""
FLAGS = [int(Flags.MOVING), int(Flags.FRONTIER)]


@pytest.fixture
def pair(view_of: ViewOf, server: Server) -> tuple[View, View]:
    """Two pages on one session."""
    session = server.http.post("/api/sessions", json={"scene": FINE}).json()["id"]
    first, second = (view_of(viewport=PAGE).open(f"?session={session}") for _ in range(2))
    return first, second


def open_meter(view: View) -> None:
    """And wait until its plots are there, which move what is under them."""
    view.page.get_by_role("button", name="Speed and exactness").click()
    view.page.locator("#meter canvas").nth(1).wait_for()


def toggle_pin(view: View) -> None:
    """By its key, wherever the box is."""
    view.page.get_by_label("Pin the quality").press("Space")


def choose(view: View, exactness: float) -> None:
    """Type a number beside the slider."""
    number = view.page.get_by_role("spinbutton", name="Exactness")
    number.fill(str(exactness))
    number.press("Enter")


def test_a_dragged_balance_reaches_every_viewer_and_the_engine(pair: tuple[View, View], server: Server) -> None:
    first, second = pair
    open_meter(first)
    first.drag_slider("Exactness", 0.5, 0.7, 0.9)
    for view in pair:
        view.until("() => culet.state.exactness === 0.9")
    assert server.session(first.session)["exactness"] == first.state["exactness"] == second.state["exactness"]
    assert not first.state["pinned"]
    frames = round(60 / 4 ** first.state["exactness"])
    expect(first.page.locator("#meter")).to_contain_text(f"{frames} frames/s")


def test_a_pinned_balance_draws_moving_frames_as_the_scene_asks(pair: tuple[View, View]) -> None:
    first, second = pair
    open_meter(first)
    first.page.keyboard.press("p")
    both = "(frame, [moving, frontier]) => frame.flags & moving && frame.flags & frontier"
    assert first.frame_when(both, FLAGS)["bands"] == 3

    choose(first, 1)
    toggle_pin(first)
    for view in pair:
        view.until("() => culet.state.pinned && culet.state.exactness === 1")
        # A link that is slow for a while, as on a busy machine, has smaller ones.
        whole = "(frame, moving) => frame.flags & moving && frame.bands === 4 && frame.width === picture.width"
        frame = view.frame_when(whole, int(Flags.MOVING))
        assert frame["height"] == view.page.evaluate("() => picture.height")
        assert frame["cutoff"] == pytest.approx(0.005)
    expect(first.page.locator("#meter")).to_contain_text("all that the scene asks for")

    open_meter(second)
    toggle_pin(second)
    first.until("() => !culet.state.pinned && culet.lastFrame.bands === 3")


def test_folded_plots_are_not_even_loaded_and_open_ones_follow_the_frames(view_of: ViewOf, server: Server) -> None:
    session = server.http.post("/api/sessions", json={"scene": FINE}).json()["id"]
    view = view_of(viewport=PAGE)
    asked: list[str] = []
    view.page.on("request", lambda request: asked.append(request.url))
    view.open(f"?session={session}")
    view.page.keyboard.press("p")
    view.until("() => culet.framesShown > 10")
    assert not [url for url in asked if "plots" in url]
    assert view.page.locator("#meter canvas").count() == 0

    open_meter(view)
    canvases = view.page.locator("#meter canvas")
    canvases.nth(1).wait_for()
    drawn = "document.querySelectorAll('#meter canvas')[number].toDataURL()"
    for number in (0, 1):
        before = view.page.evaluate(f"number => {drawn}", number)
        view.until(f"([number, before]) => {drawn} !== before", [number, before])
    for name in ("simulate", "render", "encode", "network", "decode", "frontier's, moving", "3 bands"):
        expect(view.page.locator("#meter")).to_contain_text(name)
    view.page.keyboard.press("p")
    view.at_rest()
    view.until("() => /estimated, at rest 0\\.\\d+/.test(document.getElementById('meter').innerText)")
    view.until("() => document.getElementById('meter').innerText.includes('16 samples')")


def test_a_number_beyond_the_ends_of_the_slider_is_taken_as_its_end(pair: tuple[View, View]) -> None:
    first, _ = pair
    open_meter(first)
    choose(first, 7)
    first.until("() => culet.state.exactness === 1")
    assert first.problems == []


def test_the_two_kinds_of_error_are_explained_where_they_are_shown(view_of: ViewOf) -> None:
    view = view_of(viewport=PAGE).open()
    open_meter(view)
    for name, meaning in (("frontier's, moving", "the default scene"), ("estimated, at rest", "two halves")):
        view.page.locator("#meter li", has_text=name).hover()  # nothing lies over it
        assert meaning in (view.page.locator("#meter li", has_text=name).get_attribute("title") or "")
    view.page.locator("#status").hover()
    status = view.page.locator("#status").get_attribute("title") or ""
    assert "the default scene" in status, "of the error while things move"
    assert "no difference is seen" in status, "of that at rest"


def test_on_a_phone_panel_and_plots_take_turns_and_leave_the_stone_in_sight(view_of: ViewOf) -> None:
    view = view_of(viewport=PHONE).open()
    meter, panel = view.page.locator("#meter"), view.page.locator("#panel")
    open_meter(view)
    meter.locator("canvas").nth(1).wait_for()
    unfolded = meter.bounding_box()
    assert unfolded is not None
    assert unfolded["y"] > PHONE["height"] / 2
    title = panel.get_by_role("button").first
    title.click()
    meter.wait_for(state="hidden")
    title.click()
    meter.wait_for(state="visible")
    assert meter.locator("canvas").count() == 2  # as it was

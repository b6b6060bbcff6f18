"""Screens of many pixels, and of few."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from playwright.sync_api import FloatRect, Locator, expect

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View

PHONE: dict[str, Any] = {"viewport": {"width": 375, "height": 667}, "has_touch": True, "is_mobile": True}
FINGER = 28
"""CSS pixels: lower than this is hard to hit."""


@pytest.mark.parametrize("ratio", [1, 1.5, 2, 3])
def test_the_canvas_has_the_pixels_of_the_screen(view_of: ViewOf, ratio: float) -> None:
    view = view_of(viewport={"width": 200, "height": 120}, device_scale_factor=ratio).open()
    size = [200 * ratio, 120 * ratio]
    view.until("([width, height]) => culet.lastFrame.width === width && culet.lastFrame.height === height", size)
    assert view.look().pixels.shape == (size[1], size[0], 3)


def test_the_picture_follows_the_window(view: View) -> None:
    view.page.set_viewport_size({"width": 250, "height": 150})
    view.until("() => culet.lastFrame.width === 250 && culet.lastFrame.height === 150")
    assert view.look().pixels.shape == (150, 250, 3)


def test_a_phone_shows_picture_status_and_a_folded_panel(view_of: ViewOf) -> None:
    view = view_of(**PHONE).open()
    page = view.page
    assert page.evaluate("() => document.documentElement.scrollWidth") == 375, "nothing to scroll sideways"
    title, status = page.get_by_role("button", name="culet"), page.locator("#status")
    for part in (title, status):
        assert inside(box(part))
    assert not page.get_by_role("button", name="Left", exact=True).is_visible()
    assert not overlap(box(title), box(status))

    title.tap()
    for folder in ("Move", "Surroundings", "Pictures and scenes"):
        heading = page.get_by_role("button", name=folder)
        heading.wait_for()
        assert box(heading)["height"] >= FINGER
        assert inside(box(heading))
    folded, below = (box(page.get_by_role("button", name=name)) for name in ("Pictures and scenes", "Move"))
    assert below["y"] - folded["y"] - folded["height"] == pytest.approx(0, abs=2), "a folded folder takes no room"
    page.get_by_role("button", name="Surroundings").tap()
    checkbox = page.get_by_role("checkbox", name="Mirror")
    checkbox.tap()
    view.until("() => culet.state.mirror")
    assert checkbox.is_checked()
    assert view.scene["floor"]["kind"] == "mirror"
    assert [message["type"] for message in view.sent] == ["toggle_mirror"]


def test_a_session_made_in_a_narrow_window_has_the_whole_stone_in_view(view_of: ViewOf, server: Server) -> None:
    wide, narrow = view_of().open(), view_of(**PHONE).open()
    near, far = (np.array(view.scene["camera"]["position"]) for view in (wide, narrow))
    target = np.array(wide.scene["camera"]["target"])
    farther = 0.7 * PHONE["viewport"]["height"] / PHONE["viewport"]["width"]
    np.testing.assert_allclose(far - target, (near - target) * farther, rtol=1e-12)
    narrow.page.keyboard.press("o")
    narrow.until("far => culet.state.scene.camera.position[2] !== far", far[2])
    narrow.page.keyboard.press("f")
    narrow.until("far => culet.state.scene.camera.position[2] === far", far[2])
    guest = view_of(**PHONE).open(f"?session={wide.session}")
    assert guest.scene["camera"] == server.session(wide.session)["scene"]["camera"] == wide.scene["camera"]


def test_the_panel_shows_the_state_and_every_key(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    panel = view.page.locator("#panel")
    marks = {mark.get_attribute("data-key") for mark in panel.locator("kbd").all()}
    options = " ".join(panel.locator("option").all_inner_texts())
    for key in "IOFPRMLWSXKBNHE?\u2190\u2192\u2191\u2193":
        assert key in marks
    for key in "C123":
        assert f"[{key}]" in options
    for key, name in (("m", "Mirror"), ("w", "Walls")):
        checkbox = view.page.get_by_role("checkbox", name=name)
        assert not checkbox.is_checked()
        view.change_by(key)
        assert checkbox.is_checked()
    view.page.keyboard.press("2")
    expect(view.page.get_by_label("What", exact=True)).to_have_value("light_2")


def box(part: Locator) -> FloatRect:
    """Where it is, in CSS pixels."""
    found = part.bounding_box()
    assert found is not None, "it is not shown"
    return found


def inside(part: FloatRect, width: int = 375, height: int = 667) -> bool:
    """Whether all of it is on the phone's screen."""
    right, bottom = part["x"] + part["width"], part["y"] + part["height"]
    return part["x"] >= 0 and part["y"] >= 0 and right <= width and bottom <= height


def overlap(a: FloatRect, b: FloatRect) -> bool:
    """Whether one hides a part of the other."""
    across = a["x"] < b["x"] + b["width"] and b["x"] < a["x"] + a["width"]
    return across and a["y"] < b["y"] + b["height"] and b["y"] < a["y"] + a["height"]

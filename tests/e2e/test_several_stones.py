"""Several stones on the page: one is chosen, outlined and edited; others are added, removed and scattered."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect

from e2e.conftest import BESIDE_PANEL, WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View

CAMERA = {"position": [0, 0, 12], "target": [0, 0, 0], "fov_degrees": 40}
STONES = [
    {"id": "left", "position": [-2, 0, 0], "material": "ruby"},
    {"id": "right", "position": [2, 0, 0], "material": "sapphire"},
]
SCENE: dict[str, Any] = {"stones": STONES, "camera": CAMERA, "simulation": {"gravity": 0}}
HALF_HEIGHT = 12 * np.tan(np.radians(20))
"""R of the picture where the stones are."""
PHONE: dict[str, Any] = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
LEFT_OF_THE_MIDDLE, RIGHT_OF_THE_MIDDLE, ABOVE = -0.46, 0.46, 0.8
"""Halves of the picture's height: 2 R are 0.458 of what is seen at 12 R."""


def opened(view_of: ViewOf, server: Server, scene: dict[str, Any], **options: Any) -> View:  # noqa: ANN401 - as ViewOf
    """A page on a new session of that scene, at rest."""
    answer = server.http.post("/api/sessions", json={"scene": scene})
    assert answer.status_code == 201, answer.text
    view = view_of(**options).open(f"?session={answer.json()['id']}")
    view.at_rest()
    return view


@pytest.fixture
def view(view_of: ViewOf, server: Server) -> View:
    """Of two stones side by side, with the panel."""
    return opened(view_of, server, SCENE, viewport=WITH_PANEL)


def click(view: View, x: float, y: float = 0.0) -> None:
    """At a point of the picture."""
    half = BESIDE_PANEL["height"] / 2
    view.page.mouse.click(BESIDE_PANEL["width"] / 2 + half * x, half - half * y)


def chosen(view: View, stone: str | None) -> None:
    view.until("stone => culet.state.stone === stone", stone)


def outline(view: View) -> Any:  # noqa: ANN401
    """(N, 2) its corners, in CSS pixels; the picture has as many."""
    view.until("() => document.querySelector('#outline polygon').hasAttribute('points')")
    points = view.page.locator("#outline polygon").first.get_attribute("points")
    assert points is not None
    return np.array([point.split(",") for point in points.split()], float)


def ids(view: View) -> list[str]:
    return [stone["id"] for stone in view.scene["stones"]]


def test_a_click_chooses_a_stone_and_outlines_it_where_it_is(view: View) -> None:
    half = BESIDE_PANEL["height"] / 2
    for name, x in (("left", LEFT_OF_THE_MIDDLE), ("right", RIGHT_OF_THE_MIDDLE)):
        click(view, x)
        chosen(view, name)
        middle = (outline(view).min(axis=0) + outline(view).max(axis=0)) / 2
        assert middle == pytest.approx([BESIDE_PANEL["width"] / 2 + half * x, half], abs=12)
    click(view, 0, ABOVE)
    chosen(view, None)
    view.until("() => !document.querySelector('#outline polygon').hasAttribute('points')")
    assert view.problems == []


def test_the_panel_changes_the_chosen_stone_and_each_viewer_has_one_of_their_own(view: View, view_of: ViewOf) -> None:
    other = view_of(viewport=WITH_PANEL).open(f"?session={view.session}")
    view.page.get_by_label("Chosen", exact=True).select_option(label="right")
    chosen(view, "right")
    assert other.state["stone"] is None
    material = view.page.get_by_label("Material", exact=True)
    expect(material).to_have_value("sapphire")
    view.change(lambda: material.select_option(label="Emerald"))
    assert [stone["material"] for stone in view.scene["stones"]] == ["ruby", "emerald"]
    expect(other.page.get_by_label("Material", exact=True)).to_have_value("ruby")  # of the first, as long as none is


def test_a_stone_is_added_removed_and_put_back(view: View) -> None:
    click(view, LEFT_OF_THE_MIDDLE)
    chosen(view, "left")
    view.change(lambda: view.page.get_by_role("button", name="Add another like it").click())
    assert ids(view) == ["left", "right", "left-2"]
    assert view.scene["stones"][2]["material"] == "ruby"
    chosen(view, "left-2")
    before = view.scene["stones"]
    view.change_by("Delete")
    assert ids(view) == ["left", "right"]
    chosen(view, None)
    view.change_by("u")
    assert view.scene["stones"] == before
    assert view.problems == []


def test_scattered_stones_are_in_the_air_and_fall(view: View) -> None:
    view.page.get_by_role("button", name="Scatter all").click()
    view.until("() => culet.state.falling && culet.state.scene.stones.every(({ position }) => position[1] > 0)")
    assert ids(view) == ["left", "right"]
    assert view.problems == []


def test_what_acts_on_all_stones_is_named_after_all_of_them_while_there_are_several(view: View) -> None:
    page, round_button = view.page, view.page.locator("#fall")
    assert round_button.get_attribute("aria-label") == "Let the stones fall"
    assert page.get_by_role("button", name="Put the stones back").is_visible()
    page.keyboard.press("p")
    page.locator("#announcement").get_by_text("the stones fall", exact=True).wait_for(state="attached")
    page.keyboard.press("r")
    view.until("() => !culet.state.falling")
    page.get_by_label("Chosen", exact=True).select_option(label="left")
    page.get_by_role("button", name="Remove the chosen stone").click()
    page.get_by_role("button", name="Put the stone back").wait_for()
    assert round_button.get_attribute("aria-label") == "Let the stone fall"
    assert page.get_by_role("button", name="Remove the stone").is_visible()
    assert ids(view) == ["right"]


def test_the_nearest_of_stones_out_of_the_picture_is_told_and_all_are_looked_at(
    view_of: ViewOf, server: Server
) -> None:
    view = opened(view_of, server, SCENE | {"camera": CAMERA | {"position": [-30, 0, 12], "target": [-30, 0, 0]}})
    unseen = view.page.locator("#unseen")
    unseen.get_by_text("The nearest stone is to the right of the picture.").wait_for()
    unseen.get_by_role("button", name="Look at them").click()
    unseen.wait_for(state="hidden")
    view.until_told()
    assert view.scene["camera"]["target"][0] == pytest.approx(0, abs=0.5), "between the two"


def test_stones_inside_each_other_are_told_of(view: View, server: Server) -> None:
    patch = {"stones": {"left": {"position": [1.2, 0, 0]}}}
    assert server.http.patch(f"/api/sessions/{view.session}", json=patch).status_code == 200
    view.page.locator(".toast.finding").get_by_text("the stones 'left' and 'right' overlap by 0.").wait_for()
    assert view.problems == []


def test_stones_are_chosen_removed_and_put_back_by_keys_alone(view: View) -> None:
    keyboard, stones = view.page.keyboard, view.page.get_by_label("Chosen", exact=True)
    view.page.locator("#picture").focus()
    for _ in range(60):
        keyboard.press("Tab")
        if stones.evaluate("list => list === document.activeElement"):
            break
    for stone in ("left", "right"):
        keyboard.press("ArrowDown")
        chosen(view, stone)
    keyboard.press("Delete")
    view.until("() => culet.state.scene.stones.length === 1")
    assert ids(view) == ["left"]
    keyboard.press("u")
    view.until("() => culet.state.scene.stones.length === 2")
    chosen(view, "right")
    assert stones.evaluate("list => list === document.activeElement"), "the list keeps the focus"
    assert view.problems == []


def test_a_finger_chooses_adds_removes_and_scatters_on_a_phone(view_of: ViewOf, server: Server) -> None:
    camera = CAMERA | {"position": [0, 0, 30]}
    view = opened(view_of, server, SCENE | {"camera": camera}, **PHONE)
    page, width, height = view.page, PHONE["viewport"]["width"], PHONE["viewport"]["height"]
    seen = 30 * np.tan(np.radians(20))  # R, half of the height
    page.touchscreen.tap(width / 2 - 2 / seen * height / 2, height / 2)
    chosen(view, "left")
    corners = outline(view)
    assert corners[:, 0].max() < width / 2
    page.get_by_role("button", name="culet").tap()
    page.get_by_role("button", name="Stones", exact=True).tap()
    page.get_by_role("button", name="Add another like it").tap()
    chosen(view, "left-2")
    view.until("() => culet.state.scene.stones.length === 3")
    page.get_by_role("button", name="Remove the chosen stone").tap()
    view.until("() => culet.state.scene.stones.length === 2")
    page.get_by_role("button", name="Scatter all").tap()
    view.until("() => culet.state.falling && culet.state.scene.stones.every(({ position }) => position[1] > 0)")
    assert ids(view) == ["left", "right"]
    assert view.problems == []


def test_ctrl_and_drag_moves_a_stone_under_the_pointer_and_keys_turn_it_as_edits(view: View) -> None:
    half, mouse, keyboard = BESIDE_PANEL["height"] / 2, view.page.mouse, view.page.keyboard
    x = BESIDE_PANEL["width"] / 2 + half * LEFT_OF_THE_MIDDLE
    before = view.scene["stones"]
    mouse.move(x, half)
    keyboard.down("Control")
    mouse.down()
    mouse.move(x + 10, half - 40, steps=4)
    view.until("y => culet.state.scene.stones[0].position[1] > y", 40 / half * HALF_HEIGHT * 0.95)
    mouse.up()
    keyboard.up("Control")
    chosen(view, "left")
    view.until("y => document.querySelector('#outline polygon').getBBox().y < y", half - 50)
    middle = (outline(view).min(axis=0) + outline(view).max(axis=0)) / 2
    assert middle == pytest.approx([x + 10, half - 40], abs=12), "the stone is where the pointer is"
    keyboard.press("3")
    keyboard.press("Shift+ArrowLeft")
    view.until("turn => String(culet.state.scene.stones[0].orientation) !== turn", ",".join(map(str, [1, 0, 0, 0])))
    view.until_told()
    while view.state["canUndo"]:  # what a hand does is one edit if it does not take long
        keyboard.press("Control+z")
        view.until_told()
    assert view.scene["stones"] == before
    assert view.problems == []


def test_shift_and_drag_throws_the_stone_that_is_under_the_pointer_alone(view_of: ViewOf, server: Server) -> None:
    """Without gravity it flies on, as its outline shows; the other one stays as it was."""
    stones = [{**stone, "spin": [0, 0, 0]} for stone in STONES]
    view = opened(view_of, server, {**SCENE, "stones": stones}, viewport=WITH_PANEL)
    click(view, LEFT_OF_THE_MIDDLE)
    chosen(view, "left")
    before, half, mouse = outline(view), BESIDE_PANEL["height"] / 2, view.page.mouse
    x = BESIDE_PANEL["width"] / 2 + half * RIGHT_OF_THE_MIDDLE
    mouse.move(x, half)
    view.page.keyboard.down("Shift")
    mouse.down()
    mouse.move(x, half - 40, steps=3)
    mouse.up()
    view.page.keyboard.up("Shift")
    view.until("() => culet.state.falling")
    select = view.page.get_by_label("Chosen", exact=True)
    select.select_option(label="right")
    chosen(view, "right")
    view.until("high => document.querySelector('#outline polygon').points[0]?.y < high", 0.5 * half)
    select.select_option(label="left")
    chosen(view, "left")
    assert outline(view) == pytest.approx(before, abs=1)  # pictures of other sizes have their place to half a pixel
    assert view.problems == []

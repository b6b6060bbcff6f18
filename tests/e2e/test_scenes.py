"""The strip of scenes that the page opens on, and the round button that lets the stone fall."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import expect

from e2e.conftest import WITH_PANEL, ViewOf, bouncing_in
from e2e.server import Server
from e2e.view import View, difference

DESK = {"width": 1000, "height": 500}
PHONE: dict[str, Any] = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


@pytest.fixture
def presets(server: Server) -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = server.http.get("/api/presets").json()["presets"]
    return listed


@pytest.mark.parametrize("options", [{"viewport": DESK}, PHONE], ids=["desk", "phone"])
def test_the_page_opens_on_a_picture_of_every_scene(
    view_of: ViewOf, presets: list[dict[str, Any]], options: dict[str, Any]
) -> None:
    view = view_of(**options).open()
    entries = view.page.locator("#scenes button")
    expect(entries).to_have_count(len(presets))
    assert sorted(entries.all_inner_texts()) == sorted(preset["title"] for preset in presets)
    assert all(entries.evaluate_all("buttons => buttons.map(({title}) => title)")), "a sentence about each"
    entries.last.scroll_into_view_if_needed()
    view.until("() => [...document.querySelectorAll('#scenes img')].at(-1).naturalWidth > 0")
    assert view.page.evaluate("() => document.documentElement.scrollWidth") == options["viewport"]["width"]
    view.page.locator("#scenes-toggle").click()
    entries.first.wait_for(state="hidden")


def test_a_scene_is_shown_and_the_stone_of_the_next_one_too(view_of: ViewOf, presets: list[dict[str, Any]]) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    view.page.locator("#scenes-toggle").click()  # folded in so low a window
    by_title = {preset["title"]: preset["scene"] for preset in presets}
    for title in ("Mirror floor", "Fig. 11, blue"):
        before, after = view.change(lambda: view.page.get_by_role("button", name=title).click())  # noqa: B023
        assert view.scene == by_title[title]
        assert difference(before.pixels, after.pixels) > 1
    view.change_by("m")
    assert view.scene["floor"]["kind"] == "matte", "letters are still the page's"


def test_arrow_keys_reach_every_scene_and_move_nothing(view_of: ViewOf, presets: list[dict[str, Any]]) -> None:
    view = view_of(viewport=DESK).open()
    view.page.locator("#scenes button").first.focus()
    reached = []
    for _ in presets:
        reached.append(view.page.evaluate("() => document.activeElement.innerText"))
        view.page.keyboard.press("ArrowRight")
    assert sorted(reached) == sorted(preset["title"] for preset in presets)
    view.page.keyboard.press("Home")
    view.page.keyboard.press("ArrowRight")
    view.settle_messages()
    assert view.sent == []
    view.page.keyboard.press("Enter")
    view.settle_messages()
    assert [message["type"] for message in view.sent] == ["set_scene"]


def test_a_scene_chosen_on_a_phone_has_its_stone_in_view(view_of: ViewOf, presets: list[dict[str, Any]]) -> None:
    view = view_of(**PHONE).open()
    scene = next(preset["scene"] for preset in presets if preset["name"] == "aset")
    view.page.get_by_role("button", name="ASET").tap()
    view.until("() => culet.state.scene.environment.image === 'aset'")
    camera, narrow = view.scene["camera"], 0.7 * 844 / 390
    if camera["kind"] == "orthographic":
        assert camera["height"] == pytest.approx(scene["camera"]["height"] * narrow)
    else:
        distance = camera["position"][1] - camera["target"][1]
        assert distance == pytest.approx((scene["camera"]["position"][1] - scene["camera"]["target"][1]) * narrow)


@pytest.mark.parametrize("options", [{"viewport": DESK}, PHONE], ids=["desk", "phone"])
def test_a_round_button_lets_the_stone_fall_and_pauses_it(
    view_of: ViewOf, server: Server, options: dict[str, Any]
) -> None:
    view = bouncing_in(view_of, server, **options)
    button = view.page.locator("#fall")
    button.click()
    view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0")
    assert button.get_attribute("aria-label") == "Pause the fall"
    button.click()
    view.until("() => !culet.state.falling")
    assert button.get_attribute("aria-label") == "Let the stone fall"
    box, status = button.bounding_box(), view.page.locator("#status").bounding_box()
    assert box is not None
    assert status is not None
    assert box["width"] == box["height"] == 64
    assert box["y"] + box["height"] <= status["y"], "it covers no words"


def test_arrow_keys_reach_every_material_and_move_nothing(view_of: ViewOf, server: Server) -> None:
    """Quicker than the server can answer: the list goes on from what was chosen, not from what was last heard."""
    view: View = view_of(viewport=WITH_PANEL).open()
    names = [material["name"] for material in server.http.get("/api/materials").json()["materials"]]
    materials = view.page.get_by_label("Material", exact=True)
    materials.focus()
    view.page.keyboard.press("Home")
    view.page.keyboard.press("ArrowDown")
    view.page.keyboard.press("ArrowUp")
    chosen = [materials.input_value()]
    for _ in names[1:]:
        view.page.keyboard.press("ArrowDown")
        chosen.append(materials.input_value())
    assert chosen == names
    view.until("name => culet.state.scene.stones[0].material === name", names[-1])
    assert {message["type"] for message in view.sent} == {"patch_scene"}
    assert materials.evaluate("list => list === document.activeElement")
    view.page.keyboard.press("m")
    view.until("() => culet.state.mirror")
    expect(materials).to_have_value(names[-1])  # a letter is the page's while the list is folded

"""The page for those who cannot see it, or use no mouse: by axe-core's rules for WCAG 2.2 AA, and by keys alone."""

from __future__ import annotations

from typing import Any

import pytest

from e2e.conftest import WEB, WITH_PANEL, ViewOf
from e2e.view import View

AXE = WEB / "node_modules" / "axe-core" / "axe.min.js"
RULES = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice")


def violations(view: View) -> list[str]:
    """What axe-core finds, by rule and element. By the DevTools protocol: the page's policy forbids scripts."""
    tools = view.page.context.new_cdp_session(view.page)
    tools.send("Runtime.evaluate", {"expression": AXE.read_text()})
    options = f"{{runOnly: {list(RULES)}, rules: {{'target-size': {{enabled: true}}}}, resultTypes: ['violations']}}"
    run = f"axe.run(document, {options})"
    answer: dict[str, Any] = tools.send(
        "Runtime.evaluate", {"expression": run, "awaitPromise": True, "returnByValue": True}
    )
    tools.detach()
    found = answer["result"]["value"]["violations"]
    return [f"{rule['id']}: {node['html']} {node['failureSummary']}" for rule in found for node in rule["nodes"]]


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_the_page_with_all_that_it_can_show_breaks_no_rule(view_of: ViewOf, scheme: str) -> None:
    view = view_of(viewport={"width": 1280, "height": 720}, color_scheme=scheme).open("?preset=trio")
    for name in ("Cut", "Fall", "Floor and walls", "Optics", "Speed and exactness"):
        view.page.get_by_role("button", name=name, exact=True).click()
    view.page.get_by_label("Bands").focus()
    view.page.locator("#panel .hint").wait_for()
    view.page.get_by_role("button", name="Record a clip").press("Enter")
    view.page.get_by_label("Exactness", exact=True).last.fill("7")
    view.page.keyboard.press("Tab")
    for told in (".toast.task", ".toast.note", "#welcome"):
        view.page.locator(told).wait_for(state="attached")
    assert violations(view) == []
    view.page.keyboard.press("?")
    assert violations(view) == []


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_a_phone_with_its_panel_open_or_closed_breaks_no_rule(view_of: ViewOf, scheme: str) -> None:
    viewport = {"width": 390, "height": 700}
    view = view_of(viewport=viewport, has_touch=True, is_mobile=True, color_scheme=scheme).open("?preset=trio")
    view.page.locator("#welcome").wait_for()
    assert violations(view) == []
    for name in ("culet", "Stones", "Surroundings", "Pictures and scenes", "Move", "Fall"):
        view.page.get_by_role("button", name=name, exact=True).tap()
    panel = view.page.locator("#panel > .section").bounding_box()
    assert panel is not None
    assert panel["y"] >= viewport["height"] / 2 - 1, "the picture is above it"
    assert violations(view) == []


def test_what_stands_in_the_way_breaks_no_rule(view_of: ViewOf) -> None:
    view = view_of()
    view.page.goto(f"{view.server.url}/?session=nonsense")
    view.page.get_by_role("alertdialog").wait_for()
    assert violations(view) == []


def test_every_entry_of_a_list_is_reached_by_arrows_and_letters_act_meanwhile(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    materials = view.page.get_by_label("Material", exact=True)
    materials.locator("option", has_text="Glass").wait_for(state="attached")
    materials.focus()
    camera = view.scene["camera"]
    for _ in range(3):
        view.page.keyboard.press("ArrowDown")
    view.until("() => culet.state.scene.stones[0].material === 'cubic-zirconia'")
    view.page.locator("#panel .facts", has_text="index 2.1").wait_for()
    view.page.keyboard.press("m")
    view.until("() => culet.state.mirror")
    assert materials.evaluate("list => list === document.activeElement")
    assert view.scene["camera"] == camera
    slider = view.page.get_by_role("slider", name="Exactness")
    view.page.get_by_role("button", name="Speed and exactness").press("Enter")
    slider.focus()
    view.page.keyboard.press("End")
    view.until("() => culet.state.exactness === 1")


def test_a_first_visit_is_told_what_to_do_until_something_is_done(view_of: ViewOf) -> None:
    view = view_of().open()
    line = view.page.locator("#welcome")
    line.get_by_text("? shows all keys").wait_for()
    view.page.keyboard.press("?")
    line.wait_for(state="hidden")
    card = view.page.get_by_role("dialog", name="Keys")
    for name in ("Fall or pause", "Throw the stone", "Save the picture"):
        card.get_by_text(name).wait_for()
    view.page.keyboard.press("Escape")
    card.wait_for(state="hidden")
    view.page.reload()
    view.until("() => window.culet && culet.framesShown > 0")
    assert not line.is_visible()


def test_all_but_the_picture_is_hidden_and_comes_back(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    panel, strip = view.page.locator("#panel"), view.page.locator("#strip")
    view.page.keyboard.press("h")
    for part in (panel, strip, view.page.locator("#foot")):
        part.wait_for(state="hidden")
    view.until("([width, height]) => culet.lastFrame.width === width", list(WITH_PANEL.values()))
    view.page.locator("#picture").click()
    for part in (panel, strip):
        part.wait_for()
    view.page.keyboard.press("h")
    view.page.keyboard.press("Escape")
    panel.wait_for()

"""One ray, drawn over the picture and told in a table."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from documents.pages import read
from e2e.conftest import ViewOf
from e2e.test_accessibility import violations


def prism() -> str:
    """What the lesson's link has behind the address of the page."""
    (found,) = re.findall(
        r"\[A prism of glass.*?\]\(http://127\.0\.0\.1:8000/(#view=[^)]+)\)", read("docs/tutorial/teaching.md")
    )
    return str(found)


def test_a_lessons_ray_is_drawn_and_told_and_the_arrow_keys_go_through_it(view_of: ViewOf) -> None:
    view = view_of(viewport={"width": 1000, "height": 700}).open(prism())
    page = view.page
    page.keyboard.press("t")
    rows = page.locator("#ray-card tbody tr")
    rows.first.wait_for()
    assert rows.nth(2).inner_text().split("\t")[2:4] == ["totally reflected at pavilion 1 side", "45.0\N{DEGREE SIGN}"]
    expect(page.locator("#ray-card [role=status]")).to_contain_text("100\N{NO-BREAK SPACE}% of this pixel")
    view.until("() => document.querySelectorAll('#ray .light line').length > 6")  # red, green and blue of some steps
    page.locator("#ray-card tr[aria-selected=true]").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    chosen = page.locator("#ray-card tr[aria-selected=true]")
    expect(chosen.locator("td").first).to_have_text("2")
    expect(page.locator("#ray-card dl")).to_contain_text("Critical angle")
    page.locator("#ray .marks circle").first.wait_for()
    before = page.locator("#ray .light line").last.get_attribute("x2")
    page.mouse.move(600, 300)
    page.mouse.down()
    page.mouse.move(680, 330, steps=4)
    page.mouse.up()
    view.until("x => [...document.querySelectorAll('#ray .light line')].at(-1)?.getAttribute('x2') !== x", before)
    assert violations(view) == []
    chosen.focus()
    page.keyboard.press("Escape")
    page.locator("#ray-card").wait_for(state="detached")
    expect(page.locator("#ray")).to_have_count(0)
    page.keyboard.press("t")
    page.locator("#ray-card").wait_for()
    # Also before there is a step: the arrow keys leave the camera alone.
    expect(page.locator("#ray-card:focus, #ray-card :focus")).to_have_count(1)
    rows.first.wait_for()
    page.locator("#picture").focus()  # a click would lead the focus back into the card
    page.keyboard.press("Escape")
    page.locator("#ray-card").wait_for(state="detached")
    assert view.problems == []


@pytest.mark.parametrize("width", [1280, 800, 390])
def test_what_the_page_tells_covers_no_table_of_a_ray(view_of: ViewOf, width: int) -> None:
    view = view_of(viewport={"width": width, "height": 700}).open(prism())
    view.page.keyboard.press("t")
    card, toast = view.page.locator("#ray-card"), view.page.locator(".toast", has_text="nothing to undo")
    card.locator("tbody tr").first.wait_for()
    view.page.keyboard.press("Control+z")
    told, table = toast.bounding_box(), card.bounding_box()
    assert told is not None
    assert table is not None
    beside = told["x"] >= table["x"] + table["width"]
    assert beside or told["y"] + told["height"] <= table["y"]


def test_on_a_phone_the_panel_gives_its_place_to_the_table(view_of: ViewOf) -> None:
    view = view_of(viewport={"width": 390, "height": 500}, has_touch=True).open(prism())
    for folded in ("culet", "Stone"):
        view.page.get_by_role("button", name=folded, exact=True).tap()
    view.page.get_by_role("button", name="Draw one ray").tap()
    view.page.locator("#ray-card tbody tr").first.wait_for()  # that is seen
    assert not view.page.locator("#fall").is_visible()
    assert view.problems == []

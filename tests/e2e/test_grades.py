"""The stone's grades in the panel, and its cutting diagram."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.view import View


@pytest.fixture
def wide_view(view_of: ViewOf) -> View:
    """With the panel."""
    return view_of(viewport=WITH_PANEL).open()


def brightness_of(view: View) -> Locator:
    """Where it stands once the table is of the stone as it is."""
    table = view.page.locator("table.grades:not(.outdated)")
    return table.locator("tr", has_text="Brightness, ISO").locator("td").first


def per_cent(text: str) -> float:
    """ISO."""
    return float(text.removesuffix(" %"))


def test_grades_are_of_the_stone_as_it_is_cut_and_its_tilt_curves_are_drawn(wide_view: View) -> None:
    view = wide_view
    view.page.get_by_role("button", name="Grades").click()
    before = brightness_of(view).inner_text()
    assert 70 < per_cent(before) < 90
    view.page.get_by_role("button", name="Cut", exact=True).click()
    view.change(lambda: view.page.get_by_label("Shape").select_option(label="Rose"))
    expect(brightness_of(view)).not_to_have_text(before)
    assert abs(per_cent(brightness_of(view).inner_text()) - per_cent(before)) > 5
    view.page.get_by_role("button", name="Tilt curves").click()
    view.page.locator(".tilt-plot canvas").wait_for()
    assert view.problems == []


def test_the_cutting_diagram_of_the_chosen_stone_opens(wide_view: View) -> None:
    view = wide_view
    view.page.get_by_role("button", name="Cut", exact=True).click()
    with view.page.context.expect_page() as opened:
        view.page.get_by_role("button", name="Cutting diagram").click()
    opened.value.wait_for_load_state()
    assert "Round brilliant" in opened.value.content()
    assert " ct at " in opened.value.content()
    assert view.problems == []

"""Several stones on the page: one is chosen, outlined and edited; others are added, removed and scattered."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View

CAMERA = {"position": [0, 0, 12], "target": [0, 0, 0], "fov_degrees": 40}
STONES = [
    {"id": "left", "position": [-2, 0, 0], "material": "ruby"},
    {"id": "right", "position": [2, 0, 0], "material": "sapphire"},
]
SCENE: dict[str, Any] = {"stones": STONES, "camera": CAMERA, "simulation": {"gravity": 0}}
LEFT_OF_THE_MIDDLE, RIGHT_OF_THE_MIDDLE, ABOVE = -0.46, 0.46, 0.8
"""Halves of the picture's height: 2 R are 0.458 of what is seen at 12 R."""


@pytest.fixture
def view(view_of: ViewOf, server: Server) -> View:
    """Of two stones side by side, with the panel."""
    answer = server.http.post("/api/sessions", json={"scene": SCENE})
    assert answer.status_code == 201, answer.text
    view = view_of(viewport=WITH_PANEL).open(f"?session={answer.json()['id']}")
    view.at_rest()
    return view


def click(view: View, x: float, y: float = 0.0) -> None:
    """At a point of the picture."""
    half = WITH_PANEL["height"] / 2
    view.page.mouse.click(WITH_PANEL["width"] / 2 + half * x, half - half * y)


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
    half = WITH_PANEL["height"] / 2
    for name, x in (("left", LEFT_OF_THE_MIDDLE), ("right", RIGHT_OF_THE_MIDDLE)):
        click(view, x)
        chosen(view, name)
        middle = (outline(view).min(axis=0) + outline(view).max(axis=0)) / 2
        assert middle == pytest.approx([WITH_PANEL["width"] / 2 + half * x, half], abs=12)
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
    assert material.input_value() == "sapphire"
    view.change(lambda: material.select_option(label="emerald"))
    assert [stone["material"] for stone in view.scene["stones"]] == ["ruby", "emerald"]
    assert other.page.get_by_label("Material", exact=True).input_value() == "ruby", "of the first, as long as none is"


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

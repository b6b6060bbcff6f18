"""Addresses that lead to no session."""

from __future__ import annotations

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View


@pytest.mark.parametrize(
    ("query", "text"),
    [
        pytest.param("session=" + "0" * 32, "There is no such session (any more)", id="unknown"),
        pytest.param("session=<b>nonsense", "<b>nonsense is not the id of a session", id="not-an-id"),
        pytest.param("preset=rubi", "no preset 'rubi'; there are: default, ", id="no-preset"),
    ],
)
def test_an_address_without_a_session_says_so_and_offers_a_new_one(
    view_of: ViewOf, server: Server, query: str, text: str
) -> None:
    view = view_of()
    view.refusals.add(404)
    view.page.goto(f"{server.url}/?{query}")
    obstacle = view.page.get_by_role("alertdialog")
    obstacle.wait_for()
    assert text in obstacle.inner_text()
    obstacle.get_by_role("button", name="Start a new session").click()
    view.until("() => window.culet && culet.framesShown > 0")
    assert re.fullmatch("[0-9a-f]{32}", view.session)
    assert server.session(view.session)["viewers"] == 1


def test_a_session_that_ends_while_it_is_watched_says_so(view: View, server: Server) -> None:
    assert server.http.delete(f"/api/sessions/{view.session}").status_code == 204
    obstacle = view.page.get_by_role("alertdialog")
    obstacle.wait_for()
    assert "There is no such session (any more)" in obstacle.inner_text()
    assert view.connection == "closed"


def test_a_preset_that_does_not_exist_is_named_with_those_that_do(view_of: ViewOf, server: Server) -> None:
    view = view_of()
    view.refusals.add(404)
    view.page.goto(f"{server.url}/?preset=coal")
    obstacle = view.page.get_by_role("alertdialog")
    obstacle.wait_for()
    for name in ("coal", "default", "classic"):
        assert name in obstacle.inner_text()


def test_an_address_asks_for_a_background_of_live_pictures_and_for_the_legend_alone(view_of: ViewOf) -> None:
    view = view_of().open("?preset=aset&ui=0&legend=1&background=1f3a5f")
    corner = view.at_rest().pixels[0, 0]
    assert np.abs(corner - (0x1F, 0x3A, 0x5F)).max() <= 4  # a JPEG's; without it 0, 0, 0
    assert view.scene["film"]["background"] == "#1f3a5f"
    legend = view.page.locator("#legend")
    expect(legend).to_contain_text("Your head")
    assert not view.page.locator("#panel").is_visible()
    view.page.goto(view.page.url.replace("&legend=1", ""))
    view.until("() => window.culet && culet.framesShown > 0")
    assert not legend.is_visible()

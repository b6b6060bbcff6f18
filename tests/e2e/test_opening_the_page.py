"""From the address to a picture."""

from __future__ import annotations

import re
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Request, expect

from e2e.conftest import SMALL, ViewOf
from e2e.server import Server
from e2e.view import View, difference, pixels_of

JPEG = 2.5
"""Mean difference, of 255, that compression may make. Measured at quality 92: default 1.2, matte 1.6, classic 0.7."""


def test_a_new_page_opens_a_session_and_puts_its_id_into_the_url(view: View, server: Server) -> None:
    assert re.fullmatch(rf"{re.escape(server.url)}/\?session=[0-9a-f]{{32}}", view.page.url)
    session = server.session(view.session)
    assert session["viewers"] == 1
    assert session["scene"] == view.scene
    assert session["scene"]["floor"]["kind"] == "matte", "the preset named in the address"


@pytest.mark.parametrize("preset", ["default", "matte", "classic"])
def test_the_canvas_shows_what_the_server_renders(view_of: ViewOf, server: Server, preset: str) -> None:
    view = view_of().open(f"?preset={preset}")
    seen = view.at_rest()
    answer = server.http.get(f"/api/sessions/{view.session}/frame.tga", params={"step": seen.frame["step"]})
    still = pixels_of(answer.content)
    assert still.shape == (SMALL["height"], SMALL["width"], 3)
    assert still.std() > 5, "a picture of something"
    assert difference(seen.pixels, still) < JPEG


def test_the_first_picture_needs_less_than_60_kilobytes_of_script(view_of: ViewOf) -> None:
    """As they come over the line, compressed. Measured: 31."""
    view = view_of()
    requests: list[Request] = []

    def finished(request: Request) -> None:
        requests.append(request)

    view.page.on("requestfinished", finished)
    view.open()
    scripts = [request for request in requests if request.resource_type == "script"]
    sizes = {script.url: script.sizes()["responseBodySize"] for script in scripts}
    assert 10_000 < sum(sizes.values()) < 60_000, sizes


def test_a_page_asks_for_its_session_before_the_lists_of_what_there_is(view_of: ViewOf) -> None:
    """Nothing that the first picture does not need stands in its way; the lists come by themselves afterwards."""
    view = view_of()
    asked: list[str] = []
    view.page.on("request", lambda request: asked.append(urlsplit(request.url).path))
    view.open()
    view.page.locator("#scenes button").first.wait_for(state="attached")
    view.settle_messages()  # all lists are asked for at once
    interface = [path for path in asked if path.startswith("/api/")]
    assert interface[0] == "/api/sessions"
    assert {"/api/presets", "/api/materials", "/api/cuts", "/api/skies", "/api/integrators"} <= set(interface[1:])


def test_a_page_opened_while_the_engine_is_away_opens_by_itself_once_it_is_back(
    view_of: ViewOf, server: Server
) -> None:
    view = view_of()
    view.refusals.add(503)
    with server.engine_gone():
        view.page.goto(f"{server.url}/?preset=matte")
        card = view.page.get_by_role("alertdialog")
        card.get_by_text(re.compile(r"Trying again in ([2-9]|\d\d) s")).wait_for()  # the fourth pause, or a later one
        expect(card).to_contain_text("the render process is not running")
        card.get_by_role("button", name="Try now").click()
        card.get_by_text(re.compile(r"Trying again in ([4-9]|\d\d) s")).wait_for()  # meanwhile it may have tried itself
    view.until("() => culet.framesShown > 0")
    assert not card.is_visible()
    assert view.problems == []

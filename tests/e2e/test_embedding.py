"""The page in a page of another site: a shop that the server lets in, and the custom element there."""

from __future__ import annotations

import math
import time
from typing import Any

from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Frame, Page

from e2e.server import PATIENCE, SHOP, Server

WORDS = """<!doctype html><title>shop</title>
<script>document.addEventListener("error", event => {{ window.why = event.message }}, true)</script>
<script type="module" src="{server}/element/culet-viewer.js"></script>
<culet-viewer {attributes} alt="A diamond" style="width: 320px; height: 240px"></culet-viewer>"""


def shop(browser: Browser, server: Server, attributes: str) -> BrowserContext:
    context = browser.new_context(viewport={"width": 400, "height": 300})
    context.set_default_timeout(PATIENCE * 1e3)
    words = WORDS.format(server=server.url, attributes=attributes)
    context.route(f"{SHOP}/**", lambda route: route.fulfill(body=words, content_type="text/html"))
    return context


def framed(page: Page) -> Frame:
    """The page within, once it is shown."""
    page.locator("culet-viewer iframe.shown").wait_for()
    return page.frames[1]


def azimuth(frame: Frame) -> float:
    """Degrees, counter-clockwise seen from above."""
    camera: dict[str, Any] = frame.evaluate("() => culet.state.scene.camera")
    x, z = (camera["position"][axis] - camera["target"][axis] for axis in (0, 2))
    return math.degrees(math.atan2(x, z))


def test_a_shops_page_shows_a_poster_first_and_then_turns_the_stone_without_interface_or_cookies(
    browser: Browser, server: Server
) -> None:
    context = shop(browser, server, 'preset="matte" rotate="40"')
    page = context.new_page()
    messages: list[ConsoleMessage] = []

    def logged(message: ConsoleMessage) -> None:
        messages.append(message)

    page.on("console", logged)
    page.goto(f"{SHOP}/stones")
    poster = page.locator("culet-viewer img")
    frame = framed(page)
    poster.evaluate("image => image.decode()")  # where it takes long, the live picture does not wait for it
    assert poster.evaluate("image => [image.complete, image.naturalWidth, image.alt]") == [True, 320, "A diamond"]
    assert frame.url.startswith(f"{server.url}/?session=")
    assert "ui=0&rotate=40" in frame.url
    shown = "() => [...document.querySelector('main').children].filter(each => each.checkVisibility()).map(e => e.id)"
    assert set(frame.evaluate(shown)) <= {"picture", "outline", "toasts", "announcement"}
    start, deadline = azimuth(frame), time.monotonic() + PATIENCE
    while (azimuth(frame) - start) % 360 < 5:
        assert time.monotonic() < deadline, "it never turned by 5 degrees"
        page.wait_for_timeout(20)
    assert context.cookies() == []
    assert [message.text for message in messages if message.type == "error"] == []
    session = frame.evaluate("() => culet.session")
    context.close()
    server.http.delete(f"/api/sessions/{session}")


def test_a_preset_that_the_server_has_not_is_named_in_the_pictures_place_and_in_an_event(
    browser: Browser, server: Server
) -> None:
    context = shop(browser, server, 'preset="rubi"')
    page = context.new_page()
    page.goto(f"{SHOP}/stones")
    obstacle = framed(page).get_by_role("alertdialog")
    assert "no preset 'rubi'; there are: default, " in obstacle.inner_text()
    assert page.evaluate("() => window.why") == obstacle.locator("#obstacle-text").inner_text()
    context.close()

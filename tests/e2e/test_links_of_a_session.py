"""The two links of a session, one of which only watches; and the token of a server that others can reach."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from culet_protocol.watch import watch_id
from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View, assert_same

TOKEN = "an-open-sesame-of-letters"  # noqa: S105 - of this test


def test_the_page_offers_a_link_that_steers_and_one_that_watches_with_its_code(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    view.page.get_by_role("button", name="Share this session").click()
    card = view.page.get_by_role("dialog", name="Share this session")
    steering, watching = (field.input_value() for field in card.locator("input").all())
    assert steering == f"{view.server.url}/?session={view.session}"
    assert watching == f"{view.server.url}/?watch={watch_id(view.session)}"
    code = card.get_by_role("img", name="The watching link as a QR code")
    code.wait_for()
    modules = code.evaluate("code => (code.firstChild.getAttribute('d').match(/M/g) || []).length")
    assert modules > 300, "a code of that many letters has some 500 dark modules"
    card.get_by_role("button", name="Close").click()
    card.wait_for(state="hidden")


def test_whoever_opens_the_watching_link_sees_what_others_do_and_does_nothing(view_of: ViewOf, view: View) -> None:
    guest = view_of().open(f"?watch={watch_id(view.session)}")
    assert urlsplit(guest.page.url).query == f"watch={watch_id(view.session)}"
    assert not guest.state["steers"]
    assert guest.page.get_by_role("button", name="Share this session").count() == 0
    view.until("() => culet.state.viewers === 2")
    before = view.at_rest()
    guest.page.keyboard.press("ArrowLeft")
    guest.page.mouse.move(100, 100)
    guest.page.mouse.down()
    guest.page.mouse.move(200, 120)
    guest.page.mouse.up()
    assert guest.sent == []
    _, after = view.change_by("m")
    assert_same(guest.at_rest(after=before.frame["step"]).pixels, after.pixels)
    assert np.abs(after.pixels - before.pixels).mean() > 1


def test_a_phone_that_watches_shows_all_of_the_picture_or_fills_its_window_with_it(
    view_of: ViewOf, view: View, tmp_path: Path
) -> None:
    view.at_rest()
    phone = {"viewport": {"width": 390, "height": 844}, "has_touch": True}
    guest = view_of(**phone).open(f"?watch={watch_id(view.session)}")
    edges = guest.at_rest().pixels[[0, -1]]
    assert edges.max() == 0, "black above and below a picture that lies"
    guest.page.screenshot(path=tmp_path / "whole.png")
    guest.page.get_by_role("button", name="Fill the window").tap()
    edges = guest.look().pixels[[0, -1]]
    assert edges.max(axis=2).min() > 0, "and nothing is black any more"
    guest.page.screenshot(path=tmp_path / "filled.png")
    guest.page.reload()
    guest.page.get_by_role("button", name="Show all of the picture").wait_for()
    guest.page.keyboard.press("g")
    guest.page.get_by_role("button", name="Fill the window").wait_for()
    assert guest.look().pixels[[0, -1]].max() == 0
    assert guest.sent == []


def test_a_window_of_the_pictures_shape_has_nothing_to_choose(view_of: ViewOf, view: View) -> None:
    guest = view_of().open(f"?watch={watch_id(view.session)}")
    guest.at_rest()
    assert not guest.page.locator("#fit").is_visible()
    view.page.keyboard.press("g")
    view.page.get_by_text("Only a window that watches").wait_for()


@pytest.fixture
def guarded(built_client: None, tmp_path: Path) -> Server:
    return Server(tmp_path, "--token", TOKEN, "--no-spare")


def test_a_page_is_let_in_by_the_token_of_its_address_and_stays_in(guarded: Server, browser: Browser) -> None:
    with guarded as server:
        stranger = View(browser.new_page(), server, refusals={401})
        stranger.page.goto(f"{server.url}/")
        stranger.page.get_by_text("This server asks for its token.", exact=False).wait_for()

        view = View(browser.new_page(), server)
        view.open(f"#token={TOKEN}")
        assert TOKEN not in view.page.url
        (cookie,) = view.page.context.cookies()
        assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
        assert TOKEN not in cookie["value"]
        assert view.page.evaluate("document.cookie") == ""
        view.open()  # another session, with the address alone

        stranger.open(f"?watch={watch_id(view.session)}")
        assert not stranger.state["steers"]
        for page in (stranger, view):
            page.page.context.close()
        assert view.complaints == stranger.complaints == []


def test_who_only_watches_sees_the_design_that_was_beside_the_one_that_comes(guarded: Server, browser: Browser) -> None:
    """Without the server's token, by the watching link alone."""
    with guarded as server:
        size = ViewportSize(width=384, height=216)
        view = View(browser.new_context(viewport=size).new_page(), server)
        view.open(f"#token={TOKEN}")
        guest = View(browser.new_context(viewport=size).new_page(), server)
        guest.open(f"?watch={watch_id(view.session)}")
        guest.at_rest()
        guest.page.keyboard.press("d")
        guest.page.get_by_text("This design is kept: when another one comes", exact=False).wait_for()
        patch = {"stones": {"stone": {"cut": "oval"}}}
        assert server.http.patch(f"/api/sessions/{view.session}", json=patch).status_code == 200
        kept = guest.page.get_by_alt_text("The kept design")
        kept.wait_for()
        expect(guest.page.get_by_role("slider", name="Divider")).to_have_value("50")
        guest.page.keyboard.press("d")
        kept.wait_for(state="detached")
        assert guest.sent == []
        for page in (guest, view):
            page.page.context.close()
        assert view.complaints == guest.complaints == []

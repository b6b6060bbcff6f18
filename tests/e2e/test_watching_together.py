"""A second page on the same address, and a page that nobody looks at."""

from __future__ import annotations

from urllib.parse import urlsplit

import numpy as np

from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View, assert_same

HIDE = """hidden => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
  Object.defineProperty(document, "visibilityState", { configurable: true, get: () => hidden ? "hidden" : "visible" });
  document.dispatchEvent(new Event("visibilitychange"));
}"""
"""What a page hears when its tab goes to the back; a headless browser has no tab in front of others."""


def another(view_of: ViewOf, view: View) -> View:
    """A second visitor at the address that the first one's page has now."""
    return view_of().open(f"?{urlsplit(view.page.url).query}")


def test_two_pages_at_one_address_see_the_same_and_each_others_edits(
    view_of: ViewOf, view: View, server: Server
) -> None:
    guest = another(view_of, view)
    assert guest.session == view.session
    for page in (view, guest):
        page.until("() => culet.state.viewers === 2")
        page.page.get_by_text("2 viewers", exact=False).first.wait_for()
    assert server.session(view.session)["viewers"] == 2
    server.until_equal("viewers", 2)  # once those of earlier tests are gone

    start = view.at_rest()
    assert_same(guest.at_rest().pixels, start.pixels)
    for editor, onlooker, key, part, kind in (
        (guest, view, "w", "walls", "matte"),
        (view, guest, "m", "floor", "mirror"),
    ):
        before = onlooker.look().frame["step"]
        _, after = editor.change_by(key)
        onlooker.until("([part, kind]) => culet.state.scene[part].kind === kind", [part, kind])
        assert_same(onlooker.at_rest(after=before).pixels, after.pixels)
        assert onlooker.scene == editor.scene
        assert np.abs(after.pixels - start.pixels).mean() > 1

    assert view.sent == [{"type": "toggle_mirror"}]
    guest.page.close()
    view.until("() => culet.state.viewers === 1")
    view.page.get_by_text("1 viewer", exact=False).first.wait_for()


def test_what_is_moved_is_each_viewers_own_choice(view_of: ViewOf, view: View) -> None:
    guest = another(view_of, view)
    guest.page.keyboard.press("1")
    assert (view.state["target"], guest.state["target"]) == ("camera", "light_1")


def test_who_has_watched_longest_has_the_size_and_others_see_the_whole_picture(view_of: ViewOf, view: View) -> None:
    guest = view_of(viewport={"width": 200, "height": 300}).open(f"?{urlsplit(view.page.url).query}")
    guest.until("() => culet.state.viewers === 2")
    before = view.change_by("m")[1].frame  # rendered with both of them there
    assert (before["width"], before["height"]) == (384, 216)
    letterboxed = guest.at_rest(after=before["step"] - 1)
    assert (letterboxed.frame["width"], letterboxed.frame["height"]) == (384, 216)
    above, below = letterboxed.pixels[:90], letterboxed.pixels[-90:]
    middle = letterboxed.pixels[100:-100]
    assert (above.max(), below.max()) == (0, 0), "black above and below a picture that lies"
    assert middle.min(axis=(0, 1)).max() > 0, "and the picture between"
    view.page.evaluate(HIDE, True)
    guest.until("() => culet.lastFrame.width === 200 && culet.lastFrame.height === 300")


def test_a_hidden_page_costs_nothing_and_goes_on_when_it_is_seen_again(bouncing: View, server: Server) -> None:
    view = bouncing
    server.until_equal("engine_sessions_watched", 1)  # once those of earlier tests are closed

    view.page.evaluate(HIDE, True)
    server.until_equal("engine_sessions_watched", 0)
    names = ("engine_frames_rendered", "engine_refinements", "engine_frames_sent", "frames_sent_total")
    for _ in range(30):  # frames may have been on their way
        before, shown = server.metrics(), view.number("framesShown")
        server.live_for(1)
        after = server.metrics()
        if all(after[name] == before[name] for name in names) and view.number("framesShown") == shown:
            break
    assert {name: after[name] - before[name] for name in names} == dict.fromkeys(names, 0.0)
    assert view.number("framesShown") == shown
    assert view.connection == "open"

    view.page.evaluate(HIDE, False)
    view.until("shown => culet.framesShown > shown + 3", shown)
    assert view.number("outOfOrder") == 0
    assert server.metrics()["engine_frames_rendered"] > after["engine_frames_rendered"]


def test_a_page_that_is_seen_gets_its_frames_while_another_is_hidden(view_of: ViewOf, view: View) -> None:
    guest = another(view_of, view)
    hidden_at = guest.at_rest().frame["step"]
    guest.page.evaluate(HIDE, True)
    guest.reach()  # the server has heard of it
    view.change_by("m")
    guest.until("() => culet.state.scene.floor.kind === 'mirror'")  # notices still come
    assert guest.look().frame["step"] == hidden_at
    guest.page.evaluate(HIDE, False)
    assert_same(guest.at_rest(after=hidden_at).pixels, view.look().pixels)

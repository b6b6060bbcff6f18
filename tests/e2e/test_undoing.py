"""Undo and redo in the page: by keys and by buttons, for all who watch."""

from __future__ import annotations

from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Locator, expect

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View, assert_same, difference

SEEN = 1
"""Mean difference, of 255, that an edit must make. Measured: 4.4 (ruby)."""


DRAG = """async (range, parts) => {
  for (const part of parts) {
    range.value = +range.min + part * (range.max - range.min);
    range.dispatchEvent(new Event("input"));
    await new Promise(requestAnimationFrame);
  }
  range.dispatchEvent(new Event("change"));
}"""
"""By the page itself: edits are one if they are less than a second apart, which a mouse led from here may not be."""


@pytest.fixture
def view(view_of: ViewOf) -> View:
    """With the panel."""
    return view_of(viewport=WITH_PANEL).open()


def button(view: View, name: str) -> Locator:
    return view.page.get_by_role("button", name=name)


def choose_ruby(view: View) -> None:
    view.page.get_by_label("Material", exact=True).select_option(label="Ruby")


def test_edits_are_undone_and_made_again_by_keys_and_buttons_of_whoever_watches(
    view: View, view_of: ViewOf, server: Server
) -> None:
    guest = view_of(viewport=WITH_PANEL).open(f"?{urlsplit(view.page.url).query}")
    first = view.scene
    for page in (view, guest):
        expect(button(page, "Undo")).to_be_disabled()
        expect(button(page, "Redo")).to_be_disabled()
    before, ruby = view.change(lambda: choose_ruby(view))
    assert difference(before.pixels, ruby.pixels) > SEEN
    view.change_by("m")
    last = view.scene
    expect(button(guest, "Undo")).to_be_enabled()
    _, after = guest.change_by("Control+z")
    assert_same(after.pixels, ruby.pixels)
    _, after = guest.change(button(guest, "Undo").click)
    assert_same(after.pixels, before.pixels)
    assert server.session(view.session)["scene"] == first
    expect(button(view, "Undo")).to_be_disabled()
    expect(button(guest, "Redo")).to_be_focused()  # the other button would have lost the keyboard's place
    _, after = view.change(button(view, "Redo").click)
    assert_same(after.pixels, ruby.pixels)
    expect(view.page.get_by_label("Material", exact=True)).to_have_value("ruby")
    view.change_by("Control+y")
    assert server.session(view.session)["scene"] == last
    for keys in ("Control+z", "Control+Shift+z"):
        view.change_by(keys)
    assert server.session(view.session)["scene"] == last
    expect(button(view, "Redo")).to_be_disabled()
    assert (view.problems, guest.problems) == ([], [])


def test_a_sliders_drag_is_one_step(view: View, server: Server) -> None:
    first = view.scene
    button(view, "Cut").click()
    slider = view.page.get_by_role("slider", name="Pavilion")
    before, _ = view.change(lambda: slider.evaluate(DRAG, [0.2, 0.4, 0.6, 0.9]))
    cuts = [message["type"] for message in view.sent].count("patch_scene")
    presses = 0
    while server.session(view.session)["scene"] != first:  # on a busy machine two cuts may be more than a second apart
        _, after = view.change_by("Control+z")
        presses += 1
    assert presses < cuts
    assert_same(after.pixels, before.pixels)
    expect(button(view, "Undo")).to_be_disabled()


def test_a_key_without_anything_to_undo_says_so(view: View) -> None:
    for keys, said in (("Control+z", "nothing to undo"), ("Control+y", "nothing to redo")):
        view.page.keyboard.press(keys)
        expect(view.page.locator(".toast.note").last).to_contain_text(said)
    assert (view.sent, view.problems) == ([], [])

"""What the page says by itself: that a picture is coming, where the stone is, that it is at rest, what was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from culet_protocol.frame import Flags
from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View, difference

NO_PICTURE = "window.createImageBitmap = () => new Promise(() => {})"
"""Then none is ever decoded."""


RECORD_IT = """box => {
  window.was = [];
  let [time, last] = [0, null];
  const look = () => {
    const { simulationTime } = culet.lastFrame;
    if (simulationTime < time) was.push("began anew");
    time = simulationTime;
    const { falling, asleep } = culet.state;
    const is = `${falling} ${asleep} ${box.checked}`;
    if (last !== is) was.push((last = is));
    requestAnimationFrame(look);
  };
  look();
}"""
"""By the page itself: a stone lies still after two seconds, in which a look from here may come too late."""


@pytest.fixture
def wide_view(view_of: ViewOf) -> View:
    """With the panel."""
    return view_of(viewport=WITH_PANEL).open()


def test_a_page_without_a_picture_says_that_and_why_in_its_middle(view_of: ViewOf, server: Server) -> None:
    view = view_of()
    view.page.add_init_script(NO_PICTURE)
    view.page.goto(server.url)
    waiting = view.page.locator("#waiting")
    waiting.get_by_text("compiles its kernels").wait_for()
    assert waiting.inner_text().startswith("Waiting for the first picture")
    box = waiting.bounding_box()
    assert box is not None
    width, height = view.page.evaluate("() => [innerWidth, innerHeight]")
    assert (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2) == pytest.approx((width / 2, height / 2), abs=1)


def test_the_words_go_with_the_first_picture(view: View) -> None:
    assert not view.page.locator("#waiting").is_visible()
    assert not view.page.locator("#banner").is_visible()
    assert not view.page.locator("#unseen").is_visible()


def put_stone(view: View, server: Server, position: tuple[float, float, float]) -> None:
    """Let the fall begin there."""
    view.at_rest()
    (stone,) = view.scene["stones"]
    patch = {"stones": [stone | {"position": position}]}
    assert server.http.patch(f"/api/sessions/{view.session}", json=patch).status_code == 200


def test_a_stone_above_the_picture_is_said_to_be_there_until_it_falls(view: View, server: Server) -> None:
    unseen = view.page.locator("#unseen")
    put_stone(view, server, (0, 8, 0))
    unseen.get_by_text("The stone is above the picture. P lets it fall").wait_for()
    view.page.keyboard.press("p")
    unseen.wait_for(state="hidden")


def test_a_stone_that_came_to_rest_beside_the_picture_is_looked_at_by_the_button(view: View, server: Server) -> None:
    unseen = view.page.locator("#unseen")
    put_stone(view, server, (12, 1, 0))
    view.page.keyboard.press("p")
    view.until("() => culet.state.asleep")
    unseen.get_by_text("The stone is to the right of the picture.").wait_for()
    empty = view.at_rest()
    assert empty.frame["flags"] & Flags.RIGHT
    unseen.get_by_role("button", name="Look at it").click()
    unseen.wait_for(state="hidden")
    seen = view.at_rest(after=empty.frame["step"])
    assert seen.frame["simulationTime"] == empty.frame["simulationTime"], "the stone lies where it lay"
    height, width, _ = seen.pixels.shape
    middle = np.s_[height // 3 : 2 * height // 3, width // 3 : 2 * width // 3]
    assert difference(seen.pixels[middle], empty.pixels[middle]) > 20  # measured 61 of 255
    assert view.sent[-1] == {"type": "look_at_stone"}


def test_a_stone_that_sleeps_is_not_shown_as_falling_and_falls_anew(wide_view: View) -> None:
    view = wide_view
    falling = view.page.get_by_label("Falling")
    falling.evaluate(RECORD_IT)
    view.page.keyboard.press("p")
    view.until("() => culet.state.asleep")
    assert not falling.is_checked()
    assert view.page.evaluate("() => was") == ["false false false", "true false true", "true true false"]
    assert view.page.locator("#announcement").inner_text() == "the stone is at rest"
    view.at_rest()
    falling.click()
    view.until("() => was.includes('began anew') && was.slice(3).includes('true false true')")
    assert view.problems == []


def test_without_a_stone_nothing_about_one_is_offered(wide_view: View, server: Server) -> None:
    view = wide_view
    material, fall, cut = (
        view.page.get_by_label("Material", exact=True),
        view.page.locator("#panel").get_by_role("button", name="Fall"),
        view.page.get_by_role("button", name="Cut"),
    )
    for offered in (material, fall, cut):
        offered.wait_for()
    assert server.http.patch(f"/api/sessions/{view.session}", json={"stones": []}).status_code == 200
    for offered in (material, fall, cut):
        offered.wait_for(state="hidden")


def test_findings_go_by_themselves_and_problems_stay(wide_view: View, tmp_path: Path) -> None:
    view = wide_view
    sky, mesh = tmp_path / "sky.png", tmp_path / "empty.obj"
    Image.new("RGB", (64, 32)).save(sky)
    mesh.write_text("")
    view.refusals.add(422)
    view.open_file("Open a mesh", mesh)
    problem, finding = (view.page.locator(f".toast.{kind}") for kind in ("problem", "finding"))
    problem.wait_for()
    view.open_file("Open a sky", sky)
    finding.wait_for()
    finding.hover()
    view.page.evaluate("() => new Promise(done => setTimeout(done, 9000))")  # longer than it lives unless it is read
    assert finding.is_visible()
    view.page.mouse.move(0, 0)
    finding.wait_for(state="detached")
    assert problem.is_visible()

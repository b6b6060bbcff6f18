"""Clips of what is seen, saved as films, and played back by the browser."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any, cast

import pytest

from e2e.conftest import SMALL, WITH_PANEL, ViewOf
from e2e.server import PATIENCE
from e2e.view import View

FILES = {"mp4": b"ftyp", "webm": b"\x1aE\xdf\xa3"}
"""What the first bytes of each kind of film have in them: ISO 14496-12, and EBML's RFC 8794."""

CHANGED = 1.0
"""Of 255, by how much the last picture differs from the first in the mean, at least. Measured: 25."""

PLAY = """async ([type, data, patience]) => {
  const video = document.createElement("video");
  video.muted = true;
  video.src = `data:${type};base64,${data}`;
  await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(video.error.message); });
  const context = new OffscreenCanvas(video.videoWidth, video.videoHeight).getContext("2d");
  const colours = pixels => pixels.filter((_, k) => k % 4 !== 3);
  const mean = pixels => colours(pixels).reduce((sum, value) => sum + value, 0) / colours(pixels).length;
  const until = performance.now() + patience;
  // A place is found before its picture can be drawn: until then nothing is drawn, or the picture of the place before.
  const at = async (part, isDrawn) => {
    const sought = new Promise(done => { video.onseeked = done; });
    video.currentTime = part * video.duration;
    await sought;
    for (;;) {
      context.drawImage(video, 0, 0);
      const pixels = context.getImageData(0, 0, video.videoWidth, video.videoHeight).data;
      if (isDrawn(pixels) || performance.now() > until) return pixels;
      await new Promise(done => setTimeout(done, 20));
    }
  };
  const first = await at(0, pixels => pixels[3] === 255);
  const difference = pixels => mean(pixels.map((value, k) => Math.abs(value - first[k])));
  const changed = difference(await at(1, pixels => difference(pixels) > CHANGED));
  const brightness = mean(first);
  return { width: video.videoWidth, height: video.videoHeight, seconds: video.duration, changed, brightness };
}""".replace("CHANGED", str(CHANGED))


def played(view: View, film: Path) -> dict[str, Any]:
    """A film in a page of its own: its size, its length, and how much the picture at its end differs from the first."""
    ending = film.suffix[1:]
    data = film.read_bytes()
    assert FILES[ending] in data[:12]
    page = view.page.context.new_page()  # the policy of culet's own page lets it play nothing
    answer = page.evaluate(PLAY, [f"video/{ending}", base64.b64encode(data).decode(), 1000 * PATIENCE])
    page.close()
    return cast(dict[str, Any], answer)


def turn(view: View, pictures: int = 8) -> None:
    """Turn the camera by keys, some pictures long, each of which is seen."""
    for _ in range(pictures):
        step = view.page.evaluate("() => culet.lastFrame.step")
        view.page.keyboard.press("Shift+ArrowLeft")
        view.until("step => culet.lastFrame.step > step", step)


def saved(view: View, tmp_path: Path, key: str) -> Path:
    with view.page.expect_download() as download:
        view.page.keyboard.press(key)
    film = tmp_path / download.value.suggested_filename
    download.value.save_as(film)
    return film


def test_the_last_seconds_are_saved_as_a_film_that_plays(view: View, tmp_path: Path) -> None:
    view.at_rest()
    turn(view)
    film = played(view, saved(view, tmp_path, "b"))
    assert (film["width"], film["height"]) == (SMALL["width"], SMALL["height"])
    assert 0.2 < film["seconds"] <= 10.1
    assert film["changed"] > CHANGED
    assert film["brightness"] > 80  # measured: 162
    assert view.page.locator(".toast.task").count() == 0


@pytest.mark.parametrize("encoders", [True, False], ids=["with encoders", "as by plain http"])
def test_the_next_seconds_are_recorded_until_told_to_stop(view_of: ViewOf, tmp_path: Path, encoders: bool) -> None:
    view = view_of(viewport=WITH_PANEL)
    if not encoders:
        view.page.add_init_script("delete window.VideoEncoder")
    view.open()
    view.page.keyboard.press("n")
    view.page.get_by_text("Recording, for").wait_for()
    turn(view, 3)  # before it ends by itself
    view.page.wait_for_timeout(500)  # a recorder by plain http takes pictures at times of its own: the last one too
    film = played(view, saved(view, tmp_path, "n"))
    assert film["width"] / film["height"] == pytest.approx(350 / 240, rel=0.02)
    assert 0.2 < film["seconds"] < 10.5
    assert film["changed"] > CHANGED


def test_a_clip_that_is_not_wanted_any_more_is_given_up(view_of: ViewOf) -> None:
    view = view_of()
    view.page.add_init_script("delete window.VideoEncoder")  # a recorder takes as long as the clip is
    view.open()
    view.at_rest()
    turn(view)
    view.page.keyboard.press("b")
    view.page.get_by_role("progressbar", name="Making the clip").wait_for()
    view.page.get_by_role("button", name="Cancel").click()
    view.page.locator(".toast.task").wait_for(state="hidden")
    assert view.problems == []


def test_a_browser_that_makes_no_films_says_so(view_of: ViewOf) -> None:
    view = view_of()
    view.page.add_init_script("delete window.VideoEncoder; delete window.MediaRecorder")
    view.open()
    view.page.keyboard.press("b")
    view.page.get_by_text("This browser makes no films").wait_for()

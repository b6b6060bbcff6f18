"""Video in the page: what moves is decoded by the browser, and comes as JPEG once its decoder has failed twice."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import WebSocket, Worker

from culet_protocol.frame import Codec, Frame
from culet_protocol.watch import VIDEO
from e2e.server import PATIENCE
from e2e.view import POLL_MILLISECONDS, Pixels, Seen, View, difference, pixels_of
from video_extra import needs_av

CODECS = [int(codec) for codec in VIDEO]
SHOWS = "([codecs, step]) => window.culet && codecs.includes(culet.lastFrame?.codec) && culet.lastFrame.step > step"
"""A frame in one of the codecs is on the canvas, of a step later than that."""
APART = 40
"""Levels by which a pixel of two pictures differs for sure: one shows the stone there, or its shadow."""
PIXELS_APART = 500
"""Of 384x216, by which two pictures are to be told apart. A stone covers some 3000."""

SAVE_DATA = "Object.defineProperty(navigator, 'connection', { value: { saveData: true } })"
"""The browser's user wants few bytes: else the page asks for no video where pictures of their own have room, as they
have here."""

DAMAGE_PACKETS = """() => {
  const { decode } = VideoDecoder.prototype;
  VideoDecoder.prototype.decode = function ({ type, timestamp, byteLength }) {
    const noise = Uint8Array.from({ length: byteLength }, (_, index) => (151 * index + 101) & 255);
    decode.call(this, new EncodedVideoChunk({ type, timestamp, data: noise }));
  };
}"""
"""In the page's worker: its decoder, which is the browser's own, is given what no decoder can make a picture of."""


@needs_av
def test_what_moves_comes_as_video_and_as_jpeg_once_the_decoder_has_failed_twice(bouncing: View) -> None:
    view, came = bouncing, set[Codec]()

    def watch(stream: WebSocket) -> None:
        stream.on("framereceived", lambda message: came.update(codec_of(message)))

    view.page.on("websocket", watch)
    view.page.add_init_script(SAVE_DATA)
    follow(view)
    one = seen_after(view, 0)
    first = still(view, one.frame["step"], one.pixels)
    two, second, apart = elsewhere(view, one, first)
    assert came & set(VIDEO)
    for seen, own, others in ((one, first, second), (two, second, first)):
        pixels = seen.pixels[apart]  # levels; measured 9 to 19 of its own, and 53 to 67 of the other
        assert difference(pixels, own[apart]) < difference(pixels, others[apart]) / 2
    (worker,) = decoders(view)
    worker.evaluate(DAMAGE_PACKETS)
    before = view.number("framesShown")
    view.until(f"before => culet.lastFrame.codec === {int(Codec.JPEG)} && culet.framesShown > before + 5", before)
    assert decoders(view) == [], "it is given up"
    assert view.problems == []


def codec_of(message: str | bytes) -> set[Codec]:
    """Of a frame; none of a notice."""
    return {Frame.unpack(message).codec} if isinstance(message, bytes) else set()


def decoders(view: View) -> list[Worker]:
    """The page's workers that decode video."""
    return [worker for worker in view.page.workers if "video-worker" in worker.url]


def follow(view: View) -> None:
    """Load the page anew until it shows video: on a machine that does much else, a browser's decoder may take longer to
    begin than the page waits for it."""
    deadline = time.monotonic() + PATIENCE
    while True:
        view.page.reload()
        while not (working := decoders(view)):
            assert time.monotonic() < deadline, f"no decoder in {PATIENCE} s"
            view.page.wait_for_timeout(POLL_MILLISECONDS)
        while decoders(view) == working:
            if view.page.evaluate(SHOWS, [CODECS, 0]):
                return
            assert time.monotonic() < deadline, f"no video in {PATIENCE} s"
            view.page.wait_for_timeout(POLL_MILLISECONDS)


def seen_after(view: View, step: int) -> Seen:
    """A frame of video on the canvas, of a later step."""
    while True:  # between the question and the look another may have come
        view.until(SHOWS, [CODECS, step])
        seen = view.look()
        if seen.frame["codec"] in CODECS:
            return seen


def elsewhere(view: View, one: Seen, first: Pixels) -> tuple[Seen, Pixels, NDArray[np.bool_]]:
    """A frame of video in which the stone is at another place, what the renderer makes of that step, and the pixels by
    which that is another picture than the first."""
    deadline, two = time.monotonic() + PATIENCE, one
    while True:
        two = seen_after(view, two.frame["step"])
        second = still(view, two.frame["step"], one.pixels)
        apart = np.abs(first - second).max(axis=-1) > APART
        if apart.sum() >= PIXELS_APART:
            return two, second, apart
        assert time.monotonic() < deadline, f"the stone has not moved in {PATIENCE} s"


def still(view: View, step: int, like: Pixels) -> Pixels:
    """What the renderer makes of a step, in that size."""
    height, width, _ = like.shape
    parameters = {"step": step, "width": width, "height": height, "samples": 4}
    answer = view.server.http.get(f"/api/sessions/{view.session}/frame.png", params=parameters)
    assert answer.status_code == 200, answer.text
    return pixels_of(answer.content)

"""A page that watches a session: what its user does and sees, and what it sends."""

from __future__ import annotations

import base64
import io
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast
from urllib.parse import parse_qs, urlsplit

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import ConsoleMessage, Page, Request, WebSocket
from playwright.sync_api import Error as PlaywrightError

from culet_protocol.frame import Flags
from e2e.server import PATIENCE, Server
from pictures import compared

Pixels = NDArray[np.int16]
"""(height, width, 3), 0 to 255; signed, so that differences are."""

MILLISECONDS = 1e3
POLL_MILLISECONDS = 20
THUMB = 16.0
"""CSS pixels of a range input's thumb in Chromium: its middle goes from one half of that to the other."""
OF_ONE_VIEWER = ("ack", "decoders", "ping", "reach", "resize", "visibility")
"""Messages that change nothing in the session."""

RECORD = """() => {
  window.record = [];
  const look = () => {
    const { sequence, simulationTime, step, timestamp } = culet.lastFrame;
    if (window.record.at(-1)?.sequence !== sequence) window.record.push({ sequence, simulationTime, step, timestamp });
    requestAnimationFrame(look);
  };
  look();
}"""
KEEP_THE_STREAM = """(() => {
  window.WebSocket = class extends WebSocket {
    constructor(...given) {
      super(...given);
      this.told = {};
      this.asked = {};
      this.reached = {};
      window.stream = this;
      this.addEventListener("message", ({ data }) => {
        if (typeof data !== "string") return;
        const notice = JSON.parse(data);
        this.told[notice.type] = notice;
        if (notice.type === "reached") this.reached[notice.number] ??= notice.step;
      });
    }
  };
})()"""
"""From the start of a page: `stream` is its newest, whose `told` has the last notice of each type, `reached` the step
of each question that was answered."""

ASK_AGAIN_SECONDS = 5
"""After a question without an answer: an engine that was replaced has forgotten it."""

ASK_WHAT_SHOWS_ALL = """([number, pause]) => {
  const { stream } = window;
  if (stream?.readyState !== WebSocket.OPEN) return null;
  const now = performance.now();
  if (!(number in stream.asked) || now - stream.asked[number] > pause) {
    stream.asked[number] = now;
    stream.send(JSON.stringify({ type: "reach", number }));
  }
  return stream.reached[number] ?? null;
}"""
"""The step that is the first to show all that the page has sent before, once the engine has said so."""

AT_REST = """([step, final]) => {
  const { lastFrame, state, fading } = culet;
  const { width, height } = document.getElementById("picture");
  const settled = state.viewers > 1 || (lastFrame?.width === width && lastFrame.height === height);
  return lastFrame?.step > step && lastFrame.flags & final && !fading && settled;
}"""
"""Before a page has said its size, the server renders for one of its own; of several pages one has the say."""

WHAT_IS_SHOWN = """() => {
  const { width, height } = document.getElementById("picture");
  const frame = culet.lastFrame;
  return `frame ${frame?.width} x ${frame?.height} on a canvas of ${width} x ${height}, step ${frame?.step}, ` +
    `flags ${frame?.flags}, fading ${culet.fading}, viewers ${culet.state?.viewers}`;
}"""

READ_THE_CANVAS = "() => [culet.lastFrame, document.getElementById('picture').toDataURL('image/png')]"


@dataclass(frozen=True)
class Seen:
    """What the canvas showed, and the header of the frame that it was."""

    frame: dict[str, Any]
    pixels: Pixels


@dataclass
class View:
    """One page on a session."""

    page: Page
    server: Server
    sent: list[dict[str, Any]] = field(default_factory=list)
    """Control messages of the session, in order."""
    complaints: list[str] = field(default_factory=list)
    """Errors and warnings in the console, and exceptions that nobody caught."""
    refusals: set[int] = field(default_factory=set)
    """Statuses of answers that the test is about; Chromium itself writes those above 400 to the console."""
    gives_up_streams: bool = False
    """Its gateway goes away: Chromium warns of a stream that the page gave up before it was open."""
    foreign: list[str] = field(default_factory=list)
    """Requests to anything but the server."""
    streams: int = 0
    """WebSockets that it has opened."""

    def __post_init__(self) -> None:
        self._questions = 0
        self.page.context.set_default_timeout(PATIENCE * MILLISECONDS)  # also of pages that this one opens
        self.page.add_init_script(KEEP_THE_STREAM)
        self.page.on("console", self._logged)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", self._requested)
        self.page.on("websocket", self._connected)

    def open(self, query: str = "?preset=matte") -> View:
        """Go to the page, and wait for its first picture."""
        self.page.goto(f"{self.server.url}/{query}")
        self.until("() => window.culet && culet.framesShown > 0")
        return self

    @property
    def session(self) -> str:
        """The session's id, from the page's address; its watch id, if the page only watches."""
        query = parse_qs(urlsplit(self.page.url).query)
        return (query.get("session") or query["watch"])[0]

    @property
    def state(self) -> dict[str, Any]:
        """What the page knows of its session."""
        return cast(dict[str, Any], self.page.evaluate("() => culet.state"))

    @property
    def scene(self) -> dict[str, Any]:
        """The scene, as the page knows it."""
        return cast(dict[str, Any], self.state["scene"])

    @property
    def connection(self) -> str:
        """connecting, open, waiting or closed."""
        return cast(str, self.page.evaluate("() => culet.connection"))

    @property
    def problems(self) -> list[str]:
        """What the page has complained of to its user."""
        return cast(list[str], self.page.evaluate("() => [...culet.problems]"))

    def number(self, name: str) -> float:
        """One of the page's counters, such as framesShown."""
        return cast(float, self.page.evaluate("name => culet[name]", name))

    def until(self, condition: str, argument: object = None, tell: str = "() => ''") -> None:
        """Wait until a JavaScript function of the argument is true; `tell` is another, of what there is if it never is.

        Asked from here: Playwright's `wait_for_function` evaluates text in the page, which the page's policy forbids.
        """
        deadline = time.monotonic() + PATIENCE
        while not self._evaluated(condition, argument):
            if time.monotonic() > deadline:
                there = self._evaluated(tell, None)
                raise AssertionError(f"never true in {PATIENCE} s: {condition} of {argument}; {there}")
            self.page.wait_for_timeout(POLL_MILLISECONDS)

    def _evaluated(self, script: str, argument: object) -> Any:  # noqa: ANN401 - whatever the script makes
        """None while the page is reloaded."""
        try:
            return self.page.evaluate(script, argument)
        except PlaywrightError as error:
            if "context was destroyed" in str(error):
                return None
            raise

    def until_streams(self, number: int) -> None:
        """Wait until the page has opened so many streams."""
        deadline = time.monotonic() + PATIENCE
        while self.streams < number:
            assert time.monotonic() < deadline, f"{self.streams} streams in {PATIENCE} s, expected {number}"
            self.page.wait_for_timeout(POLL_MILLISECONDS)

    def frame_when(self, condition: str, argument: object = None) -> dict[str, Any]:
        """The header of the first frame that is seen of which a JavaScript function of it and the argument is true."""
        script = f"argument => culet.lastFrame && ({condition})(culet.lastFrame, argument) ? culet.lastFrame : null"
        deadline = time.monotonic() + PATIENCE
        while (frame := self.page.evaluate(script, argument)) is None:
            assert time.monotonic() < deadline, f"never true in {PATIENCE} s: {condition} of {argument}"
            self.page.wait_for_timeout(POLL_MILLISECONDS)
        return cast(dict[str, Any], frame)

    def reach(self) -> int:
        """The step whose picture is the first to show all that the page has sent; the engine has taken all of it."""
        self.settle_messages()
        self._questions += 1
        number = 2**31 + self._questions  # the page's own are small
        deadline = time.monotonic() + PATIENCE
        while (step := self._evaluated(ASK_WHAT_SHOWS_ALL, [number, ASK_AGAIN_SECONDS * MILLISECONDS])) is None:
            assert time.monotonic() < deadline, f"not answered in {PATIENCE} s: which step shows all that was sent"
            self.page.wait_for_timeout(POLL_MILLISECONDS)
        return cast(int, step)

    def until_told(self) -> int:
        """As `reach`; when it returns the page knows what the engine does: states are told 25 times a second, and
        neither before a picture nor before an answer."""
        step = self.reach()
        known = self.server.session(self.session)
        known = {name: known[name] for name in ("scene", "falling", "exactness", "pinned")}
        deadline = time.monotonic() + PATIENCE
        while {name: self.state[name] for name in known} != known:
            assert time.monotonic() < deadline, f"not told in {PATIENCE} s: {known}"
            self.page.wait_for_timeout(POLL_MILLISECONDS)
        return step

    def look(self) -> Seen:
        """The canvas and its frame, in one go."""
        frame, url = self.page.evaluate(READ_THE_CANVAS)
        return Seen(frame, pixels_of(base64.b64decode(url.partition(",")[2])))

    def at_rest(self, after: int = -1) -> Seen:
        """The canvas once it shows the finished picture of a step later than that."""
        self.until(AT_REST, [after, int(Flags.FINAL)], tell=WHAT_IS_SHOWN)
        return self.look()

    def record(self) -> None:
        """From now on, note the headers of the frames that are on the canvas, looking with every animation frame."""
        self.page.evaluate(RECORD)

    @property
    def recorded(self) -> list[dict[str, Any]]:
        """The headers noted since `record`."""
        return cast(list[dict[str, Any]], self.page.evaluate("() => window.record"))

    def change(self, act: Callable[[], object]) -> tuple[Seen, Seen]:
        """Do something that changes the picture: the finished pictures before and after, which shows all of it."""
        before = self.at_rest()
        act()
        self.until("step => culet.lastFrame.step > step", before.frame["step"])  # what was done may have to be sent yet
        return before, self.at_rest(after=self.until_told() - 1)

    def change_by(self, key: str) -> tuple[Seen, Seen]:
        """As `change`, by a key."""
        return self.change(lambda: self.page.keyboard.press(key))

    def drag_slider(self, name: str, *to: float) -> None:
        """Take a slider from its start to parts of its length, and let it go at the last."""
        slider = self.page.get_by_role("slider", name=name)
        mouse = self.page.mouse
        deadline = time.monotonic() + PATIENCE
        while True:  # what is loaded above it may move it away, at any time until it is pressed
            slider.scroll_into_view_if_needed()
            box = slider.bounding_box()
            assert box is not None
            start, length, y = box["x"] + THUMB / 2, box["width"] - THUMB, box["y"] + box["height"] / 2
            mouse.move(start, y)
            if slider.evaluate("(slider, [x, y]) => document.elementFromPoint(x, y) === slider", [start, y]):
                mouse.down()
                if slider.evaluate("slider => slider === document.activeElement"):
                    break
                mouse.up()
            assert time.monotonic() < deadline, f"the slider {name} was never where it was looked for in {PATIENCE} s"
            self.page.wait_for_timeout(POLL_MILLISECONDS)
        for part in to:
            mouse.move(start + part * length, y)
            self.settle_messages()
        mouse.up()

    def settle_messages(self) -> None:
        """Wait until the page has sent, and this process has heard of, all that its user's acts so far call for."""
        # Pointer input goes out with the next animation frame; the one after it has surely seen that.
        self.page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def press(self, code: str, key: str, *, repeat: bool = False, modifiers: int = 0) -> None:
        """Press and release a key at a place (KeyboardEvent.code) that prints a letter (KeyboardEvent.key)."""
        keyboard = self.page.context.new_cdp_session(self.page)
        stroke = {"code": code, "key": key, "modifiers": modifiers}
        keyboard.send("Input.dispatchKeyEvent", {"type": "keyDown", "autoRepeat": repeat, **stroke})
        keyboard.send("Input.dispatchKeyEvent", {"type": "keyUp", **stroke})
        keyboard.detach()
        self.settle_messages()

    def open_file(self, button: str, file: Path) -> None:
        """Choose a file by one of the panel's buttons."""
        with self.page.expect_file_chooser() as chooser:
            self.page.get_by_role("button", name=button).click()
        chooser.value.set_files(file)

    def _logged(self, message: ConsoleMessage) -> None:
        expected = any(f"responded with a status of {status} " in message.text for status in self.refusals)
        expected |= self.gives_up_streams and "closed before the connection is established" in message.text
        if message.type in ("error", "warning") and not expected:
            self.complaints.append(message.text)

    def _requested(self, request: Request) -> None:
        if not request.url.startswith((f"{self.server.url}/", "data:", "blob:")):
            self.foreign.append(request.url)

    def _connected(self, websocket: WebSocket) -> None:
        if urlsplit(websocket.url).netloc != urlsplit(self.server.url).netloc:
            self.foreign.append(websocket.url)
        self.streams += 1
        websocket.on("framesent", self._sent)

    def _sent(self, payload: str | bytes) -> None:
        message = json.loads(payload)
        if message["type"] not in OF_ONE_VIEWER:
            self.sent.append(message)


def pixels_of(data: bytes) -> Pixels:
    """The pixels of an image file."""
    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image.convert("RGB"), np.int16)


def difference(a: Pixels, b: Pixels) -> float:
    """Mean absolute difference of two pictures of the same size, 0 to 255."""
    assert a.shape == b.shape
    return float(np.abs(a - b).mean())


def assert_same(picture: Pixels, reference: Pixels) -> None:
    """Every pixel."""
    with compared(picture, reference):
        np.testing.assert_array_equal(picture, reference)

"""From a key that is pressed to pixels that have changed: a real server, the real page, in Chromium on this machine.

    PYTHONPATH=tests python -m e2e.control_to_photon [--width 960] [--height 540] [--keys 200] [--into FILE]

While a stone falls again and again, an arrow key is pressed every now and then. The page asks the engine from which
step on pictures show that; the first frame of that step, decoded, drawn and painted, ends the delay, which began with
the key event's own time stamp. `make delay` runs it, on a machine that has nothing else to do.
"""

from __future__ import annotations

import argparse
import os
import platform
import random
import shutil
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import sync_playwright

from e2e.conftest import ARGUMENTS
from e2e.server import PATIENCE, Server
from e2e.view import View

STAGES = ("to the server", "waiting", "simulate", "render", "encode", "back", "decode and paint")
"""As the page's meter has them."""
KEYS = ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown")
WARM_SECONDS = 6.0
"""Of falling that do not count: programs are compiled, the governor learns."""
PAUSE_SECONDS = 0.15, 0.45
"""Between two keys: by chance, or they would be in step with the frames."""
BOUNCING = {"simulation": {"restitution": 0.9}}
"""The default scene with a stone that jumps for long: it moves whenever a key is pressed."""
MEDIAN, MOST = (1.5, 20.0), (2.0, 30.0)
"""Of frames' time, and ms beside that, that the median may be and 95 of 100 may not exceed."""


@dataclass(frozen=True)
class Delays:
    """What was measured; ms."""

    total: NDArray[np.float64]
    """(N,)"""
    stages: NDArray[np.float64]
    """(N, 7)"""
    frame: float
    """Between two frames, on average."""
    size: tuple[int, int]
    """Of the last frame."""

    @property
    def limits(self) -> tuple[float, float]:
        """That the median and the 95th percentile may be."""
        median, most = (part * self.frame + more for part, more in (MEDIAN, MOST))
        return median, most

    @property
    def reached(self) -> tuple[float, float]:
        """The median and the 95th percentile."""
        median, most = np.percentile(self.total, (50, 95))
        return float(median), float(most)

    def lines(self) -> list[str]:
        """A Markdown table and a sentence."""
        (median, most), (may, may_most) = self.reached, self.limits
        shares = np.percentile(self.stages, (50, 95), axis=0)
        return [
            "| ms | all | " + " | ".join(STAGES) + " |",
            "|---|---|" + "---|" * len(STAGES),
            f"| median | {median:.1f} | " + " | ".join(f"{value:.1f}" for value in shares[0]) + " |",
            f"| 95 % | {most:.1f} | " + " | ".join(f"{value:.1f}" for value in shares[1]) + " |",
            "",
            f"{len(self.total)} keys; a frame of {self.size[0]}x{self.size[1]} every {self.frame:.1f} ms.",
            f"The median may be {may:.1f}, 95 % {may_most:.1f}.",
        ]


def measure(view: View, keys: int, seed: int = 1) -> Delays:
    """Press so many keys, at chance times, while a stone falls."""
    page, chance = view.page, random.Random(seed)  # noqa: S311 - moments, no secrets
    page.evaluate("() => culet.watchDelays()")
    _fall(view)
    page.wait_for_timeout(WARM_SECONDS * 1e3)
    page.evaluate("() => { culet.delays.length = 0 }")
    shown, started = view.number("framesShown"), time.monotonic()
    deadline = started + keys * PAUSE_SECONDS[1] + PATIENCE
    while (done := page.evaluate("() => culet.delays.length")) < keys:
        assert time.monotonic() < deadline, f"only {done} of {keys} keys were seen"
        _fall(view)
        page.keyboard.press(chance.choice(KEYS))
        page.wait_for_timeout(chance.uniform(*PAUSE_SECONDS) * 1e3)
    seconds, frames = time.monotonic() - started, view.number("framesShown") - shown
    found = page.evaluate("() => culet.delays")
    size = page.evaluate("() => [culet.lastFrame.width, culet.lastFrame.height]")
    return Delays(
        np.array([delay["total"] for delay in found]),
        np.array([delay["stages"] for delay in found]),
        1e3 * seconds / frames,
        (size[0], size[1]),
    )


def _fall(view: View) -> None:
    """Let the stone fall anew if it lies still."""
    if not view.page.evaluate("() => culet.state.falling && !culet.state.asleep"):
        view.server.http.post(f"/api/sessions/{view.session}/events", json={"type": "toggle_fall"})
        view.until("() => culet.state.falling && !culet.state.asleep")


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--width", type=int, default=960, help="pixels of the picture")
    parser.add_argument("--height", type=int, default=540, help="pixels of the picture")
    parser.add_argument("--keys", type=int, default=200, help="that are pressed")
    parser.add_argument("--into", type=Path, help="file that gets the table")
    asked = parser.parse_args(arguments)
    executable = os.environ.get("CULET_CHROMIUM") or shutil.which("chromium")
    if executable is None:
        parser.error("there is no chromium on the PATH; name one by CULET_CHROMIUM")
    with (
        tempfile.TemporaryDirectory() as folder,
        Server(Path(folder)) as server,
        sync_playwright() as playwright,
    ):
        chromium = playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        viewport = {"width": asked.width, "height": asked.height}
        page = chromium.new_context(viewport=viewport).new_page()  # type: ignore[arg-type]
        session = server.http.post("/api/sessions", json={"scene": BOUNCING}).json()["id"]
        delays = measure(View(page, server).open(f"?session={session}&ui=0"), asked.keys)
        chromium.close()
    lines = [*delays.lines(), f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores."]
    print("\n".join(lines))
    if asked.into is not None:
        asked.into.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

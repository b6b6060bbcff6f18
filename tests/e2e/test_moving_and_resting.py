"""The stream while the stone falls, and when there is nothing more to show."""

from __future__ import annotations

import re
from itertools import pairwise

from playwright.sync_api import expect

from e2e.server import Server
from e2e.view import View

MOVING_STATUS = " \u00b7 ".join(
    (
        r"^\d+\.\d frames/s( \u00b7 limited by [a-z ]+)?( \u00b7 slow motion)?",
        r"server [\d.]+ ms \(simulate [\d.]+, render [\d.]+, encode [\d.]+\)",
        r"round trip [\d.]+ ms",
        r"frontier's error [\d.]+( \u00b7 [^\u00b7]+)?",
        r"\d+\u00d7\d+ (JPEG|H\.264)",
        "1 sample",
        "1 viewer$",
    )
)
"""On a machine that does much else, stones fall in slow motion, in smaller pictures that lack some of their light."""


def test_frames_are_shown_in_order_while_the_stone_falls(bouncing: View) -> None:
    view = bouncing
    view.record()
    view.until("() => record.length > 5 && culet.framesShown > 20 && culet.lastFrame.simulationTime > 1.5")
    record = view.recorded
    for before, after in pairwise(record):
        for clock in ("sequence", "simulationTime", "timestamp"):
            assert after[clock] >= before[clock], f"{clock} went back"
        assert after["step"] > before["step"]
    assert view.number("outOfOrder") == 0
    assert view.problems == []


def test_the_status_line_tells_rate_cost_and_latency(bouncing: View) -> None:
    view = bouncing
    view.until("pattern => RegExp(pattern).test(document.querySelector('#status .all').textContent)", MOVING_STATUS)
    view.page.keyboard.press("p")
    view.at_rest()
    expect(view.page.locator("#status .all")).to_have_text(re.compile("^still picture.* 16 samples"))


def test_a_finished_picture_is_sent_again_and_not_rendered_again(bouncing: View, server: Server) -> None:
    view = bouncing
    view.page.keyboard.press("p")
    view.until("() => !culet.state.falling")
    view.at_rest()
    server.until_compiled()
    before = server.metrics()
    server.until("engine_frames_repeated", before["engine_frames_repeated"] + 2)
    after = server.metrics()
    for name in ("engine_frames_rendered", "engine_refinements"):
        assert after[name] == before[name], "nothing is rendered when nothing changes"
    assert view.number("outOfOrder") == 0


def test_the_time_from_a_key_to_its_picture_is_made_up_of_stages(view: View) -> None:
    view.page.evaluate("() => culet.watchDelays()")
    before = view.number("framesShown")
    view.page.keyboard.press("ArrowLeft")
    view.until("() => culet.delays.length === 1")
    assert view.number("framesShown") > before
    (delay,) = view.page.evaluate("() => culet.delays")
    assert len(delay["stages"]) == 7
    assert all(stage >= 0 for stage in delay["stages"])
    assert sum(delay["stages"]) >= delay["total"] - 1e-6
    assert view.page.evaluate("() => culet.lastFrame.renderMs") > 0

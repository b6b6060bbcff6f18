"""The web process dies while somebody watches; then both do."""

from __future__ import annotations

import os
import signal

import pytest

from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View

MADE_AGAIN = "The server had lost this session."


@pytest.fixture
def falling(view_of: ViewOf, server: Server) -> View:
    """A page on a stone that falls from so high that it does not rest before a slow machine is done."""
    scene = {"floor": {"kind": "matte"}, "stones": [{"position": [0, 50_000, 0]}], "simulation": {"gravity": 1}}
    answer = server.http.post("/api/sessions", json={"scene": scene})
    view = view_of().open(f"?session={answer.json()['id']}")
    view.refusals |= {404, 503}
    view.gives_up_streams = True
    view.change_by("ArrowLeft")
    view.page.keyboard.press("p")
    view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.1")
    return view


def remember_this_page(view: View) -> None:
    """So that a page that was loaded anew is told from this one."""
    view.page.evaluate("() => { window.sameAsBefore = true; }")


def comes_back(view: View, streams: int) -> None:
    """It has opened more than that many streams; the last one is open, and shows what is new."""
    view.until_streams(streams + 1)  # not until it is seen to be closed, which may take no longer than a look
    shown = view.number("framesShown")
    view.until("shown => culet.connection === 'open' && culet.framesShown > shown + 3", shown)
    assert view.page.evaluate("() => window.sameAsBefore"), "without a reload"
    assert view.number("outOfOrder") == 0


def test_the_page_goes_on_where_it_was_when_the_gateway_is_back(falling: View, server: Server) -> None:
    view = falling
    remember_this_page(view)
    before, scene, gateway = view.look().frame, view.scene, server.gateway_pid()
    streams = view.streams
    os.kill(gateway, signal.SIGKILL)
    comes_back(view, streams)
    assert server.gateway_pid() != gateway
    assert view.scene == scene
    assert view.state["falling"]
    after = view.look().frame
    assert after["simulationTime"] >= before["simulationTime"]
    assert after["step"] > before["step"]


def test_a_session_that_both_have_lost_is_made_again_by_its_page_which_says_so(falling: View, server: Server) -> None:
    view = falling
    remember_this_page(view)
    view.until("() => stream.told.snapshot?.snapshot.simulation.time > 0.5")  # told once a second
    before, scene, address, streams = view.look().frame, view.scene, view.page.url, view.streams
    told = view.page.evaluate("() => stream.told.snapshot.snapshot.simulation.time")
    server.kill_all()
    view.until(
        "text => [...document.querySelectorAll('.toast')].some(toast => toast.textContent.startsWith(text))", MADE_AGAIN
    )
    comes_back(view, streams)
    assert view.page.url == address, "whoever has the address still finds the session"
    assert view.scene == scene
    assert view.state["falling"]
    after = view.look().frame
    assert after["simulationTime"] > told, "it goes on from where the page was told that it is"
    assert after["step"] > before["step"]

"""The render process dies while somebody watches."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

from e2e.server import Server
from e2e.view import View, difference

POSE_AGE = 0.5
"""Seconds of the fall that may be lost: the engine tells where a moving stone is 20 times a second, later where other
work holds it up; the whole fall takes longer."""
FALLEN = 1.0
"""Seconds of a fall, for a stone that is well on its way."""
STOPPED = "The render process stopped"


@pytest.fixture(scope="module")
def server(built_client: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A `culet serve` of this module's own, since its engine is killed."""
    with Server(tmp_path_factory.mktemp("serve")) as running:
        yield running


def kill_the_engine(view: View, server: Server) -> None:
    """As the kernel does when memory is short; returns when the page has said so."""
    # Recorded by the page itself: the engine can be back before this process looks.
    view.page.evaluate(
        """() => {
          const banner = document.getElementById("banner");
          window.said = [];
          new MutationObserver(() => banner.hidden || window.said.push(banner.textContent))
            .observe(banner, { attributes: true, childList: true, subtree: true });
        }"""
    )
    os.kill(server.engine_pid(), signal.SIGKILL)
    view.until("text => window.said.some(said => said.startsWith(text))", STOPPED)


def test_the_page_says_so_and_goes_on_with_the_same_scene(view: View, server: Server) -> None:
    view.change_by("w")
    _, before = view.change_by("ArrowLeft")
    scene, old, before_it = view.scene, server.engine_pid(), server.metrics()["engine_processes_total"]

    kill_the_engine(view, server)
    view.until("() => culet.state.engine === 'up' && document.getElementById('banner').hidden")
    assert server.engine_pid() != old
    assert server.metrics()["engine_processes_total"] == before_it + 1
    assert server.session(view.session)["scene"] == scene
    assert view.scene == scene

    _, after = view.change_by("m")
    assert difference(before.pixels, after.pixels) > 1
    _, back = view.change_by("m")
    assert difference(before.pixels, back.pixels) == 0
    assert view.number("outOfOrder") == 0


def test_a_stone_goes_on_falling_from_where_it_was(bouncing: View, server: Server) -> None:
    view = bouncing
    view.until("seconds => culet.lastFrame.simulationTime > seconds", FALLEN)
    kill_the_engine(view, server)
    last = view.look().frame
    view.record()
    view.until("shown => culet.framesShown > shown + 3", view.number("framesShown"))
    after = [frame for frame in view.recorded if frame["sequence"] > last["sequence"]]
    assert view.state["falling"]
    assert after[0]["simulationTime"] > last["simulationTime"] - POSE_AGE
    assert min(frame["step"] for frame in after) > last["step"], "the names of steps are not used again"
    assert view.number("outOfOrder") == 0

"""Grades and diagrams of several who ask at once, and of stones that nobody may wait for."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import Any, cast

import pytest

from culet.engine.capacity.limits import Limits
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.staging import Staging
from culet.engine.process.stone_requests import StoneRequests
from culet.errors import MeshError
from culet.paths.recorder import GivenUpError
from culet.stage import NOTHING, Library
from culet.study.solids import ball
from culet_protocol.engine import DrawDiagram, Grade, TracePath
from engine.peer import PATIENCE

DEFAULT: dict[str, Any] = {"stones": [{"id": "a"}]}
LARGE = Grade(scene=DEFAULT, error=10, tilt=True)
SMALL = Grade(scene=DEFAULT, error=10)


def requests(library: Library = NOTHING, grade_seconds: float = 60) -> StoneRequests:
    """Of scenes; there are no sessions."""
    limits = Limits(grade_seconds=grade_seconds)
    return StoneRequests(cast(OpenSessions, {}), library, Staging(library), limits)


async def test_grades_end_in_their_time_and_tell_what_is_known_by_then() -> None:
    report = await requests(grade_seconds=1e-9).grade(LARGE)
    assert 0 < report["done"] < 1
    assert report["grades"]["rays"] > 0
    assert report["tilt"] is None


async def test_grades_that_are_asked_for_at_once_take_turns() -> None:
    stones = requests()
    large = asyncio.create_task(stones.grade(LARGE))
    await asyncio.sleep(0)  # it is the first to begin
    small = await stones.grade(SMALL)
    assert small["done"] == 1
    assert not large.done()
    large.cancel()
    with pytest.raises(asyncio.CancelledError):
        await large


async def test_a_stone_of_more_facets_than_fit_on_a_page_has_no_diagram() -> None:
    stones = requests(Library({"few": ball(300)(), "many": ball(1501)()}))
    drawing = await stones.diagram(DrawDiagram(scene={"stones": [{"id": "a", "mesh": "few"}]}))
    assert drawing.startswith(b"<")
    with pytest.raises(MeshError, match="expected a stone of at most 1500 facets to draw; got 1501"):
        await stones.diagram(DrawDiagram(scene={"stones": [{"id": "a", "mesh": "many"}]}))


async def test_a_ray_that_nobody_waits_for_ends_with_its_launch(monkeypatch: pytest.MonkeyPatch) -> None:
    """The next one waits for the same thread."""
    begun, ends = threading.Event(), threading.Event()

    def endless(*_: object, waited_for: Callable[[], bool], **__: object) -> None:
        begun.set()
        while waited_for():
            pass
        ends.set()
        raise GivenUpError("nobody waits")

    monkeypatch.setattr("culet.engine.process.stone_requests.answered", endless)
    ray = TracePath(scene=DEFAULT, pixel=(1, 1, 4, 4))
    asked = asyncio.create_task(requests().path(ray))
    assert await asyncio.to_thread(begun.wait, PATIENCE)
    assert not ends.is_set()
    asked.cancel()
    with pytest.raises(asyncio.CancelledError):
        await asked
    assert await asyncio.to_thread(ends.wait, PATIENCE)

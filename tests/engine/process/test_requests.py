"""Changes that make shapes: in their client's turn, bounded, and of sessions that are there."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from types import SimpleNamespace
from typing import Any, cast

import pytest

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.painter import Painter
from culet.engine.painting.still import StillQueue
from culet.engine.process import requests as module
from culet.engine.process import staging
from culet.engine.process.requests import Requests
from culet.errors import BusyError, InputError, NotFoundError
from culet_protocol.engine import CloseSession, Control, OpenSession
from culet_protocol.messages import PatchScene, SessionEvent, SetScene, ToggleMirror
from shared.patience import PATIENCE

SESSION, CLIENT = "a" * 32, "somebody"
CUT = PatchScene(patch={"stones": [{"id": "a", "cut": "baguette"}]})


@asynccontextmanager
async def opened(*sessions: str) -> AsyncIterator[Requests]:
    """Sessions of one client, each with a stone."""
    pictures: dict[str, LivePicture] = {}
    painter = cast(Painter, SimpleNamespace(pictures=pictures, forget=pictures.pop, wake=lambda: None))
    requests = Requests(
        painter, StillQueue(1, 1), Limits(), {}, tell=lambda _: None, memory=Memory(10**9), forget_sky=lambda _: None
    )
    scene: dict[str, Any] = {"stones": [{"id": "a", "cut": "single"}]}
    async with asyncio.timeout(PATIENCE):
        for session in sessions:
            await requests.answer(OpenSession(session=session, scene=scene, client=CLIENT), None)
        yield requests


def cuts(requests: Requests, session: str = SESSION) -> list[object]:
    """Of its stones."""
    return [stone.cut for stone in requests.sessions.get(session).session.scene.stones]


async def change(requests: Requests, event: SessionEvent, session: str = SESSION) -> None:
    """Have it made."""
    await requests.answer(Control(session=session, event=event), None)


async def test_a_change_that_waits_too_long_for_others_of_its_client_is_told_to_try_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with opened(SESSION) as requests:
        monkeypatch.setattr(staging, "WAIT_SECONDS", 0.0)
        async with requests._changes.turn(CLIENT):
            with pytest.raises(BusyError, match="not done within 0 s, beside what else of yours is being done"):
                await change(requests, CUT)
            with pytest.raises(BusyError):
                await requests.answer(OpenSession(session="b" * 32, scene={"stones": []}, client=CLIENT), None)
            assert cuts(requests) == ["single"]
            await change(requests, ToggleMirror())  # which waits for nothing
        async with requests.sessions.get(SESSION).session.lock:
            with pytest.raises(BusyError):
                await change(requests, ToggleMirror())
        monkeypatch.undo()
        await change(requests, CUT)
        assert cuts(requests) == ["baguette"]


async def test_a_change_whose_shapes_take_too_long_is_refused_and_changes_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with opened(SESSION) as requests:
        monkeypatch.setattr(module, "CHANGE_SECONDS", -1.0)
        with pytest.raises(InputError, match="expected shapes that take -1 s of a processor at most"):
            await change(requests, CUT)
        assert cuts(requests) == ["single"]


@pytest.mark.parametrize("event", [CUT, SetScene(scene={"stones": [{"id": "b", "cut": "rose"}]})])
async def test_no_shape_is_made_for_a_session_that_was_closed_while_it_waited(
    monkeypatch: pytest.MonkeyPatch, event: SessionEvent
) -> None:
    made: list[object] = []
    async with opened(SESSION) as requests:
        monkeypatch.setattr("culet.stage.shape_of", lambda *arguments: made.append(arguments))
        async with requests._changes.turn(CLIENT):
            waiting = asyncio.create_task(change(requests, event))
            while not requests._changes._waiting[CLIENT] > 1:  # noqa: ASYNC110 - it says nothing
                await asyncio.sleep(0.001)
            await requests.answer(CloseSession(session=SESSION), None)
        with pytest.raises(NotFoundError, match="no such session"):
            await waiting
    assert made == []


async def test_a_session_that_an_engine_before_had_waits_for_as_long_as_it_takes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with opened(SESSION) as requests:
        described = requests.sessions.get(SESSION).session.described()
        lost = OpenSession(session="b" * 32, scene=described["scene"], snapshot=described["snapshot"], client=CLIENT)
        monkeypatch.setattr(staging, "WAIT_SECONDS", 0.0)
        async with requests._changes.turn(CLIENT):
            opening = asyncio.create_task(requests.answer(lost, None))
            while not requests._changes._waiting[CLIENT] > 1:  # noqa: ASYNC110 - it says nothing
                await asyncio.sleep(0.001)
            await asyncio.sleep(0)
            assert not opening.done()
        await opening
        assert "b" * 32 in requests.sessions

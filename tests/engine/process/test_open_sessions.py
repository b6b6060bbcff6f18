"""Sessions that are closed before they are open."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import cast

import pytest

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.painter import Painter
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.staging import Staging
from culet.errors import NotFoundError
from culet.scene import Scene
from culet.stage import Library
from culet_protocol.engine import OpenSession


async def test_a_session_that_is_closed_before_it_is_open_is_not_opened_and_another_of_its_name_is() -> None:
    pictures: dict[str, LivePicture] = {}
    painter = cast(Painter, SimpleNamespace(pictures=pictures, forget=pictures.pop, wake=lambda: None))
    staging = Staging(Library())
    sessions = OpenSessions(painter, Limits(), Memory(10**9), staging)
    scene = Scene().model_dump(mode="json")
    asked = OpenSession(session="a" * 32, scene=scene, client="b")
    async with staging.turn("b"):  # it waits
        opening = asyncio.create_task(sessions.open(asked))
        await asyncio.sleep(0)
        sessions.close(asked.session)
        again = asyncio.create_task(sessions.open(asked))
        await asyncio.sleep(0)
    with pytest.raises(NotFoundError):
        await opening
    assert await again is sessions.get(asked.session)
    sessions.close(asked.session)
    with pytest.raises(NotFoundError):
        sessions.close(asked.session)

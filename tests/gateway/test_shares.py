"""Clients behind a trusted proxy: nobody's sessions, viewers or stills keep the others out."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import ConnectionClosed

from culet.gateway.sessions import session_places
from culet_protocol.close import CloseCode
from gateway.running import PATIENCE, Endpoints, Gateway, Viewer, eventually, gateway_before

GREEDY, MODEST, THIRD = ({"X-Forwarded-For": f"203.0.113.{number}"} for number in (1, 2, 3))


@pytest.fixture
async def crowded(engine: Endpoints, tmp_path: Path) -> AsyncIterator[Gateway]:
    """A web server with few places, behind a proxy."""
    limits = {"max_sessions": 4, "max_client_sessions": 4, "max_viewers": 3, "max_client_stills": 2}
    async with gateway_before(engine, web=tmp_path, trusted_proxy=("127.0.0.1",), **limits) as gateway:
        yield gateway


async def open_session(gateway: Gateway, client: dict[str, str]) -> httpx.Response:
    return await gateway.http.post("/api/sessions", json={}, headers=client)


async def open_sessions(gateway: Gateway, client: dict[str, str], number: int) -> list[str]:
    answers = [await open_session(gateway, client) for _ in range(number)]
    assert [answer.status_code for answer in answers] == [201] * number
    return [answer.json()["id"] for answer in answers]


async def exists(gateway: Gateway, session: str) -> bool:
    return (await gateway.http.get(f"/api/sessions/{session}")).status_code == 200


async def test_a_client_that_fills_the_server_makes_room_for_one_that_has_less(crowded: Gateway) -> None:
    held = await open_sessions(crowded, GREEDY, 4)
    assert (await open_session(crowded, GREEDY)).status_code == 429, "who has the most gets no more"
    async with crowded.viewer(held[0], additional_headers=GREEDY) as viewer:
        await viewer.frame()
        for session in held[1:]:  # being asked for again and again is no reason to stay
            assert await exists(crowded, session)
        (modest,) = await open_sessions(crowded, MODEST, 1)
        assert await exists(crowded, modest)
        assert not await exists(crowded, held[1]), "the one that nobody asked for longest"
        await open_sessions(crowded, THIRD, 1)
        assert len(crowded.parts.sessions) == 4
        assert await exists(crowded, held[0]), "it is watched"
        assert (await open_session(crowded, MODEST)).status_code == 429, "all have about the same"


async def test_a_session_whose_page_is_being_reloaded_makes_no_room(
    crowded: Gateway, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_places, "RELOAD_SECONDS", PATIENCE)
    held = await open_sessions(crowded, GREEDY, 4)
    for session in held:
        async with crowded.viewer(session, additional_headers=GREEDY) as viewer:
            await viewer.notice("hello")
    assert (await open_session(crowded, MODEST)).status_code == 429
    for session in held:
        assert await exists(crowded, session)


async def test_a_client_at_its_own_limit_gets_room_by_what_it_left_alone(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with gateway_before(engine, web=tmp_path, max_client_sessions=2) as gateway:
        held = await open_sessions(gateway, {}, 2)
        refused = await open_session(gateway, {})
        assert refused.status_code == 429
        assert "2 sessions open, which is the limit for one client" in refused.json()["detail"]
        monkeypatch.setattr(session_places, "UNUSED_SECONDS", 0.0)
        await open_sessions(gateway, {}, 1)
        assert [await exists(gateway, session) for session in held] == [False, True]


async def test_opened_all_at_once_sessions_are_no_more_than_the_limit(crowded: Gateway) -> None:
    answers = await asyncio.gather(*(open_session(crowded, client) for client in (GREEDY, MODEST, THIRD) * 6))
    assert {answer.status_code for answer in answers} == {201, 429}
    assert len(crowded.parts.sessions) == 4


async def test_a_session_that_was_never_watched_goes_first(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, unwatched_session_seconds=3) as gateway:
        (seen,) = await open_sessions(gateway, {}, 1)
        async with gateway.viewer(seen) as viewer:
            await viewer.notice("hello")
        (pictured,) = await open_sessions(gateway, {}, 1)
        size = {"width": 16, "height": 16}
        assert (await gateway.http.get(f"/api/sessions/{pictured}/frame.png", params=size)).status_code == 200
        (never,) = await open_sessions(gateway, {}, 1)

        async def two_left() -> bool:
            return len(gateway.parts.sessions) == 2

        await eventually(two_left)
        assert [await exists(gateway, session) for session in (seen, pictured, never)] == [True, True, False]


async def test_strangers_that_fill_a_session_leave_its_owner_a_place(crowded: Gateway) -> None:
    (session,) = await open_sessions(crowded, GREEDY, 1)

    async def come(stack: AsyncExitStack, client: dict[str, str]) -> Viewer:
        viewer = await stack.enter_async_context(crowded.viewer(session, additional_headers=client))
        await viewer.notice("hello")
        return viewer

    async with AsyncExitStack() as stack:
        for _ in range(2):
            await come(stack, MODEST)
        with pytest.raises(ConnectionClosed) as closed:
            await come(stack, THIRD)
        assert closed.value.rcvd
        assert closed.value.rcvd.code == CloseCode.BUSY
        owner = await come(stack, GREEDY)
        await owner.frame()


ENDLESS = {"scene": {"sampling": {"samples_per_pixel": 16384}}, "width": 1024, "height": 1024}
"""Three quarters of the work that one still may make: more would be refused, and not be waited for."""
SMALL = {"width": 32, "height": 18, "samples": 1}


@asynccontextmanager
async def endless_stills(gateway: Gateway, client: dict[str, str], number: int) -> AsyncIterator[None]:
    """A client that waits for so many pictures."""
    async with httpx.AsyncClient(base_url=gateway.url, timeout=2 * PATIENCE, headers=client) as http:
        stills = [asyncio.create_task(http.post("/api/render", json=ENDLESS)) for _ in range(number)]
        await waited_for(gateway, number)
        yield
        for still in stills:
            still.cancel()
        await asyncio.gather(*stills, return_exceptions=True)


async def waited_for(gateway: Gateway, number: int) -> None:
    """Until so many pictures are waited for."""

    async def reached() -> bool:
        return len(gateway.parts.stills) == number

    await eventually(reached)


async def test_a_client_waits_for_so_many_stills_and_gets_their_places_back_by_leaving(crowded: Gateway) -> None:
    async with endless_stills(crowded, GREEDY, 2):
        refused = await crowded.http.get("/api/render.tga", headers=GREEDY)
        assert refused.status_code == 429
        assert "203.0.113.1 waits for 2 pictures already" in refused.json()["detail"]
        assert refused.headers["retry-after"]
    await waited_for(crowded, 0)
    assert (await crowded.http.get("/api/render.tga", params=SMALL, headers=GREEDY)).status_code == 200

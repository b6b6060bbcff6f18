"""A server that is about to be stopped: it takes no new sessions, tells its viewers, and ends when nobody is left."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from culet.gateway.listener import Listener
from culet.gateway.operation.drain import Drain
from culet.gateway.sessions import session_places
from culet.gateway.settings import GatewaySettings
from gateway.running import PATIENCE, Endpoints, Gateway, eventually, gateway_before

TOKEN = "a-token-of-these-tests"  # noqa: S105 - of these tests alone


async def test_a_draining_server_takes_no_new_sessions_and_keeps_those_it_has(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.frame()
        begun = await gateway.http.post("/api/drain", json={"seconds": 500})
        assert (begun.status_code, begun.json()["viewers"]) == (202, 1)
        assert 0 < begun.json()["seconds"] <= 500
        assert 0 < (await viewer.notice("leaving"))["seconds"] <= 500
        refused = await gateway.http.post("/api/sessions")
        assert (refused.status_code, refused.json()["title"]) == (503, "server is being stopped")
        assert "takes no new sessions" in refused.json()["detail"]
        assert int(refused.headers["retry-after"]) > 0
        lost = {"id": "0" * 32, "scene": {}}
        assert (await gateway.http.post("/api/sessions", json=lost)).status_code == 503, "another one makes it again"
        unready = await gateway.http.get("/readyz")
        assert (unready.status_code, "about to be stopped" in unready.json()["detail"]) == (503, True)
        assert (await gateway.http.get("/readyz?draining=404")).status_code == 404, "as HAProxy wants it"
        assert (await gateway.http.get("/healthz")).status_code == 200
        assert "\nculet_draining 1.0\n" in (await gateway.http.get("/metrics")).text
        turned = await gateway.http.post(f"/api/sessions/{session}/events", json={"type": "toggle_mirror"})
        assert turned.status_code == 200
        before = len(viewer.frames)
        await viewer.until(lambda: len(viewer.frames) > before)
        async with gateway.viewer(session) as late:
            assert (await late.notice("leaving"))["seconds"] > 0, "also to whoever comes to a session that is there"


async def test_a_draining_server_ends_when_the_last_viewer_leaves(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("culet.gateway.sessions.sessions.RELOAD_SECONDS", 0.0)
    async with gateway_before(engine, web=tmp_path) as gateway:
        async with gateway.viewer(await gateway.session()) as viewer:
            await viewer.frame()
            await gateway.http.post("/api/drain", json={"seconds": 500})
            await viewer.notice("leaving")
            assert not gateway.parts.stopping.is_set(), "somebody watches"
        async with asyncio.timeout(PATIENCE):
            await gateway.parts.stopping.wait()


async def test_a_draining_server_ends_when_its_time_is_up_and_says_why(gateway: Gateway) -> None:
    async with gateway.viewer(await gateway.session()) as viewer:
        await viewer.frame()
        await gateway.http.post("/api/drain", json={"seconds": 500})
        await viewer.notice("leaving")
        again = await gateway.http.post("/api/drain", json={"seconds": 0.1})
        assert again.json()["seconds"] <= 0.1, "the shorter time counts"
        await viewer.websocket.wait_closed()
        assert viewer.websocket.close_code == 1012, "service restart: the viewer comes back, to another server"


async def test_a_session_that_was_left_just_now_is_waited_for(gateway: Gateway) -> None:
    """Its page may be being loaded anew."""
    async with gateway.viewer(await gateway.session()) as viewer:
        await viewer.frame()

    async def left() -> bool:
        return gateway.parts.sessions.viewers == 0

    await eventually(left)
    assert await gateway.parts.sessions.in_use()
    for session in gateway.parts.sessions:
        session.used -= session_places.RELOAD_SECONDS
    assert not await gateway.parts.sessions.in_use()


async def test_only_who_has_the_token_may_have_the_server_stopped(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as gateway:
        assert (await gateway.http.post("/api/drain", json={"seconds": 500})).status_code == 401
        assert (await gateway.http.get("/readyz")).status_code == 200
        bearer = {"Authorization": f"Bearer {TOKEN}"}
        assert (await gateway.http.post("/api/drain", json={"seconds": 500}, headers=bearer)).status_code == 202


async def test_of_several_drains_the_shortest_counts() -> None:
    drain = Drain()
    drain.begin(500)
    drain.begin(900)
    assert 400 < drain.left <= 500
    drain.begin(0)
    assert drain.left == 0

    async def busy() -> bool:
        return True

    async with asyncio.timeout(PATIENCE):
        await drain.over(busy)


def test_seconds_of_a_drain_are_not_negative() -> None:
    with pytest.raises(ValueError, match="greater than or equal to 0"):
        GatewaySettings(control="ipc://unused", frames="ipc://unused", drain_seconds=-1)
    with Listener(GatewaySettings(control="ipc://unused", frames="ipc://unused", port=0)) as listener:
        assert listener.gateway.settings.drain_seconds == 0, "at once, as a server alone is stopped best"


async def test_a_server_that_others_reach_without_a_token_is_not_stopped_by_them(
    engine: Endpoints, tmp_path: Path
) -> None:
    async with gateway_before(engine, web=tmp_path, no_token=True, allow_host=("gems.example",)) as gateway:
        refused = await gateway.http.post("/api/drain", json={"seconds": 0})
        assert (refused.status_code, "could stop it" in refused.json()["detail"]) == (403, True)
        assert (await gateway.http.get("/readyz")).status_code == 200

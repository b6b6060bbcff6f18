"""Whoever asks for too much waits, and nobody else does: messages of streams, demands, requests, comings and goings."""

from __future__ import annotations

import asyncio
import json
import random
import re
import time
from pathlib import Path
from typing import Any

import pytest

from culet.gateway.admission.allowance import FREE
from culet.gateway.engine.link import EngineLink
from culet.gateway.limits.bucket import BURST_SECONDS
from culet.gateway.routes.stream import BYTES_PER_COST, EVENT_COST, MAX_CONTROL_BYTES
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.sessions.sessions import TICK_SECONDS, Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads.uploads import Uploads
from culet_protocol.engine import Demand
from culet_protocol.messages import Message, Orbit, Ping, Resize
from gateway.running import Endpoints, Gateway, eventually, gateway_before

RATE = 100.0
WAITED_SECONDS = 0.4
"""That the messages of a flood take longer than a burst."""


@pytest.mark.parametrize(
    "message",
    [
        '{"type": "resize", "width": 100, "height": 100}',
        '{"type": "orbit", "yaw": 0.01, "pitch": 0}',
        '{"type": "toggle_fall"}',
        '{"type": "visibility", "visible": true}',
        '{"type": "ping", "time": 1}',
        '{"type": "ack", "sequence": 1}',
        '{"type": "patch_scene", "patch": {"film": {"exposure": -1}}}',
        '{"type": "fly"}',
        "not json",
        b"\x00\x01\x02",
        "x" * (2 * MAX_CONTROL_BYTES),
        json.dumps({"type": "patch_scene", "patch": {"x": "y" * 20_000}}),
    ],
    ids=["resize", "orbit", "toggle_fall", "visibility", "ping", "ack", "refused", "unknown", "no json", "binary",
         "too large", "large"],
)  # fmt: skip
async def test_a_viewers_messages_are_read_at_its_rate_whatever_they_say_and_none_is_lost(
    engine: Endpoints, tmp_path: Path, message: str | bytes
) -> None:
    event = isinstance(message, str) and re.search("orbit|toggle_fall|patch_scene", message) is not None
    cost = (EVENT_COST if event else 1) + min(len(message), MAX_CONTROL_BYTES) / BYTES_PER_COST
    number = int(RATE * (BURST_SECONDS + WAITED_SECONDS) / cost) + 2  # the last is read when those before are paid for
    async with gateway_before(engine, web=tmp_path, viewer_messages_per_second=RATE) as gateway:
        async with gateway.viewer(await gateway.session(), size=None) as rude:
            began = time.monotonic()
            for _ in range(number):
                await rude.websocket.send(message)
            await rude.say(Ping(time=7))
            await rude.until(lambda: {"type": "pong", "time": 7} in rude.notices)
            assert time.monotonic() - began > WAITED_SECONDS - 0.05
        async with gateway.viewer(await gateway.session()) as other:
            await other.final()


async def test_viewers_of_one_client_share_its_rate_and_those_of_another_do_not(
    engine: Endpoints, tmp_path: Path
) -> None:
    limits = {"client_messages_per_second": RATE, "trusted_proxy": ("127.0.0.1",)}
    async with gateway_before(engine, web=tmp_path, **limits) as gateway:
        one = await gateway.session()
        async with (
            gateway.viewer(one, size=None, additional_headers={"X-Forwarded-For": "203.0.113.9"}) as first,
            gateway.viewer(one, size=None, additional_headers={"X-Forwarded-For": "203.0.113.9"}) as second,
            gateway.viewer(one, size=None, additional_headers={"X-Forwarded-For": "203.0.113.10"}) as stranger,
        ):
            began = time.monotonic()
            for _ in range(int(RATE * (BURST_SECONDS + 2 * WAITED_SECONDS))):
                await first.say(Ping(time=1))
            await first.until(lambda: {"type": "pong", "time": 1} in first.notices)
            await stranger.say(Ping(time=2))
            await stranger.notice("pong")
            await second.say(Ping(time=3))
            await second.notice("pong")
            await first.say(Ping(time=4))
            await first.until(lambda: {"type": "pong", "time": 4} in first.notices)
            assert time.monotonic() - began > WAITED_SECONDS


@pytest.fixture
def sessions() -> Sessions:
    settings = GatewaySettings(control="ipc://unused", frames="ipc://unused")
    link = EngineLink(settings)
    link.ready.set()
    return Sessions(settings, link, Uploads(link, 0))


async def test_one_demand_of_a_session_is_under_way_and_of_those_that_wait_the_latest_is_told(
    sessions: Sessions, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[tuple[int, int]] = []
    answer = asyncio.Semaphore(0)

    async def request(_link: object, message: Message, **_options: object) -> tuple[dict[str, Any], bytes]:
        assert isinstance(message, Demand)
        told.append((message.width, message.height))
        await answer.acquire()
        return {"width": message.width, "height": message.height}, b""

    monkeypatch.setattr(EngineLink, "request", request)
    session = SessionRecord("ab" * 16, {})
    sessions._sessions[session.id] = session
    viewer = sessions.join(session)
    for width in range(16, 1016):
        viewer.resize(width, 16)
        sessions.update_demand(session)
        await asyncio.sleep(0)
    assert told == [(16, 16)]
    answer.release()
    answer.release()
    assert session.demanding
    await session.demanding
    assert told == [(16, 16), (1015, 16)]


async def test_requests_over_a_clients_share_are_told_when_to_come_again_and_others_are_answered(
    engine: Endpoints, tmp_path: Path
) -> None:
    limits = {"client_messages_per_second": RATE / 20, "trusted_proxy": ("127.0.0.1",)}
    greedy, other = {"X-Forwarded-For": "203.0.113.9"}, {"X-Forwarded-For": "203.0.113.10"}
    async with gateway_before(engine, web=tmp_path, **limits) as gateway:
        session = await gateway.session()
        path = f"/api/sessions/{session}"
        for ask in (
            {"method": "POST", "url": f"{path}/events", "json": {"type": "toggle_mirror"}},
            {"method": "PATCH", "url": path, "json": {"film": {"exposure": 2}}},
            {"method": "PATCH", "url": path, "json": {"film": {"exposure": -2}}},
            {"method": "POST", "url": f"{path}/events", "content": b"{"},
        ):
            answers = await asyncio.gather(*(gateway.http.request(**ask, headers=greedy) for _ in range(60)))
            refused = [answer for answer in answers if answer.status_code == 429]
            assert len(refused) > 20
            assert refused[0].headers["content-type"] == "application/problem+json"
            assert 1 <= int(refused[-1].headers["retry-after"]) <= 2
        assert (await gateway.http.patch(path, json={"film": {"exposure": 1}}, headers=other)).status_code == 200
        assert (await gateway.http.get("/healthz", headers=greedy)).status_code == 200


async def test_the_interfaces_description_says_of_every_path_that_one_can_ask_too_often(gateway: Gateway) -> None:
    paths = (await gateway.http.get("/openapi.json")).json()["paths"]
    silent = {
        path for path, methods in paths.items() for method in methods.values() if "429" not in method["responses"]
    }
    assert silent <= FREE


async def test_of_viewers_that_come_and_go_others_are_told_a_few_times_a_second_and_the_last_count(
    gateway: Gateway,
) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as stays:
        began = time.monotonic()
        for _ in range(30):
            async with gateway.viewer(session, size=None) as passing:
                await passing.notice("hello")

        async def alone() -> bool:
            return gateway.parts.sessions.viewers == 1

        await eventually(alone)
        await stays.say(Ping(time=7))  # the notices come in a while, if the count changed since the last ones
        await stays.notice("pong")
        await stays.until(lambda: [told["count"] for told in stays.notices if told["type"] == "viewers"][-1] == 1)
        took = time.monotonic() - began
        assert sum(notice["type"] == "viewers" for notice in stays.notices) <= 2 + took / TICK_SECONDS


WORDS = ["type", "orbit", "patch_scene", "set_scene", "resize", "ack", "", "\ud800", "stones", "x" * 2000, "\0", "NaN"]


def hostile(chance: random.Random, depth: int = 0) -> object:
    """Any JSON, and what looks like an event."""
    match chance.randrange(9 if depth < 4 else 6):
        case 0:
            return chance.choice(WORDS)
        case 1:
            return chance.choice([float("nan"), float("inf"), -1e308, 10**400, -1, 0, 2**64])
        case 2:
            return chance.choice([None, True, False])
        case 3 | 4 | 5:
            kinds = ["orbit", "dolly", "push", "balance", "resize", "visibility", "ack", "ping", "toggle_fall", "hello"]
            fields = ["yaw", "pitch", "width", "height", "visible", "sequence", "time", "patch", "scene", "extra"]
            value: object = chance.choice([0.1, 1, 1e9, "far", None, [1], {}, True])
            return {"type": chance.choice(kinds)} | {chance.choice(fields): value for _ in range(chance.randrange(4))}
        case 6 | 7:
            return {chance.choice(WORDS): hostile(chance, depth + 1) for _ in range(chance.randrange(4))}
        case _:
            return [hostile(chance, depth + 1) for _ in range(chance.randrange(4))]


async def test_hostile_messages_close_no_stream_and_end_no_session(engine: Endpoints, tmp_path: Path) -> None:
    chance = random.Random(4711)  # noqa: S311 - the same messages every time
    limits = {"viewer_messages_per_second": 1e6, "client_messages_per_second": 1e6}
    async with gateway_before(engine, web=tmp_path, **limits) as gateway:
        session = await gateway.session()
        async with gateway.viewer(session) as rude, gateway.viewer(session) as other:
            for number in range(500):
                text = json.dumps(hostile(chance)).encode()
                cut = text[: chance.randrange(1, len(text) + 1)] if chance.random() < 0.2 else text
                await rude.websocket.send(cut if number % 10 == 0 else cut.decode())
            await rude.say(Ping(time=7))
            await rude.until(lambda: {"type": "pong", "time": 7} in rude.notices)
            await other.say(Resize(width=48, height=48))
            seen = len(other.frames)
            await other.say(Orbit(yaw=0.1, pitch=0))
            await other.until(lambda: len(other.frames) > seen)

"""However small the pieces are that a body comes in, everything else has its turn between them."""

from __future__ import annotations

import asyncio

import h11
import httpx

from culet.gateway.limits.turns import EVENTS_AT_ONCE, EVENTS_IN_A_TURN, TurnedConnection, Turns
from gateway.running import PATIENCE, gateway_alone

HEAD = (
    b"POST /api/render HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    b"Transfer-Encoding: chunked\r\n\r\n"
)
BYTES = 20_000
CHUNKS = b"1\r\n \r\n" * BYTES + b"2\r\n{}\r\n0\r\n\r\n"
"""A body of one byte in each chunk, and at last of two: blanks before an empty object of JSON."""


class Reading:
    """What the gateway's protocol does with a connection."""

    def __init__(self, turns: Turns) -> None:
        self.events = 0
        self._turns = turns
        self._connection = TurnedConnection(turns)
        self._connection.receive_data(HEAD + CHUNKS)
        self.go_on()

    def go_on(self) -> None:
        self._connection.begin()
        while self._connection.next_event() is not h11.NEED_DATA:
            self.events += 1
        if self._connection.has_more:
            self._turns.wait(self)


async def turned() -> None:
    """Until the loop has had its next turn."""
    await asyncio.sleep(0)


async def test_all_connections_together_have_so_many_events_in_a_turn_and_each_its_part() -> None:
    turns = Turns()
    readings = [Reading(turns) for _ in range(6)]
    told = [reading.events for reading in readings]
    assert told == [EVENTS_AT_ONCE] * (EVENTS_IN_A_TURN // EVENTS_AT_ONCE) + [0, 0], "the last two have to wait"
    for _ in range(30):
        await turned()
        now = [reading.events for reading in readings]
        assert 0 < sum(now) - sum(told) <= EVENTS_IN_A_TURN
        told = now
    assert max(told) - min(told) <= EVENTS_AT_ONCE, "all get on alike"


async def test_a_connection_that_is_gone_has_no_more_turns() -> None:
    turns = Turns()
    reading = Reading(turns)
    turns.forget(reading)
    await turned()
    await turned()
    assert reading.events == EVENTS_AT_ONCE


async def test_a_body_of_tiny_chunks_is_read_to_its_end_in_many_turns_and_what_follows_it_too() -> None:
    async with gateway_alone() as gateway:
        url = httpx.URL(gateway.url)
        reader, writer = await asyncio.open_connection(url.host, url.port)
        count = 0

        async def tick() -> None:
            nonlocal count
            while True:
                await asyncio.sleep(0)
                count += 1

        ticking = asyncio.create_task(tick())
        writer.write(HEAD + CHUNKS + b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        async with asyncio.timeout(PATIENCE):
            answers = await reader.read()
        ticking.cancel()
        writer.close()
        assert answers.startswith(b"HTTP/1.1 503"), "the body is fine, but there is no engine"
        assert b"HTTP/1.1 200 OK" in answers
        assert count >= BYTES / EVENTS_AT_ONCE

"""What one client asks for at once, one after the other."""

from __future__ import annotations

import asyncio

from culet.client_turns import ClientTurns
from shared.patience import PATIENCE


async def test_a_client_has_one_turn_at_a_time_and_another_client_its_own() -> None:
    turns, order = ClientTurns(), list[str]()

    async def work(client: str, name: str, end: asyncio.Event) -> None:
        async with turns.turn(client):
            order.append(name)
            await end.wait()

    ends = [asyncio.Event() for _ in range(3)]
    tasks = [
        asyncio.create_task(work(client, name, end))
        for client, name, end in zip("aab", ("a1", "a2", "b1"), ends, strict=True)
    ]
    for _ in range(5):
        await asyncio.sleep(0)
    assert order == ["a1", "b1"]
    ends[0].set()
    await tasks[0]
    for _ in range(5):
        await asyncio.sleep(0)
    assert order == ["a1", "b1", "a2"]
    for end in ends:
        end.set()
    await asyncio.gather(*tasks)
    del tasks
    assert len(turns) == 0, "nothing is kept of clients that wait for nothing"


async def test_a_turn_that_is_given_up_holds_up_nobody() -> None:
    turns = ClientTurns()
    async with turns.turn("a"):
        waiting = asyncio.create_task(turns.turn("a").__aenter__())
        await asyncio.sleep(0)
        waiting.cancel()
        await asyncio.gather(waiting, return_exceptions=True)
    async with asyncio.timeout(PATIENCE), turns.turn("a"):
        pass

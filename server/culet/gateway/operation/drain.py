"""A server that is about to be stopped: who is there may stay a while, and nobody new comes."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable

from culet.errors import LeavingError

LOOK_SECONDS = 0.1
"""Between looks whether anybody is still there."""
REFUSAL = (
    "this server is about to be stopped and takes no new sessions; ask again in a moment: another server may answer, "
    "or the same one when it is back"
)


class Drain:
    """States: serving -> draining (`begun`) -> over, when nobody is there any more or the time is up."""

    def __init__(self) -> None:
        self.begun = asyncio.Event()
        self._until = float("inf")

    def begin(self, seconds: float) -> None:
        """From now on nobody new comes; who is there may stay for so long. Of several times the shortest counts."""
        self._until = min(self._until, time.monotonic() + seconds)
        self.begun.set()

    @property
    def left(self) -> float:
        """Seconds that those who are there have at most."""
        return max(0.0, self._until - time.monotonic())

    def admit(self) -> None:
        """LeavingError if somebody new may not come."""
        if self.begun.is_set():
            raise LeavingError(REFUSAL)

    async def over(self, busy: Callable[[], Awaitable[bool]]) -> None:
        """Once it is begun: wait until nobody is there, or the time is up."""
        await self.begun.wait()
        while self.left > 0 and await busy():  # noqa: ASYNC110 - others leave by themselves
            await asyncio.sleep(min(LOOK_SECONDS, self.left))

"""Frames on their way out: encoded on threads of their own while the next one is rendered, and sent in order."""

from __future__ import annotations

import asyncio
import math
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from culet.engine.governing.thrift import NO_LIMITS, Allowance, Thrift
from culet.engine.painting.counters import Tally
from culet.engine.painting.failure import as_culet_error
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.session.session import Session
from culet.errors import CuletError

UNSENT_FRAMES = 2
"""That may wait to be encoded and sent before no other is begun."""


@dataclass(eq=False)
class Outgoing:
    """Of one session."""

    message: bytes | None = None
    """The frame sent last."""
    sent_at: float = 0.0
    """s, steady clock: when that was."""
    unsent: int = 0
    """Frames that are being encoded, or wait for that."""
    allowance: Allowance = NO_LIMITS
    """Bytes that frames may have."""
    latest: asyncio.Task[None] | None = None
    """Encodes and sends the frame that was drawn last."""

    @property
    def full(self) -> bool:
        """Whether so many frames wait that no other should be begun."""
        return self.unsent >= UNSENT_FRAMES


class FrameSender:
    """Of all sessions."""

    def __init__(
        self,
        send: Callable[[bytes], None],
        tell_problem: Callable[[Session, CuletError], None],
        wake: Callable[[], None],
        tally: Tally,
        clock: Callable[[], float],
    ) -> None:
        """`send` puts a message on the wire and does not wait, `wake` is called when a frame has left."""
        self._send = send
        self._tell_problem = tell_problem
        self._wake = wake
        self._tally = tally
        self._now = clock
        self._threads = ThreadPoolExecutor(max(1, (os.cpu_count() or 1) // 2), "encode")

    def publish(self, session: Session, outgoing: Outgoing, thrift: Thrift, frame: LiveFrame, begun_at: float) -> None:
        """Encode and send a frame that was begun at that time of the clock; this does not wait for either."""
        outgoing.unsent += 1
        work = self._encode_and_send(session, outgoing, thrift, frame, begun_at, before=outgoing.latest)
        outgoing.latest = asyncio.create_task(work)

    def repeat(self, outgoing: Outgoing) -> None:
        """Send the frame sent last again, if there was one."""
        if outgoing.message is not None:
            outgoing.sent_at = self._now()
            self._tally.counters.frames_repeated += 1
            self._send(outgoing.message)

    def stop(self) -> None:
        """Encode nothing more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def _encode_and_send(
        self,
        session: Session,
        outgoing: Outgoing,
        thrift: Thrift,
        frame: LiveFrame,
        begun_at: float,
        before: asyncio.Task[None] | None,
    ) -> None:
        at_rest = outgoing.allowance.at_rest or math.inf
        drawn_at, started = self._now(), time.perf_counter()
        try:
            encoded = await asyncio.get_running_loop().run_in_executor(self._threads, frame.encoded, at_rest)
            encode_seconds = time.perf_counter() - started
            if frame.encoding is not None:
                thrift.encoded((encoded.width, encoded.height), encoded.quality, len(encoded.data))
            if before is not None:
                await asyncio.wait([before])  # so that frames leave in order
            session.sequence += 1
            message = frame.pack(session, encoded, encode_seconds)
        except Exception as error:  # one session's failure must not end the others'
            self._tell_problem(session, as_culet_error(error, what="encoding"))
            return
        finally:
            outgoing.unsent -= 1
            self._wake()
        now = self._now()
        self._tally.durations.encode_wait.add(max(0.0, now - drawn_at))
        self._tally.durations.frame.add(max(0.0, now - begun_at))
        outgoing.message, outgoing.sent_at = message, now
        self._tally.counters.frames_sent += 1
        self._send(message)

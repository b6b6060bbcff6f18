"""The render loop: live frames, refinements and stills share one render thread.

Nobody watching, nothing rendered; at rest a picture is refined until it is good enough, and then costs nothing but
being sent again, ever more rarely. The loop never waits for anything but one short piece of work of the render thread.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from culet.engine.capacity.freed import give_back_freed
from culet.engine.painting import schedule
from culet.engine.painting.counters import Counters, Durations, SharedCounters
from culet.engine.painting.frame_sender import FrameSender
from culet.engine.painting.live_painter import LivePainter, Stepping
from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.preparation import in_daemon_thread
from culet.engine.painting.render_thread import RenderThread
from culet.engine.painting.renderer import AnyRenderer
from culet.engine.painting.rest_turns import take_turns
from culet.engine.painting.shares import Shares, share
from culet.engine.painting.still import EncodeStill, StillQueue
from culet.engine.painting.still_painter import StillPainter
from culet.engine.session.session import Session
from culet.engine.session.stepper import Stepper
from culet.errors import CuletError
from culet.rendering.film.target import Target
from culet.stage import Stage
from culet_protocol.frame import Codec
from culet_protocol.watch import Lesser, Stream

IDLE_SECONDS = 2.0
"""For which nothing is drawn before the memory that is kept for the next pictures is given back."""


class Painter:
    """Renders what is due; `run` until cancelled."""

    def __init__(
        self,
        renderer: AnyRenderer,
        render_thread: ThreadPoolExecutor,
        stills: StillQueue,
        *,
        send: Callable[[bytes], None],
        tell_problem: Callable[[str, CuletError], None],
        encode_still: EncodeStill,
        still_seconds: float,
        rest: Target,
        stepper: Stepping | None = None,
        clock: Callable[[], float] = time.monotonic,
        has_room: Callable[[int], bool] = lambda _: True,
    ) -> None:
        """`send` puts a frame on the wire, `tell_problem` tells of a session that could not go on; neither waits.

        A still may take `still_seconds` of the render thread. Pictures at rest are refined to `rest`. `clock` is
        a steady one, in seconds. `has_room` tells whether an encoder of video may take so many bytes.
        """
        self.pictures: dict[str, LivePicture] = {}
        self._forgotten: list[LivePicture] = []
        """Pictures of sessions that are closed, which still have their memory."""
        self._renderer = renderer
        self._stills = stills
        self._tell_of_problem = tell_problem
        self._now = clock
        self._shares = Shares()
        self._drew_at: float | None = None
        """s: when something was drawn last. None: nothing since memory was given back last."""
        self._tally = tally = SharedCounters()
        self._changed = asyncio.Event()
        thread = RenderThread(render_thread, self._shares, tally, clock)
        self._sender = FrameSender(send, self._tell_problem, self.wake, tally, clock, has_room)
        self._still_painter = StillPainter(stills, renderer, thread, encode_still, still_seconds, tally, clock)
        self._live_painter = LivePainter(
            renderer, thread, self._shares, self._sender, stepper or Stepper(clock=clock), rest,
            share_of=self._share_of, tell_problem=self._tell_problem, wake=self.wake, tally=tally, clock=clock,
        )  # fmt: skip

    @property
    def counters(self) -> Counters:
        """Since the engine started."""
        return self._tally.counters

    @property
    def durations(self) -> Durations:
        """Since the engine started."""
        return self._tally.durations

    def wake(self) -> None:
        """Something changed: look again for what is due."""
        self._changed.set()

    def forget(self, session: str) -> None:
        """The session is closed: its picture gives its memory back, as soon as no piece of it is under way."""
        self._forgotten.append(self.pictures.pop(session))
        self.wake()

    def show_again(self, live: LivePicture, codec: Stream) -> None:
        """Send the latest frame at once, for a viewer who has just come, or wants it in another form than before."""
        if live.at_rest and codec is Codec.JPEG:
            self._sender.send_anew(live.session, live.outgoing)
        elif live.current:
            self._sender.repeat(live.outgoing)
        if live.at_rest and not isinstance(codec, Lesser) and live.outgoing.message is None:
            live.draw_anew()
        self.wake()

    def improve(self, live: LivePicture) -> None:
        """Send the picture at rest in a better quality, if the links of those who watch have got better."""
        if live.at_rest and live.making is None:
            self._sender.improve(live.session, live.outgoing)

    async def run(self) -> None:
        """Paint for ever."""
        try:
            while True:
                self._changed.clear()
                if not await self.work():
                    await self._rest()
        finally:
            for part in (self._live_painter, self._sender, self._still_painter):
                part.stop()

    async def work(self) -> bool:
        """One piece of work, one repetition; whether there was anything."""
        pictures, now = list(self.pictures.values()), self._now()
        while self._forgotten:
            self._forgotten.pop().abandon(now)
        for live in pictures:
            if live.outdated(now):
                self.counters.frames_given_up += 1
                live.give_up(now)
            if not live.watched:
                live.abandon(now)
        take_turns(pictures, now)
        chosen = schedule.next_work(pictures, self._stills, self._shares, now)
        if chosen is not None:
            self._drew_at = now
        if isinstance(chosen, LivePicture):
            chosen.next_account.payers = schedule.payers(chosen, pictures, now)
            await self._live_painter.advance(chosen)
        elif chosen is not None and (still := chosen.next()) is not None:
            await self._still_painter.advance(still)
        repeat = schedule.next_repeat(pictures, self._now())
        if repeat is not None:
            self._sender.repeat_by_itself(repeat.outgoing)
        return chosen is not None or repeat is not None

    async def make_ready(self, stage: Stage, samples: int = 0) -> None:
        """Have what the next sample of a picture of the stage needs compiled that has so many, while others are
        drawn."""
        await in_daemon_thread(lambda: self._renderer.make_ready(stage, samples))

    async def _rest(self) -> None:
        seconds = schedule.idle_seconds(self.pictures.values(), self._now())
        if self._drew_at is not None:
            idle = self._drew_at + IDLE_SECONDS - self._now()
            if idle <= 0:
                self._drew_at = None
                await self._give_back()
            else:
                seconds = idle if seconds is None else min(seconds, idle)
        try:
            async with asyncio.timeout(seconds):
                await self._changed.wait()
        except TimeoutError:
            pass

    async def _give_back(self) -> None:
        """Nothing is drawn: what pictures that are gone had goes back to the system."""
        self._renderer.release()
        await in_daemon_thread(give_back_freed)

    def _share_of(self, live: LivePicture) -> float:
        """The part of the render thread's time that a session can have."""
        others = [account for other in self.pictures.values() for account in (other.frames, other.rest)]
        return share(live.frames, [*others, self._stills.account], self._now())

    def _tell_problem(self, session: Session, error: CuletError) -> None:
        self.counters.problems += 1
        self._tell_of_problem(session.name, error)

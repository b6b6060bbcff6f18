"""Live frames and their refinements, drawn in pieces on the render thread; the stepper moves what they show."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Protocol

from culet.engine.painting.counters import SharedCounters
from culet.engine.painting.failure import as_culet_error
from culet.engine.painting.frame_sender import FrameSender
from culet.engine.painting.frame_work import FrameWork, Unprepared, WorkKind, has_shape, proceed
from culet.engine.painting.live_picture import (
    FINE_SAMPLES,
    FINE_SECONDS,
    FINE_WEIGHT,
    NEVER,
    REST_WEIGHT,
    LivePicture,
    PictureState,
    Preparing,
)
from culet.engine.painting.preparation import in_daemon_thread
from culet.engine.painting.render_thread import RenderThread
from culet.engine.painting.renderer import ALONE_SECONDS, AnyRenderer
from culet.engine.painting.shares import Account, Shares
from culet.engine.session.motion import StonesMotion
from culet.engine.session.session import Session, ShownScene
from culet.errors import CuletError
from culet.rendering.film.target import Target


class Stepping(Protocol):
    """Who takes the steps of motions; `culet.engine.session.stepper.Stepper` is one."""

    def keep_going(self, steps: StonesMotion) -> None:
        """See to it that the steps of a motion are taken, from now on as long as there are any. Does not wait."""

    def stop(self) -> None:
        """Take no more steps."""


class LivePainter:
    """Brings one live picture after the other a piece further."""

    def __init__(
        self,
        renderer: AnyRenderer,
        thread: RenderThread,
        shares: Shares,
        sender: FrameSender,
        stepper: Stepping,
        rest: Target,
        *,
        share_of: Callable[[LivePicture], float],
        tell_problem: Callable[[Session, CuletError], None],
        wake: Callable[[], None],
        tally: SharedCounters,
        clock: Callable[[], float],
    ) -> None:
        """Pictures at rest are refined to `rest`. `share_of` tells the part of the render thread's time that a picture
        can have; `wake` is called when something that was waited for is there."""
        self._renderer = renderer
        self._thread = thread
        self._shares = shares
        self._sender = sender
        self._share_of = share_of
        self._tell_problem = tell_problem
        self._wake = wake
        self._tally = tally
        self._now = clock
        self._stepper = stepper
        self._rest = rest

    async def advance(self, live: LivePicture) -> None:
        """The next piece of a frame or of a refinement, begun if need be."""
        if live.wants_refinement():
            self._begin_refinement(live)
        if live.work is not None:
            await self._go_on(live, live.work)
        else:
            self._begin(live)

    def stop(self) -> None:
        """Move nothing more."""
        self._stepper.stop()

    def _begin(self, live: LivePicture) -> None:
        """Choose what to draw: what is there now of the motion, which waits for no step, and goes on meanwhile."""
        account, now, settled = live.next_account, self._now(), live.settled
        # A frame before its turn is begun for what came since, nobody knows when: nothing is known to have waited.
        if live.begun_at > NEVER and not live.answers_early(now) and (due_at := live.due_at()) is not None:
            self._tally.durations.frame_wait.add(max(0.0, now - max(due_at, live.unwatched_at)))
        live.begin(now)
        session = live.session
        if (problem := session.motion.take_problem()) is not None:  # the stones have stopped
            self._tell_problem(session, as_culet_error(problem, CuletError, "simulating"))
        if session.motion.look_on(now, self._share_of(live)):
            self._stepper.keep_going(session.motion)
        session.look(now)
        shown = session.shown
        session.remember(shown)
        simulated = session.motion.take_spent()
        self._shares.charge(account, simulated, now)
        if not live.current or live.state is PictureState.BLANK or settled:  # or the motion has not gone on
            try:
                live.making = self._planned(live, shown, account, now, simulated)
            except Exception as error:  # one session's failure must not end the others'
                self._refuse(live, shown, error)

    def _planned(
        self, live: LivePicture, shown: ShownScene, account: Account, begun_at: float, simulated: float
    ) -> FrameWork:
        """Choose how to draw what is shown."""
        wanted = live.size  # as of now: it may change while the picture is rendered, which then is not current
        outgoing = live.outgoing
        plan = (
            live.quality.plan(shown.scene, wanted, live.balance, outgoing.allowance, video=outgoing.is_video)
            if live.governed
            else None
        )
        kind = WorkKind.FULL if plan is None else WorkKind.PLANNED
        work = FrameWork(kind, shown, wanted, account, begun_at, plan, simulate_seconds=simulated, now=self._now)
        if plan is None and shown is live.painted and live.seen is not None and has_shape(live.seen, wanted):
            work.over, work.seen_at = live.seen, None if live.state is PictureState.FINAL else live.seen_at
        if self._share_of(live) >= 1:
            work.piece_seconds = ALONE_SECONDS
        work.slow = shown.moving and live.session.motion.pace.slow
        work.spent = self._now() - begun_at
        work.start(self._renderer)
        return work

    def _begin_refinement(self, live: LivePicture) -> None:
        """More samples of the picture; of one that has given its memory back all anew."""
        picture, shown = live.picture, live.painted
        assert shown is not None  # noqa: S101 - of a picture that wants to be refined
        fine = live.seen_samples >= FINE_SAMPLES
        live.rest.weight = FINE_WEIGHT if fine else REST_WEIGHT
        work = FrameWork(
            WorkKind.REFINED, shown, live.painted_size, live.rest, self._now(), picture=picture, aim=self._rest,
            now=self._now, render_seconds=0.0 if picture is None else live.render_seconds, over=live.seen,
            seen_at=live.seen_at, seen_samples=live.seen_samples if picture is None else 0,
        )  # fmt: skip
        if fine and self._share_of(live) < 1:
            work.piece_seconds = FINE_SECONDS
        work.start(self._renderer)
        live.making = work

    async def _go_on(self, live: LivePicture, work: FrameWork) -> None:
        """The next piece; what is done is sent."""
        started = self._now()
        try:
            more = await self._thread.run(work.account, proceed, work.pieces, self._now, work.hold_seconds)
        except Unprepared:
            if work.kind is WorkKind.REFINED:
                live.making, live.preparing_more = None, asyncio.create_task(self._prepare_more(live, work))
            else:
                live.making = Preparing(asyncio.create_task(self._prepare(live, work)))
            return
        except Exception as error:  # one session's failure must not end the others'
            self._refuse(live, work.shown, error)
            return
        work.spent += self._now() - started
        if more or work.frame is None or work.picture is None:
            return
        live.drew(work, self._now())
        if work.kind is WorkKind.REFINED:
            self._tally.counters.refinements += 1
        else:
            self._tally.counters.frames_rendered += 1
        governor, seconds = live.quality.governor, work.picture.seconds
        asked, steered = (live.frames_per_second, self._share_of(live)), live.steered(self._now())
        if work.plan is not None:
            governor.rendered(work.plan, seconds, work.spent - seconds, *asked, steered=steered)
        elif work.first_seconds is not None:
            governor.rested(work.shown.scene, work.wanted, work.first_seconds, *asked, steered=steered)
        live.outgoing.lesser.room = live.quality.room(live.balance, live.outgoing.lesser.allowance)
        self._sender.publish(live.session, live.outgoing, live.quality.encoded, work.frame, work.begun_at)

    async def _prepare(self, live: LivePicture, work: FrameWork) -> None:
        try:
            await in_daemon_thread(lambda: self._renderer.make_ready(work.stage, work.samples))
        except Exception as error:  # as above
            self._refuse(live, work.shown, error)
        finally:
            live.making = None
            self._wake()

    async def _prepare_more(self, live: LivePicture, work: FrameWork) -> None:
        """The same of a refinement: what is shown may change meanwhile."""
        try:
            await in_daemon_thread(lambda: self._renderer.make_ready(work.stage, work.samples))
        except Exception as error:  # as above
            if live.painted is work.shown:
                self._refuse(live, work.shown, error)
        finally:
            live.preparing_more = None
            self._wake()

    def _refuse(self, live: LivePicture, shown: ShownScene, error: Exception) -> None:
        live.refuse(shown)
        self._tell_problem(live.session, as_culet_error(error))

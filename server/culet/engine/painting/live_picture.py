"""The live picture of one session: who wants it, what there is of it, and when its next frame is due."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from culet.engine.governing.governor import asked_rate
from culet.engine.painting.frame_sender import Outgoing
from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.engine.painting.lesser_tier import fitting
from culet.engine.painting.quality import Quality
from culet.engine.painting.renderer import AnyPicture
from culet.engine.painting.rest_turn import RestTurn
from culet.engine.painting.shares import Account
from culet.engine.session.session import Session, ShownScene
from culet_protocol.messages import Balance
from culet_protocol.sizes import LIVE_SIZE

NATIVE_RATE = 30.0
"""Frames per second for viewers that only subscribe, and cannot say what they take."""

SETTLE_SECONDS = 0.2
"""If the camera or the scene changes again within this time after a picture was drawn, somebody is moving something:
the picture is governed as a falling stone's is. The picture is drawn in full once this time has passed without a
change. How long the drawing took does not count. A picture that takes longer than this in full is governed at its first
change too, or nothing would be seen of the change meanwhile."""

REST_WEIGHT = 0.25
"""Share of the render thread's time for a picture at rest beside one that moves: it can wait, motion cannot."""

FINE_WEIGHT = 0.05
"""The same once it has FINE_SAMPLES: what it gains then is hardly seen, and takes long."""
FINE_SAMPLES = 16
FINE_SECONDS = 0.005
"""That a launch then takes beside others' work, which so waits little: a frame of 60 a second has 16 ms in all."""

ANSWER_SECONDS = 0.1
"""After the last answer, and no less than ANSWER_FRAMES of the time between frames, an input that comes alone is
answered by a frame begun early: ANSWER_PART of that time after the last frame. Those of a hand that goes on come
faster, and are answered at the rate that is held: there would be twice as many frames."""
ANSWER_FRAMES = 1.5
ANSWER_PART = 0.5

STEERED_SECONDS = 1.0
"""After an input was answered last, for which somebody counts as steering: keys are pressed a few times a second."""

STALE_SECONDS = 0.25
"""A reduced frame that takes longer is given up for something newer, unless the frame before was given up too."""
FIRST_LOOK_SECONDS = 0.5
"""Of work on a picture in full of which nothing is to be seen yet: then a reduced picture is made first."""

NEVER = -1e9
"""s, of a steady clock: when what has not happened yet last happened."""


class PictureState(Enum):
    """What there is of the picture that was drawn last."""

    BLANK = auto()
    """Nothing, or no longer anything that could be refined."""
    REDUCED = auto()
    """As the governor had it: it is to be drawn in full when things have settled."""
    FULL = auto()
    """In full, to be refined."""
    FINAL = auto()
    """As good as pictures at rest become."""
    REFUSED = auto()
    """It could not be rendered."""


@dataclass(frozen=True, eq=False)
class Preparing:
    """Programs and trees are made that the next picture needs."""

    task: asyncio.Task[None]


Making = Preparing | FrameWork
"""What is under way: a frame, or what it needs."""


@dataclass(eq=False)
class LivePicture:
    """Mutable; belongs to the painter."""

    session: Session
    watched: bool = False
    """Somebody subscribes to the session's frames. That, and not what a gateway demanded, is why frames are made: a
    subscription ends with its subscriber, however that ends."""
    rate: float = 0.0
    """Frames per second that the gateway's viewers can take; 0 if it has none."""
    size: tuple[int, int] = LIVE_SIZE
    state: PictureState = PictureState.BLANK
    picture: AnyPicture | None = None
    """That can be refined: none of a reduced one, which is drawn anew."""
    painted: ShownScene | None = None
    """What the picture drawn last shows, or what was refused."""
    painted_size: tuple[int, int] = (0, 0)
    seen: NDArray[np.uint8] | None = None
    """(height, width, 3): the frame that was drawn last, for a better or a larger one of the same."""
    seen_at: float = NEVER
    """s, steady clock: when that was."""
    seen_samples: int = 0
    """Of each pixel of that, at least, if it was drawn in full."""
    render_seconds: float = 0.0
    """Of all samples of the picture."""
    turn: RestTurn = field(default_factory=RestTurn)
    """At being refined; of what the picture shows."""
    making: Making | None = None
    """The next frame, or a better one of what is shown; None while nothing is under way."""
    preparing_more: asyncio.Task[None] | None = None
    """What refining the picture needs is being made; meanwhile other frames can be."""
    outgoing: Outgoing = field(default_factory=Outgoing)
    quality: Quality = field(default_factory=Quality)
    settles_at: float = 0.0
    """s, steady clock: from when on a reduced picture is to be drawn in full, if nothing moves."""
    changed_at: float = NEVER
    """s, steady clock: when something new had last been drawn, or been given up for something newer."""
    unwatched_at: float = NEVER
    """s, steady clock: when nobody watched last."""
    begun_at: float = NEVER
    """s, steady clock: when the last frame was begun, or should have been if it was a little late."""
    answered_at: float = NEVER
    """s, steady clock: when a frame was last begun that shows what somebody did."""
    frames: Account = field(init=False)
    """Of frames that somebody waits for."""
    rest: Account = field(init=False)
    """Of what makes a picture at rest better."""

    def __post_init__(self) -> None:
        self.frames, self.rest = Account(self), Account(self, REST_WEIGHT)

    @property
    def work(self) -> FrameWork | None:
        """The frame in the making, if it has come so far."""
        return self.making if isinstance(self.making, FrameWork) else None

    @property
    def frames_per_second(self) -> float:
        """The rate to keep to; a native viewer takes what the gateway's viewers take, if there are any."""
        return asked_rate(self.session.balance, self.rate or NATIVE_RATE)

    @property
    def current(self) -> bool:
        """Whether the picture, and the frame made of it, still are what is shown."""
        drawn = self.state is not PictureState.REFUSED and self.painted is self.session.shown
        return drawn and self.painted_size == self.size

    @property
    def at_rest(self) -> bool:
        """Whether the picture is right until somebody changes something."""
        return self.current and not self.session.shown.moving

    @property
    def settled(self) -> bool:
        """Whether the picture is a reduced one of what no longer changes."""
        return self.state is PictureState.REDUCED and self.at_rest

    def due_at(self) -> float | None:
        """When the next first-sample frame is to be begun (steady clock), or None if nothing calls for one."""
        if not self.watched or self.making is not None or self.outgoing.full:
            return None
        if self.session.lock.locked():  # a stone is being made, which may take seconds: others need not wait for it
            return None
        next_at = self._next_at()
        match self.state:
            case PictureState.BLANK:
                return next_at
            case PictureState.REDUCED:
                return max(self.settles_at, next_at) if self.at_rest else next_at
            case PictureState.FULL | PictureState.FINAL:
                return None if self.at_rest else next_at
            case PictureState.REFUSED:  # not tried again until something else is to be shown
                return None if self.painted is self.session.shown else next_at
            case _:
                assert_never(self.state)

    def _next_at(self) -> float:
        """When the frame after the last one is to be begun, if there is to be one."""
        interval = 1 / self.frames_per_second
        if not self.unanswered:
            return self.begun_at + interval
        alone_at = self.answered_at + max(ANSWER_SECONDS, ANSWER_FRAMES * interval)
        return min(self.begun_at + interval, max(self.begun_at + ANSWER_PART * interval, alone_at))

    def answers_early(self, now: float) -> bool:
        """Whether a frame begun now comes before its turn, for what somebody did."""
        return self.unanswered and now < self.begun_at + 1 / self.frames_per_second

    def steered(self, now: float) -> bool:
        """Whether somebody is at it: what they do is to be seen soon."""
        return now - self.answered_at < STEERED_SECONDS

    @property
    def unanswered(self) -> bool:
        """Whether somebody did something since the last frame was begun: what moves by itself is looked at then."""
        return self.painted is not None and self.painted is not self.session.shown

    @property
    def next_account(self) -> Account:
        """Whose time the next piece of work is."""
        if self.work is not None:
            return self.work.account
        return self.rest if self.at_rest and self.state is not PictureState.BLANK else self.frames

    @property
    def governed(self) -> bool:
        """Whether the governor is to choose how the frame just begun is drawn."""
        shown = self.session.shown
        if shown.moving or shown is self.painted:  # in the latter case only the size changed, or it is drawn in full
            return shown.moving
        again = self.begun_at - self.changed_at < max(SETTLE_SECONDS, 2 / self.frames_per_second)
        return again or self.quality.full_seconds > SETTLE_SECONDS

    @property
    def balance(self) -> Balance:
        """The session's, but not pinned to what has proven too dear."""
        return self.quality.balance(self.session.balance, self.session.shown.scene.optics, self.size)

    def begin(self, now: float) -> None:
        """A frame is begun. One that is late by less than a frame does not make those after it late."""
        due = None if self.answers_early(now) else self.due_at()
        if self.unanswered:
            self.answered_at = now
        little = due is not None and 0 <= now - due < 1 / self.frames_per_second
        self.begun_at = due if due is not None and little else now

    def drew(self, work: FrameWork, now: float) -> None:
        """A frame is done."""
        assert work.picture is not None  # noqa: S101 - of a frame that is done
        if work.shown is not self.painted:
            self.changed_at = now
        if work.shown is not self.painted or work.wanted != self.painted_size:
            self.turn = RestTurn()
        self.making = None
        self.quality.drew(work)
        self.painted, self.painted_size, self.render_seconds = work.shown, work.wanted, work.render_seconds
        if self.picture is not work.picture:
            self._let_go()
        match work.kind:
            case WorkKind.PLANNED:
                self.state, self.picture, self.settles_at = PictureState.REDUCED, None, now + SETTLE_SECONDS
            case WorkKind.FULL | WorkKind.REFINED:
                self.state, self.picture, self.seen_samples = PictureState.FULL, work.picture, work.picture.samples_seen
                self.turn.spent += work.spent
            case _:
                assert_never(work.kind)
        self.seen, self.seen_at = None if work.frame is None else work.frame.rgb, now
        if work.final:
            self._let_go()
            self.state = PictureState.FINAL

    def outdated(self, now: float) -> bool:
        """Whether the frame in the making is to be given up."""
        work = self.work
        if work is None:
            return False
        if not self.watched:
            return True
        newer = work.shown is not self.session.shown or work.wanted != self.size
        match work.kind:
            case WorkKind.PLANNED:
                if self.quality.is_too_dear(work, pinned=self.balance.pinned):
                    return True
                return newer and now - work.begun_at > STALE_SECONDS and not self.quality.gave_up
            case WorkKind.FULL:
                unseen = self.painted is not work.shown
                return newer or (unseen and work.spent > FIRST_LOOK_SECONDS)
            case WorkKind.REFINED:
                return newer
            case _:
                assert_never(work.kind)

    def give_up(self, now: float) -> None:
        """Drop the frame in the making."""
        work = self.work
        if work is None:
            return
        self.making = None
        work.give_up()
        if work.shown is not self.session.shown or work.wanted == self.size:  # else only its size was wrong
            self.changed_at = now
        match work.kind:
            case WorkKind.PLANNED:
                self.quality.give_up_planned(
                    work, self.session.balance, self.frames_per_second, pinned=self.balance.pinned
                )
            case WorkKind.FULL:
                self.quality.give_up_full(work)
            case WorkKind.REFINED:  # its sums are neither those of before nor those of after
                self._let_go()
                self.state = PictureState.BLANK
            case _:
                assert_never(work.kind)

    @property
    def could_be_refined(self) -> bool:
        """Whether more samples would improve what is seen, as far as is wanted."""
        return self.watched and self.at_rest and self.state is PictureState.FULL

    def wants_refinement(self) -> bool:
        """Whether they would, it has its turn, and nothing is in their way."""
        idle = self.making is None and self.preparing_more is None and not self.outgoing.full
        return self.could_be_refined and self.turn.has and idle

    def put_down(self) -> None:
        """Its memory is needed by others; what is seen of it stays. It is begun anew when it has its turn."""
        if self.making is None:
            self._let_go()

    def refuse(self, shown: ShownScene) -> None:
        """It cannot be rendered."""
        self._let_go()
        self.making, self.painted, self.state = None, shown, PictureState.REFUSED
        self.seen = None

    def try_again(self) -> None:
        """What could not be rendered may be rendered now."""
        if self.state is PictureState.REFUSED:
            self.state = PictureState.BLANK

    def draw_anew(self) -> None:
        """The picture at rest is wanted in a form in which it was not sent; a frame under way brings it by itself."""
        if self.making is None and self.state in (PictureState.FULL, PictureState.FINAL):
            self._let_go()
            self.seen, self.state = None, PictureState.BLANK

    def resize_lesser(self, size: tuple[int, int]) -> None:
        """Lesser pictures are to fill other windows. One at rest is made anew if it is smaller than that."""
        lesser = self.outgoing.lesser
        had, lesser.size = lesser.size, size
        if had is None or not self.at_rest or lesser.message is None:
            return
        if lesser.fitting(self.painted_size) > fitting(self.painted_size, had):
            self.draw_anew()

    def abandon(self, now: float) -> None:
        """Nobody watches: free the picture's memory, keep the message, and what it shows if that is still shown."""
        if self.work is not None:
            self.work.give_up()
            self.making = None
        self._let_go()
        self.seen = None
        self.session.motion.look_away()
        self.unwatched_at = now
        if self.state in (PictureState.REDUCED, PictureState.FULL) or self.outgoing.is_thrifty:
            self.state = PictureState.BLANK
        self.outgoing.forget_frame()
        if self.painted is not self.session.shown:
            self.painted = None

    def _let_go(self) -> None:
        """Give back the picture's memory."""
        if self.picture is not None:
            self.picture.give_up()
        self.picture = None

    def repeat_at(self) -> float | None:
        """When the frame sent last is to be sent again."""
        known = self.watched and self.current and (self.outgoing.message or self.outgoing.lesser.message)
        return self.outgoing.sent_at + self.outgoing.silent_seconds if known else None

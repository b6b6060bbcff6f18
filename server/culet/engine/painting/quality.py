"""How well the moving frames of one session are drawn, and what has proven too dear."""

from __future__ import annotations

from dataclasses import replace
from typing import assert_never

from culet.engine.governing.governor import Governor, Plan, read_ladder
from culet.engine.governing.thrift import ByteAllowance, ByteRoom, Thrift, read_byte_ladder, read_video_ladder
from culet.engine.painting.coded import Coded
from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.scene import Scene
from culet.scene.optics import Optics
from culet_protocol.frame import Codec
from culet_protocol.messages import Balance, balance_rate

DEAREST_SECONDS = 2.0
"""Of work on one frame of a pinned quality. A frame that takes longer is governed as if its quality were not pinned: of
a stone that moves something is to be seen."""

DEAR_SECONDS = 0.4
"""Of work on one frame that the governor planned. Such a frame is given up for a cheaper one, if there is one."""

LADDER = read_ladder()

PACE_MEMORY = 0.2
"""Weight of the latest frame in how long moving frames take."""


class Quality:
    """Mutable; of one live picture."""

    def __init__(self) -> None:
        """Nothing is known yet."""
        self.governor = Governor(LADDER)
        self.thrift = Thrift(read_byte_ladder())
        self.video_thrift = Thrift(read_video_ladder())
        self.full_seconds = 0.0
        """s of rendering the first sample of the picture that was last drawn in full, or was given up as too dear."""
        self.gave_up = False
        """The frame begun last was given up for something newer."""
        self.planned_seconds = 0.0
        """s of work on a planned frame, lately."""
        self._too_dear: tuple[Balance, Optics, tuple[int, int]] | None = None
        """The pinned balance, optics and size of which a frame took too long."""

    def balance(self, chosen: Balance, optics: Optics, size: tuple[int, int]) -> Balance:
        """The balance that the viewers chose, but not pinned to what has proven too dear."""
        if self._too_dear == (chosen, optics, size):
            return chosen.model_copy(update={"pinned": False})
        return chosen

    def plan(
        self, scene: Scene, size: tuple[int, int], balance: Balance, allowance: ByteAllowance, *, video: bool = False
    ) -> Plan:
        """For the next moving frame: as good as there is time for, and as large as the link has room for; `video` has
        more pixels in as many bytes."""
        room = self.room(balance, allowance)
        if room is None or balance.pinned:
            return self.governor.plan(scene, size, balance)
        scale = (self.video_thrift if video else self.thrift).scale(size, room)
        reduced = max(16, round(size[0] * scale)), max(16, round(size[1] * scale))
        plan = self.governor.plan(scene, reduced, balance, scale)
        smaller = plan.size == reduced != size
        encoding, crf = self.thrift.encoding(plan.size, room), self.video_thrift.encoding(plan.size, room).quality
        return replace(plan, encoding=replace(encoding, thrifty=encoding.thrifty or smaller, crf=crf, reduced=smaller))

    def room(self, balance: Balance, allowance: ByteAllowance) -> ByteRoom | None:
        """That a link has for a moving frame; None: as much as one likes."""
        return allowance.room(balance_rate(balance.exactness), 1 / max(self.planned_seconds, 1e-3))

    def encoded(self, coded: Coded) -> None:
        """What a moving frame for a link with limits has become. Key frames are few, and so do not count."""
        if coded.codec is Codec.JPEG:
            self.thrift.encoded((coded.width, coded.height), coded.quality, len(coded.data))
        elif coded.depends_on:
            self.video_thrift.encoded((coded.width, coded.height), coded.quality, len(coded.data))

    def is_too_dear(self, work: FrameWork, *, pinned: bool) -> bool:
        """Whether planned work takes so long that another plan is better."""
        if pinned:
            return work.spent > DEAREST_SECONDS
        return work.plan is not None and work.spent > DEAR_SECONDS and self.governor.has_cheaper(work.plan)

    def drew(self, work: FrameWork) -> None:
        """A frame is done."""
        self.gave_up = False
        match work.kind:
            case WorkKind.FULL if work.first_seconds is None:  # it was shown amid its first sample
                self.full_seconds = max(self.full_seconds, work.render_seconds)
            case WorkKind.FULL:
                self.full_seconds = work.render_seconds
            case WorkKind.PLANNED:
                memory = PACE_MEMORY if self.planned_seconds > 0 else 1.0
                self.planned_seconds += memory * (work.spent - self.planned_seconds)
            case WorkKind.REFINED:
                if work.first_seconds is not None:
                    self.full_seconds = work.first_seconds
            case _:
                assert_never(work.kind)

    def give_up_planned(self, work: FrameWork, chosen: Balance, rate: float, *, pinned: bool) -> None:
        """A planned frame was not finished; frames were to come `rate` times a second."""
        assert work.plan is not None  # noqa: S101 - of planned work
        if not self.is_too_dear(work, pinned=pinned):
            self.gave_up = True
        elif pinned:
            self._too_dear = (chosen, work.shown.scene.optics, work.wanted)
        else:
            self.governor.rendered(work.plan, work.expected_seconds, 0.0, rate)

    def give_up_full(self, work: FrameWork) -> None:
        """A frame in full was not finished."""
        self.full_seconds = max(self.full_seconds, work.spent)

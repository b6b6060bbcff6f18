"""One frame in the making: what it is to show, and the pieces of work that make it, none of them long."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cached_property
from time import perf_counter

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.engine.governing.governor import Plan
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.renderer import PIECE_SECONDS, AnyPicture, AnyRenderer
from culet.engine.painting.shares import Account
from culet.engine.session.session import ShownScene
from culet.rendering.emitters.sources import mapped_surfaces
from culet.rendering.film.behind import before_its_colour
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.stage import Stage

REFRESH_SECONDS = 0.35
"""After which a picture at rest that gets better is shown as it is: with a sample that ends soon, developing, encoding
and the way to the viewer that is half a second. A longer sample is shown where it is done."""


AT_ONCE = 2**19
"""Pixels that are developed, once they are there, before anybody else has a turn: some 2 ms, and as long would go by
until it is the frame's turn again, while nothing is rendered."""


class WorkKind(Enum):
    """What a frame is made of."""

    PLANNED = auto()
    """The first sample, as the governor or a pinned balance has it."""
    FULL = auto()
    """The first sample, as the scene has it."""
    REFINED = auto()
    """More samples."""


class Unprepared(Exception):  # noqa: N818 - nothing went wrong
    """A picture would have to wait for a compiler, or for a tree of triangles."""


@dataclass(eq=False)
class FrameWork:
    """Belongs to the painter; its pieces run in the render thread."""

    kind: WorkKind
    shown: ShownScene
    wanted: tuple[int, int]
    """Pixels that were asked for when it was begun."""
    account: Account
    begun_at: float
    """s, steady clock."""
    plan: Plan | None = None
    picture: AnyPicture | None = None
    """Made by the first piece, unless it is refined."""
    aim: Target | None = None
    """To which what is refined is refined at last."""
    now: Callable[[], float] = perf_counter
    """s, the clock of `begun_at`."""
    over: NDArray[np.uint8] | None = None
    """(height, width, 3): what was seen last of the same; None: nothing that it could be shown over amid a sample."""
    seen_at: float | None = None
    """s, the same clock: when that was drawn, if not when this was begun."""
    seen_samples: int = 0
    """Of each pixel of what was seen last: a picture that was begun anew is not shown before it has as many."""
    piece_seconds: float = PIECE_SECONDS
    """That a launch is meant to take."""
    final: bool = False
    """Nothing better will come."""
    slow: bool = False
    """The stone moves slower than in real time."""
    simulate_seconds: float = 0.0
    """Before it was begun."""
    render_seconds: float = 0.0
    """Of the samples that the picture has already."""
    spent: float = 0.0
    """s that the painter was at it so far, from the simulation on."""
    part: float = 0.0
    """Of the samples that is done."""
    frame: LiveFrame | None = None
    """When all is done."""
    first_seconds: float | None = None
    """s of rendering the picture's first sample, if it was this that made it whole."""
    pieces: Generator[object, None, None] = field(init=False)

    @property
    def stage(self) -> Stage:
        """As it is drawn: what is shown, by the plan."""
        scene = self.shown.scene if self.plan is None else self.plan.scene
        return self.shown.stage.showing(before_its_colour(scene))

    @property
    def samples(self) -> int:
        """That the picture has already."""
        return 0 if self.picture is None else self.picture.samples

    @cached_property
    def has_own_light(self) -> bool:
        """Whether it holds a light map that it makes for itself, as one of stones that move does."""
        return self.kind is WorkKind.PLANNED and bool(mapped_surfaces(self.stage))

    def start(self, renderer: AnyRenderer) -> None:
        """To be called once, before any piece."""
        self.pieces = self._made(renderer)

    @property
    def hold_seconds(self) -> float:
        """For which it may hold the render thread, if its pieces can be as short."""
        return min(self.piece_seconds, PIECE_SECONDS)

    @property
    def expected_seconds(self) -> float:
        """That all of it would take, as far as the part that is done tells."""
        return self.spent / self.part if self.part > 0 else self.spent

    def give_up(self) -> None:
        """It is not gone on with. What it holds is given back now, and not when Python next collects circles: a frame
        with a light map holds some 30 MiB."""
        self.pieces.close()
        if self.picture is not None:
            self.picture.give_up()

    def _made(self, renderer: AnyRenderer) -> Generator[object, None, None]:
        width, height = self.wanted if self.plan is None else self.plan.size
        stage = self.stage
        if not renderer.is_ready(stage, self.samples):
            raise Unprepared
        if self.picture is None:
            effort = LightEffort.RESTING if self.plan is None else LightEffort.MOVING
            self.picture = renderer.picture(stage, width, height, effort=effort)
        picture, sampled = self.picture, self.picture.sample_seconds > 0
        small = width * height <= AT_ONCE
        for part in self._samples(picture, renderer):
            self.part = part
            if part < 1 or not small:
                yield part
        self.render_seconds += picture.seconds + picture.light_seconds
        if not sampled and picture.sample_seconds > 0:
            self.first_seconds = picture.sample_seconds
        started, overlaid = perf_counter(), None
        whole = (width, height) == self.wanted  # a smaller one is softened enough by being enlarged
        soft = picture.samples_seen == 1 and whole and not self.final
        if picture.under_way and self.over is not None:
            for overlaid in picture.overlaid(_resized(self.over, width, height)):
                yield overlaid
        else:
            for piece in picture.develop_in_pieces(soft=soft):
                if not small:
                    yield piece
        develop_seconds = perf_counter() - started
        spent = self.simulate_seconds, self.render_seconds
        self.frame = LiveFrame.developed(
            picture, self.shown, self.plan, spent, develop_seconds, aim=self.aim, final=self.final, slow=self.slow,
            soft=soft, overlaid=overlaid,
        )  # fmt: skip

    def _samples(self, picture: AnyPicture, renderer: AnyRenderer) -> Iterator[float]:
        """The first one; or as many more as there are, but no more than REFRESH_SECONDS allow, nor than are needed.

        When frames are sent depends on the time, but which of them is final does not.
        """
        if self.aim is None and self.over is None:
            yield from picture.refine_in_pieces(1, self.piece_seconds)
        elif self.aim is None:
            yield from picture.refine_until(Target(1), self.piece_seconds, pause=lambda: True, due=self._due)
        else:
            most = 2 * max(1, picture.samples_seen, self.seen_samples)

            def enough() -> bool:
                better = picture.samples >= self.seen_samples  # else it is a step back, and has had its program before
                return picture.samples >= most or (better and self._waits(picture, renderer))

            yield from picture.refine_until(self.aim, self.piece_seconds, pause=enough, due=self._due)
            self.final = picture.reached(self.aim)

    def _waits(self, picture: AnyPicture, renderer: AnyRenderer) -> bool:
        """Whether the next sample would wait for a compiler: the second may need another program than the first."""
        return picture.samples == 1 and not renderer.is_ready(self.stage, 1)

    def _due(self, seconds: float) -> bool:
        """Whether what is made is to be seen when so many seconds have gone by, and can be: amid a sample it is shown
        over something."""
        if self.over is None or (self.picture is not None and self.picture.samples < self.seen_samples):
            return False
        since = self.begun_at if self.seen_at is None else self.seen_at
        return self.now() + seconds - since > REFRESH_SECONDS


def has_shape(rgb: NDArray[np.uint8], size: tuple[int, int]) -> bool:
    """Whether an image has the shape of that size, but for the rounding of its sides: else it is not over its pixels
    when it is made as large."""
    (height, width, _), (other_width, other_height) = rgb.shape, size
    return bool(abs(width * other_height - height * other_width) <= max(size))


def _resized(rgb: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    if rgb.shape == (height, width, 3):
        return rgb
    picture = PIL.Image.fromarray(np.ascontiguousarray(rgb))
    return np.asarray(picture.resize((width, height), PIL.Image.Resampling.BILINEAR))


def proceed(pieces: Iterator[object], clock: Callable[[], float], seconds: float = PIECE_SECONDS) -> bool:
    """Run a piece, and more of them while they are short beside so many seconds; whether there are more to come.

    `clock` tells seconds.
    """
    started = clock()
    return any(clock() - started > seconds / 2 for _ in pieces)

"""What is drawn in full and what the governor reduces, however slow the frames: on a simulated clock, no device."""

from __future__ import annotations

import asyncio
import gc
import math
import threading
import weakref
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any, Literal
from weakref import ref

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.engine.governing.governor import Governor, Plan, read_ladder
from culet.engine.governing.thrift import ByteAllowance
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet.engine.painting.frame_work import FrameWork, WorkKind, has_shape
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.live_picture import SETTLE_SECONDS, LivePicture
from culet.engine.painting.painter import Painter
from culet.engine.painting.quality import Quality
from culet.engine.painting.shares import Account
from culet.engine.painting.still import Still, StillQueue
from culet.engine.session.session import Session
from culet.engine.session.stepper import Stepper, Stepping
from culet.engine.session.viewpoint import orbit
from culet.errors import TooLargeError
from culet.optics.panoramas import Panorama
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import SOON
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import Balance
from shared import patience

WANTED = 1280, 800
REST = Target(16, 0.004, least=16)
SLOW = 0.9
"""s of a full frame: the default scene with 16 bands and polarisation takes as long on two cores."""
LADDER_SHARE = 0.1
"""Of that, what the first rung of the ladder takes, which follows three indices without polarisation."""
POINTER_RATE = 60
"""Events per second of a drag."""
QUICKEST = min(rung.cost for rung in read_ladder() if rung.scale >= 0.5)
"""Cost of the quickest rung at the least size, over the first's."""
PATIENCE = patience.PATIENCE
IDLE = 0.005
"""s that pass when there is nothing to draw."""


@dataclass
class Drawn:
    """The first sample of one picture."""

    begun: float
    size: tuple[int, int]
    full: bool
    ended: float = math.nan
    """NaN if it was given up."""


class World:
    """A clock, what happens when, and a device whose pictures take their time on that clock."""

    def __init__(self, full_seconds: float, *, with_stone: bool = False, now: float = 100.0) -> None:
        self.now = now
        self.full_seconds = full_seconds
        self.drawn: list[Drawn] = []
        self.samples = 0
        """Of the picture that got some last."""
        self.overlaid = 0
        """Times that a picture was shown amid a sample."""
        self.most_behind = 0
        """Whole samples that a tile lacked of a picture that was shown amid one, at most."""
        self.needed = 0
        """Samples that meet any error."""
        self.softened: list[tuple[int, tuple[int, int]]] = []
        """Samples and size of each picture that was filtered."""
        self.pictures = weakref.WeakSet[TimedPicture]()
        """That somebody holds."""
        scene = Scene.read({"optics": {"bands": 16, "polarised": True}} | ({} if with_stone else {"stones": []}))
        self.session = Session("0" * 32, Stage.of(scene))
        self.rest = REST
        """To which pictures are refined."""
        self.sent: list[tuple[float, Frame]] = []
        """When, and what."""
        self.compiled = threading.Event()
        """Set when more than the first sample of a picture can be made, as it is unless a test says otherwise."""
        self.compiled.set()
        self.live: LivePicture | None = None
        """While it is painted."""
        self.events: list[float] = []
        """When the camera turns a little."""

    def spend(self, seconds: float) -> None:
        """Let time go by, with what happens in it."""
        self.now += seconds
        while self.events and self.events[0] <= self.now:
            self.events.pop(0)
            scene = self.session.scene
            self.session.change(
                self.session.stage.showing(scene.model_copy(update={"camera": orbit(scene.camera, 0.01, 0)}))
            )

    def picture(
        self, stage: Stage, width: int, height: int, *, effort: LightEffort = LightEffort.PATIENT
    ) -> TimedPicture:
        picture = TimedPicture(self, stage.scene, (width, height))
        self.pictures.add(picture)
        return picture

    cut_out = picture

    def alive(self) -> int:
        """Pictures that somebody holds."""
        gc.collect()
        return len(self.pictures)

    def is_ready(self, stage: Stage, samples: int = 0) -> bool:
        return samples == 0 or self.compiled.is_set()

    def make_ready(self, stage: Stage, samples: int = 0) -> None:
        self.compiled.wait(PATIENCE)

    def describe(self) -> dict[str, str]:
        return {}

    def forget(self, panorama: Panorama) -> None:
        pass

    def held(self) -> dict[str, int]:
        return {}

    def release(self) -> None:
        pass

    def trim(self) -> None:
        pass

    def send(self, message: bytes) -> None:
        self.sent.append((self.now, Frame.unpack(message)))

    def first_sent(self) -> list[tuple[float, Frame]]:
        """Without what is sent again, nor what the governor planned, which is not polarised."""
        frames: dict[int, tuple[float, Frame]] = {}
        for time, frame in self.sent:
            if Flags.POLARISED in frame.flags:
                frames.setdefault(frame.sequence, (time, frame))
        return list(frames.values())

    def turn(self, *, since: float, seconds: float) -> None:
        """Drag, from so long after now on, for so long."""
        self.events += [self.now + since + number / POINTER_RATE for number in range(int(seconds * POINTER_RATE))]


class TimedPicture:
    """Nothing to see."""

    def __init__(self, world: World, scene: Scene, size: tuple[int, int]) -> None:
        self.scene, self.samples, self.seconds, self.light_seconds = scene, 0, 0.0, 0.0
        self.sample_seconds = self._left = 0.0
        self._part_left = 0.0
        self._world, self._size = world, size
        self._tiles = np.zeros(16, int)
        """Samples of each, as shown last."""
        self._sampling: Iterator[float] | None = None
        self.clock = world

    @property
    def samples_seen(self) -> int:
        return max(self.samples, int(self.under_way))

    @property
    def under_way(self) -> bool:
        return self._sampling is not None

    def refine(self, samples: int = 1) -> None:
        for _ in self.refine_in_pieces(samples, math.inf):
            pass

    def refine_in_pieces(self, samples: int, seconds: float) -> Iterator[float]:
        first, full = self.samples == 0, self.scene.optics.polarised
        part = self._size[0] * self._size[1] / (WANTED[0] * WANTED[1])
        in_all = samples * part * self._world.full_seconds * (1 if full else LADDER_SHARE * self._rung_cost())
        pieces = max(1, math.ceil(in_all / seconds))
        drawn = Drawn(self.clock.now, self._size, full)
        if first:
            self._world.drawn.append(drawn)
        for piece in range(pieces):
            self.clock.spend(in_all / pieces)
            self._part_left = 1 - (piece + 1) / pieces
            self._left = in_all * self._part_left
            yield (piece + 1) / pieces
        self.samples += samples
        self._world.samples = self.samples
        self.sample_seconds = in_all / samples
        self.seconds = in_all
        drawn.ended = self.clock.now

    def refine_until(
        self,
        target: Target,
        seconds: float,
        *,
        pause: Callable[[], bool] = lambda: False,
        due: Callable[[float], bool] = lambda _: False,
    ) -> Iterator[float]:
        spent = 0.0
        while not self.reached(target):
            self._sampling = self._sampling or self.refine_in_pieces(1, seconds)
            for part in self._sampling:
                yield part
                if self._left > SOON and due(0):
                    return
            self._sampling = None
            spent += self.seconds
            if pause() or due(max(0.0, self.sample_seconds - SOON)):
                break
        self.seconds = spent

    def overlaid(self, over: NDArray[np.uint8]) -> Iterator[NDArray[np.uint8]]:
        self._tiles[: int(len(self._tiles) * (1 - self._part_left))] = self.samples + 1
        self._world.overlaid += 1
        self._world.most_behind = max(self._world.most_behind, self.samples - int(self._tiles.min()))
        yield over

    def reached(self, target: Target) -> bool:
        return self.samples >= min(max(target.least, self._world.needed), target.samples)

    def meets(self, target: Target) -> bool:
        return self.samples >= self._world.needed

    def shown_error(self) -> float:
        return math.nan

    def give_up(self) -> None:
        self._sampling = None

    def develop_in_pieces(self, *, soft: bool = False) -> Iterator[None]:
        return iter(())

    def softened(self) -> NDArray[np.uint8]:
        self._world.softened.append((self.samples, self._size))
        return self.rgb()

    def rgb(self) -> NDArray[np.uint8]:
        self._tiles[:] = self.samples
        width, height = self._size
        return np.zeros((max(1, round(16 * height / width)), 16, 3), np.uint8)

    def cut(self) -> float:
        return 0.0

    def error_estimate(self) -> float:
        return math.nan

    def light_error(self) -> float:
        return math.nan

    def light_bound(self) -> float:
        return math.nan

    def shows_shadows_only(self) -> bool:
        return False

    def _rung_cost(self) -> float:
        optics = self.scene.optics
        return next(
            rung.pixel_cost
            for rung in read_ladder()
            if rung.cutoff == optics.cutoff and rung.max_bounces == optics.max_bounces
        )


class AtOnce:
    """Takes the steps that are due when a frame is begun: they take no time of a world."""

    def __init__(self, world: World) -> None:
        self._world = world

    def keep_going(self, steps: Stepping) -> None:
        steps.run(self._world.now)

    def stop(self) -> None:
        """There is nothing to stop."""


def painter_of(world: World, thread: ThreadPoolExecutor) -> Painter:
    """On the world's clock; a problem fails the test."""
    return Painter(
        world, thread, StillQueue(1, 2**25),
        send=world.send, tell_problem=_fail, encode_still=lambda *_: b"",
        still_seconds=math.inf, rest=world.rest, stepper=AtOnce(world), clock=lambda: world.now,
    )  # fmt: skip


Play = Callable[..., asyncio.Future[None]]


@pytest.fixture
async def play() -> AsyncIterator[Play]:
    """Paint a world for so long on its clock."""
    with ThreadPoolExecutor(1) as thread:
        painters: dict[int, Painter] = {}

        async def paint(world: World, seconds: float, rate: float = 60) -> None:
            if id(world) not in painters:
                painter = painter_of(world, thread)
                world.live = LivePicture(world.session, watched=True, rate=rate, size=WANTED)
                painter.pictures["a"] = world.live
                painters[id(world)] = painter
            end = world.now + seconds
            while world.now < end:
                worked = await painters[id(world)].work()
                await done(painters[id(world)].pictures["a"])
                if not worked:
                    world.spend(IDLE)

        yield lambda world, seconds, **how: asyncio.ensure_future(paint(world, seconds, **how))


async def done(live: LivePicture) -> None:
    """Encoding takes no time of these worlds."""
    if live.outgoing.latest is not None:
        await live.outgoing.latest
        await asyncio.sleep(0)  # until who waits for its end has heard of it


def _fail(_session: str, error: Exception) -> None:
    raise error


@pytest.mark.parametrize(
    ("full_seconds", "least_rate"),
    # measured 29.9, 30, 29.9 and 7.75 frames/s, the last of the 8.5 that the quickest setting allows
    [(0.1, 29), (0.3, 29), (SLOW, 29), (10 * SLOW, 0.9 / (LADDER_SHARE * 10 * SLOW * QUICKEST))],
)
async def test_a_drag_is_governed_however_long_a_frame_takes(
    play: Play, full_seconds: float, least_rate: float
) -> None:
    """In the last case the best governed frame takes 0.9 s, and the quickest 0.12 s, by the ladder's costs."""
    world = World(full_seconds)
    await play(world, 30 * full_seconds)
    world.drawn.clear()
    world.turn(since=0, seconds=8)
    await play(world, 8)
    dragged = [drawn for drawn in world.drawn if not math.isnan(drawn.ended)]
    assert not any(drawn.full for drawn in dragged[1:])
    assert len(dragged) / 8 > least_rate


async def test_the_first_frame_of_a_drag_is_as_quick_as_the_picture_at_rest_lets_expect(play: Play) -> None:
    """In the dearest setting it would take 1.2 frames' time."""
    world = World(0.4)
    await play(world, 20)
    world.drawn.clear()
    world.turn(since=0, seconds=1)
    await play(world, 1)
    first = world.drawn[0]
    assert not first.full
    assert first.ended - first.begun < 1 / 30


async def test_what_moves_does_not_wait_for_the_program_that_refines(play: Play) -> None:
    world = World(0.1)
    world.compiled.clear()
    await play(world, 1)
    assert world.samples == 1
    world.drawn.clear()
    world.turn(since=0, seconds=1)
    await play(world, 2)
    assert sum(not drawn.full for drawn in world.drawn) > 29
    assert (world.drawn[-1].full, world.samples) == (True, 1)
    world.compiled.set()
    async with asyncio.timeout(PATIENCE):
        while world.samples == 1:
            await play(world, 0.1)
            await asyncio.sleep(0.001)  # the thread that waits for the compiler is a real one


async def test_nor_does_a_picture_that_was_shown_amid_its_first_sample(play: Play) -> None:
    """The second sample would be there in time, were it not for its program."""
    world = World(0.3)
    await play(world, 10)
    world.compiled.clear()
    world.turn(since=0, seconds=1 / POINTER_RATE)
    before = world.overlaid
    await play(world, 3)
    assert world.overlaid > before
    assert world.samples == 1, "the second one's program is not there"
    world.compiled.set()
    async with asyncio.timeout(PATIENCE):
        while world.samples == 1:
            await play(world, 0.1)
            await asyncio.sleep(0.001)  # as above


async def test_a_slow_picture_in_another_size_is_seen_over_the_last_one_if_that_has_its_shape(play: Play) -> None:
    world = World(4 * SLOW)
    world.rest = Target(samples=1)
    await play(world, 10)
    assert Flags.FINAL in world.sent[-1][1].flags
    assert world.live is not None
    for size, is_seen in [((1440, 900), True), ((1000, 1000), False)]:
        before = world.overlaid
        world.live.size = size
        await play(world, 2)
        assert (world.overlaid > before) == is_seen
        await play(world, 6)
        assert Flags.FINAL in world.sent[-1][1].flags


@pytest.mark.parametrize(
    ("size", "fits"),
    [((960, 540), True), ((321, 181), True), ((319, 180), True), ((540, 960), False), ((960, 600), False)],
)
def test_shapes_are_the_same_but_for_rounding(size: tuple[int, int], *, fits: bool) -> None:
    width, height = size
    assert has_shape(np.zeros((height, width, 3), np.uint8), (1280, 720)) == fits


async def test_a_frame_that_is_given_up_gives_its_memory_back_at_once(play: Play) -> None:
    """And not when Python collects circles: ten sessions of twelve stones held thirty light maps of such frames."""
    world = World(SLOW)
    await play(world, 0.2)
    live = world.live
    assert live is not None
    gc.collect()
    gc.disable()
    try:
        work = live.work
        assert work is not None
        held = ref(work)
        picture = ref(work.picture)
        del work
        live.give_up(world.now)
        assert (held(), picture()) == (None, None)
    finally:
        gc.enable()


async def test_the_next_frame_is_begun_while_the_last_one_is_encoded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is encoded only when the one after it is being drawn: none would ever leave if that waited for it."""
    drawing = [threading.Event() for _ in range(8)]
    encoded, world = list[int](), World(0.1)

    def encode(frame: LiveFrame, _: ByteAllowance) -> Coded:
        number = len(encoded)
        encoded.append(number)
        assert number + 1 >= len(drawing) or drawing[number + 1].wait(PATIENCE)
        return Coded.of_jpeg(jpeg.encode_within(frame.rgb, 50, math.inf), thrifty=False)

    def picture(stage: Stage, width: int, height: int, *, effort: LightEffort = LightEffort.PATIENT) -> TimedPicture:
        for begun in drawing[: len(world.drawn) + 1]:
            begun.set()
        return TimedPicture(world, stage.scene, (width, height))

    monkeypatch.setattr(LiveFrame, "encoded", encode)
    monkeypatch.setattr(world, "picture", picture)
    with ThreadPoolExecutor(1) as thread:
        painter = painter_of(world, thread)
        live = painter.pictures["a"] = LivePicture(world.session, watched=True, rate=60, size=WANTED)
        world.turn(since=0, seconds=60)
        async with asyncio.timeout(PATIENCE):
            while len(world.sent) < len(drawing) - 1:
                if not await painter.work():
                    world.spend(IDLE)
                    await asyncio.sleep(0)
        for begun in drawing:
            begun.set()
        await done(live)
    numbers = [frame.sequence for _, frame in world.sent]
    assert numbers == sorted(numbers), "and they leave in order"
    assert live.outgoing.unsent == 0


@pytest.mark.parametrize(("seen_samples", "samples"), [(0, 1), (8, 8)])
def test_a_picture_that_is_begun_anew_is_not_seen_with_less_than_before(seen_samples: int, samples: int) -> None:
    """Not even where the second sample waits for something, as a sky's sum that was forgotten meanwhile."""
    world = World(0.01)
    world.compiled.clear()
    work = FrameWork(
        WorkKind.REFINED, world.session.shown, WANTED, Account(None), world.now, aim=REST, now=lambda: world.now,
        seen_samples=seen_samples,
    )  # fmt: skip
    work.start(world)
    for _ in work.pieces:
        pass
    assert work.frame is not None
    assert work.frame.samples >= samples
    assert (work.frame.samples == 1) == (samples == 1)


def test_what_a_first_moving_frame_took_is_all_that_is_known_of_the_next() -> None:
    world = World(0.1)
    live, work = (
        LivePicture(world.session),
        FrameWork(WorkKind.PLANNED, world.session.shown, WANTED, Account(None), 0.0),
    )
    work.spent = 0.1
    live.quality.drew(work)
    assert live.quality.planned_seconds == pytest.approx(0.1)
    work.spent = 0.2
    live.quality.drew(work)
    assert 0.1 < live.quality.planned_seconds < 0.15, "of others the mean"


async def test_a_closed_sessions_picture_is_gone_at_once_also_amid_a_sample() -> None:
    """It and its sample hold each other: Python would find out only when it collects circles."""
    world = World(2.0)
    with ThreadPoolExecutor(1) as thread:
        painter = painter_of(world, thread)
        live = painter.pictures["a"] = LivePicture(world.session, watched=True, rate=60, size=WANTED)
        async with asyncio.timeout(PATIENCE):
            while live.picture is None or not live.picture.under_way:
                if not await painter.work():
                    world.spend(IDLE)
                await done(live)
        assert world.alive() == 1
        gc.disable()
        try:
            painter.forget("a")
            await painter.work()
            assert len(world.pictures) == 0
            assert not painter.pictures
        finally:
            gc.enable()


@pytest.mark.parametrize(("size", "turns"), [((960, 540), 0), (WANTED, 2)])
def test_a_frame_that_is_small_is_developed_without_a_turn_of_others(size: tuple[int, int], turns: int) -> None:
    """From its last sample on; a large one lets others have theirs."""
    world = World(0.1)
    developed: list[bool] = []

    class InPieces(TimedPicture):
        def develop_in_pieces(self, *, soft: bool = False) -> Iterator[None]:
            developed.append(soft)
            yield

    world.picture = lambda stage, width, height, *, effort=LightEffort.PATIENT: InPieces(  # type: ignore[method-assign]
        world, stage.scene, (width, height)
    )
    work = FrameWork(WorkKind.FULL, world.session.shown, size, Account(None), world.now, now=lambda: world.now)
    work.piece_seconds = 1.0
    work.start(world)
    assert sum(1 for _ in work.pieces) == turns
    assert developed == [True]
    assert work.frame is not None


async def test_one_sample_of_each_pixel_asked_for_is_softened_and_nothing_else_is(play: Play) -> None:
    world = World(SLOW)
    await play(world, 30 * SLOW)
    world.turn(since=0, seconds=1)
    await play(world, 3)
    assert any(drawn.size != WANTED for drawn in world.drawn), "which are to be enlarged"
    assert {*world.softened} == {(1, WANTED)}
    once = World(0.1)
    once.rest = Target(samples=1)
    await play(once, 1)
    assert [Flags.FINAL in frame.flags for _, frame in once.first_sent()] == [False, True]
    assert once.softened == [(1, WANTED)], "and not the last one"


async def test_after_a_drag_the_picture_is_drawn_in_full(play: Play) -> None:
    world = World(SLOW)
    await play(world, 30 * SLOW)
    world.turn(since=0, seconds=1)
    await play(world, 4)
    last = world.drawn[-1]
    assert (last.full, last.size) == (True, WANTED)
    assert SETTLE_SECONDS <= last.begun - world.drawn[-2].ended < SETTLE_SECONDS + 0.05, "measured 0.205 s"


async def test_an_edit_of_a_slow_scene_is_seen_at_once(play: Play) -> None:
    world = World(SLOW)
    await play(world, 30 * SLOW)
    world.drawn.clear()
    world.turn(since=0, seconds=1 / POINTER_RATE)
    edited = world.now
    await play(world, 3)
    assert [drawn.full for drawn in world.drawn] == [False, True]
    assert world.drawn[0].ended - edited < 0.15, "measured 0.095 s"


async def test_an_edit_of_a_quick_scene_is_drawn_in_full_alone(play: Play) -> None:
    world = World(0.1)
    await play(world, 3)
    world.drawn.clear()
    world.turn(since=0, seconds=1 / POINTER_RATE)
    await play(world, 1)
    assert [drawn.full for drawn in world.drawn] == [True]


async def test_a_full_frame_is_given_up_for_what_is_newer(play: Play) -> None:
    world = World(SLOW)
    await play(world, 30 * SLOW)
    world.drawn.clear()
    world.turn(since=0, seconds=1 / POINTER_RATE)
    world.turn(since=0.5, seconds=1 / POINTER_RATE)  # in the middle of the full frame that follows the reduced one
    edited = world.now + 0.5
    await play(world, 4)
    assert [(drawn.full, math.isnan(drawn.ended)) for drawn in world.drawn] == [
        (False, False), (True, True), (False, False), (True, False),
    ]  # fmt: skip
    assert world.drawn[2].ended - edited < 0.15, "measured 0.050 s: a band, and a reduced frame"


@pytest.mark.parametrize(
    ("full_seconds", "rate", "now"),
    [
        pytest.param(0.1, 60, 100.0, id="quick"),
        pytest.param(SLOW, 60, 100.0, id="slow-scene"),
        pytest.param(0.1, 5, 100.0, id="slow-viewer"),
        pytest.param(0.1, 60, 2200.0, id="clock-that-rounds-down"),  # by the double that is 2200 + 0.2
    ],
)
async def test_a_stone_that_fell_asleep_is_drawn_in_full_once_and_refined(
    play: Play, full_seconds: float, rate: float, now: float
) -> None:
    """When time went on for a stone that slept, each of its frames showed something new, and was governed in turn."""
    world = World(full_seconds, with_stone=True, now=now)
    await play(world, 30 * full_seconds, rate=rate)
    world.session.set_falling(True)
    await play(world, 40 * full_seconds + 30, rate=rate)
    assert world.session.motion.asleep
    assert [(drawn.full, drawn.size == WANTED) for drawn in world.drawn[-1:]] == [(True, True)]
    assert not world.drawn[-2].full
    assert world.samples == REST.samples
    drawn = len(world.drawn)
    await play(world, 3, rate=rate)
    assert len(world.drawn) == drawn


@pytest.mark.parametrize("changed", [False, True])
def test_of_what_nobody_watches_the_scene_is_held_only_while_the_session_shows_it(*, changed: bool) -> None:
    """Or its sky would stay in memory."""
    world = World(0.01)
    live = LivePicture(world.session, size=WANTED)
    live.painted = shown = world.session.shown
    if changed:
        world.session.change(Stage.of(Scene()))
    live.abandon(world.now)
    assert live.painted is (None if changed else shown)


def test_a_picture_that_is_known_to_take_long_stays_so_when_it_is_given_up_soon() -> None:
    """Or the next one would be drawn in full as well, and what somebody does would wait for it."""
    quality, world = Quality(), World(3.0)
    quality.full_seconds = 3.0
    for spent, known in ((0.1, 3.0), (5.0, 5.0)):
        work = FrameWork(WorkKind.FULL, world.session.shown, WANTED, Account(world), begun_at=world.now, spent=spent)
        quality.give_up_full(work)
        assert quality.full_seconds == known


async def test_a_window_that_takes_another_shape_has_its_picture_however_long_that_takes(play: Play) -> None:
    """Nothing of what was seen can be shown over it, so that it is not seen before it is whole."""
    world = World(4.0)
    await play(world, 10)
    assert world.live is not None
    world.live.size = upright = WANTED[1], WANTED[0]
    await play(world, 10)
    (drawn,) = [each for each in world.drawn if each.size == upright]
    assert drawn.full
    assert drawn.ended - drawn.begun == pytest.approx(4)


@pytest.mark.parametrize("full_seconds", [0.01, 0.1, 0.9, 4.0])
@pytest.mark.parametrize("needed", [3, 16, 90, 1000])
async def test_a_picture_at_rest_is_refined_until_it_is_good_enough(
    play: Play, full_seconds: float, needed: int
) -> None:
    """A new picture at least twice a second, however long a sample takes, and never a step back; how many samples there
    are at last does not depend on the time."""
    world = World(full_seconds)
    world.rest, world.needed = Target(100, 0.004, least=16), needed
    while not (world.sent and Flags.FINAL in world.sent[-1][1].flags):
        await play(world, 1)
    shown = world.first_sent()
    times, samples = [time for time, _ in shown], [frame.samples for _, frame in shown]
    assert samples[-1] == min(max(needed, 16), 100)
    assert [Flags.FINAL in frame.flags for _, frame in shown] == [False] * (len(samples) - 1) + [True]
    amid = full_seconds > 0.5
    assert all(before <= after <= 2 * before for before, after in pairwise(samples))
    assert world.most_behind == 0, "whoever sees it amid a sample has seen the one before"
    assert amid == (world.overlaid > 0) == any(before == after for before, after in pairwise(samples))
    assert max(after - before for before, after in pairwise(times)) < 0.5, "measured 0.43"
    assert world.alive() == 0, "it is final"
    await play(world, 10)
    assert (world.samples, world.first_sent()[-1]) == (samples[-1], shown[-1])


@pytest.mark.parametrize(
    ("exactness", "frame_seconds"),
    [pytest.param(0, 0.02, id="sixty-a-second"), pytest.param(1, 0.1, id="more-than-there-is-time-for")],
)
async def test_a_resting_picture_leaves_a_moving_one_nearly_all_the_time(
    exactness: float, frame_seconds: float
) -> None:
    """One is refined for ever. Measured 600 of 600 and 96 of 101 frames."""
    used = {}
    for at_rest in (False, True):
        world = Crowd(0.1, frame_seconds / LADDER_SHARE)
        world.needed = 10**6
        moving = Session("1" * 32, Stage.of(Scene.read(WAKEFUL)))
        moving.balance = Balance(exactness=exactness, pinned=True)
        with ThreadPoolExecutor(1) as thread:
            painter = Painter(
                world, thread, StillQueue(1, 2**25),
                send=lambda _: None, tell_problem=_fail, encode_still=lambda *_: b"",
                still_seconds=math.inf, rest=Target(10**4, 1e-6, least=16), stepper=AtOnce(world),
                clock=partial(getattr, world, "now"),
            )  # fmt: skip
            for session in (moving, world.session) if at_rest else (moving,):
                painter.pictures[session.name] = LivePicture(session, watched=True, rate=60, size=WANTED)
            while world.samples < 16 and at_rest:
                await painter.work()
                await done(painter.pictures[world.session.name])
            moving.set_falling(True)
            begun, before = world.now, len(world.other.drawn)
            while world.now < begun + 10:
                worked = await painter.work()
                for live in painter.pictures.values():
                    await done(live)
                if not worked:
                    world.spend(IDLE)
        used[at_rest] = len(world.other.drawn) - before

    assert used[True] > 0.9 * used[False]
    assert world.samples > 16, "it goes on meanwhile"


async def test_a_still_is_as_good_as_its_time_allows_if_an_error_was_asked_for_and_refused_otherwise() -> None:
    world, queue = World(0.1), StillQueue(2, 2**25)
    world.needed = 10**6
    with ThreadPoolExecutor(1) as thread:
        painter = Painter(
            world, thread, queue, send=lambda _: None, tell_problem=_fail, encode_still=lambda *_: b"picture",
            still_seconds=1, rest=REST, stepper=AtOnce(world), clock=lambda: world.now,
        )  # fmt: skip
        for error in (1e-6, None):
            still = Still(world.session.stage, *WANTED, Target(1000, error), "png")
            queue.put(still)
            while not still.done.done():
                if not await painter.work():
                    await asyncio.sleep(0)
            assert still.picture is not None
            assert 9 <= still.picture.samples <= 11
            if error is not None:
                assert still.done.result() == b"picture"
            else:
                assert isinstance(still.done.exception(), TooLargeError)


async def test_only_a_picture_that_can_be_refined_is_held(play: Play) -> None:
    world = World(SLOW)
    await play(world, 30 * SLOW)
    assert world.samples >= REST.samples
    assert world.alive() == 0, "it is final"
    world.turn(since=0, seconds=1 / POINTER_RATE)
    while not (world.drawn and not world.drawn[-1].full and not math.isnan(world.drawn[-1].ended)):
        await play(world, IDLE)
    assert world.alive() == 0, "it is a reduced one, which is drawn anew"

    def drawn_in_full() -> bool:
        return world.drawn[-1].full and world.samples == 1

    while not drawn_in_full():
        await play(world, IDLE)
    assert world.alive() == 1


async def test_waiting_for_a_session_is_not_counted_as_work_for_a_frame(
    play: Play, monkeypatch: pytest.MonkeyPatch
) -> None:
    world, overheads = World(SLOW), []

    class SlowLock(asyncio.Lock):
        async def acquire(self) -> Literal[True]:
            world.spend(1.5)
            return await super().acquire()

    def rendered(
        _: Governor, _plan: Plan, _seconds: float, overhead: float, _rate: float, _share: float, **_how: bool
    ) -> None:
        overheads.append(overhead)

    monkeypatch.setattr(Governor, "rendered", rendered)
    await play(world, 30 * SLOW)
    world.session.lock = SlowLock()
    world.turn(since=0, seconds=1)
    await play(world, 4)
    assert overheads == pytest.approx([0] * len(overheads), abs=1e-9)
    assert overheads


async def test_a_pinned_quality_that_is_far_too_dear_gives_way_while_the_stone_moves(play: Play) -> None:
    """In full each frame takes a minute and a half: what is seen instead is what the governor makes of it."""
    world = World(100 * SLOW, with_stone=True)
    world.session.balance = Balance(exactness=1, pinned=True)
    world.session.set_falling(True)
    await play(world, 6)
    done = [drawn for drawn in world.drawn if not math.isnan(drawn.ended)]
    assert world.drawn[0].full
    assert math.isnan(world.drawn[0].ended), "given up"
    assert len(done) >= 2
    assert not any(drawn.full for drawn in done)


async def test_of_a_picture_that_takes_long_in_full_a_reduced_one_is_seen_first(play: Play) -> None:
    world = World(10 * SLOW)
    await play(world, 4)
    first = next(drawn for drawn in world.drawn if not math.isnan(drawn.ended))
    assert not first.full
    assert first.ended - 100 < 3, "measured 1.8 s"
    await play(world, 30)
    assert any(drawn.full and not math.isnan(drawn.ended) for drawn in world.drawn)


async def test_of_dear_frames_at_most_every_other_is_given_up_for_something_newer(play: Play) -> None:
    """A drag of a scene whose cheapest frame takes a second: it must be seen to move."""
    world = World(SLOW / (LADDER_SHARE * QUICKEST))
    await play(world, 60)
    world.drawn.clear()
    world.turn(since=0, seconds=20)
    await play(world, 20)
    given_up = [math.isnan(drawn.ended) for drawn in world.drawn[:-1]]
    assert given_up.count(False) >= 8
    assert not any(before and after for before, after in pairwise(given_up[4:]))


async def test_no_frame_waits_for_a_step() -> None:
    """A step that does not end: frames are drawn all the same, and show the stone where it was."""
    world = World(0.05, with_stone=True)
    motion, begun, go = world.session.motion, threading.Event(), threading.Event()

    def endless() -> None:
        begun.set()
        assert go.wait(PATIENCE)

    motion.world.step = endless  # type: ignore[method-assign]
    world.session.set_falling(True)
    stepper = Stepper(clock=lambda: world.now)
    try:
        with ThreadPoolExecutor(1) as thread:
            painter = Painter(
                world, thread, StillQueue(1, 2**25),
                send=lambda _: None, tell_problem=_fail, encode_still=lambda *_: b"",
                still_seconds=math.inf, rest=REST, stepper=stepper, clock=lambda: world.now,
            )  # fmt: skip
            live = painter.pictures["a"] = LivePicture(world.session, watched=True, rate=30, size=WANTED)

            async def paint(seconds: float) -> None:
                end = world.now + seconds
                while world.now < end:
                    if not await painter.work():
                        world.spend(IDLE)
                    await done(live)

            for _ in range(1000):
                if begun.wait(0.01):
                    break
                await paint(0.05)
            before = len(world.drawn)
            world.turn(since=0, seconds=1)
            await paint(1)
            assert len(world.drawn) - before > 25, "measured 30: one for each thirtieth of a second"
            assert motion.world.state.step == 0
            assert motion.moving
    finally:
        go.set()
        stepper.stop()


WAKEFUL: dict[str, Any] = {
    "floor": {"kind": "none"},
    "optics": {"bands": 16},
    "simulation": {"restitution": 1, "friction": 0, "sleeping": False},
}
"""A stone that never rests."""


class Crowd(World):
    """One more session, whose pictures cost something else."""

    def __init__(self, full_seconds: float, other_seconds: float) -> None:
        super().__init__(full_seconds, with_stone=True)
        self.other = World(other_seconds, with_stone=True)

    def picture(
        self, stage: Stage, width: int, height: int, *, effort: LightEffort = LightEffort.PATIENT
    ) -> TimedPicture:
        world = self.other if stage.scene.floor.kind == "none" else self
        picture = TimedPicture(world, stage.scene, (width, height))
        picture.clock = self
        return picture

    cut_out = picture


async def test_a_session_of_dear_frames_leaves_another_more_than_two_fifths_of_its_rate() -> None:
    """One frame of the one takes a minute and a half; the other's best ones take 20 ms, 30 times a second alone."""
    rates = []
    for company in (False, True):
        world = Crowd(100 * SLOW, 0.02 / LADDER_SHARE)
        cheap = Session("1" * 32, Stage.of(Scene.read(WAKEFUL)))
        world.session.balance = Balance(exactness=1, pinned=True)
        with ThreadPoolExecutor(1) as thread:
            painter = Painter(
                world, thread, StillQueue(1, 2**25),
                send=lambda _: None, tell_problem=_fail, encode_still=lambda *_: b"",
                still_seconds=math.inf, rest=REST, stepper=AtOnce(world), clock=partial(getattr, world, "now"),
            )  # fmt: skip
            sessions = [cheap, world.session] if company else [cheap]
            for session in sessions:
                session.set_falling(True)
                painter.pictures[session.name] = LivePicture(session, watched=True, rate=30, size=WANTED)
            while world.now < 110:
                worked = await painter.work()
                for live in painter.pictures.values():
                    await done(live)
                if not worked:
                    world.spend(IDLE)
        assert painter.durations.render_hold.longest < 0.07, "measured 0.05 s alone, 0.026 s in company"
        rates.append(sum(not math.isnan(drawn.ended) for drawn in world.other.drawn) / 10)
    alone, beside = rates
    assert alone > 25
    assert beside >= 0.4 * alone, "measured 29.8 of 30 frames/s"
    assert any(not math.isnan(drawn.ended) for drawn in world.drawn), "the dear one is seen too"

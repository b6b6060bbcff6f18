"""Who is sent lesser pictures: on simulated links, and a clock that only these tests have."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from culet.gateway.viewers.tiers import ENTER_SECONDS, FEW_FRAMES, LEAVE_SECONDS, StreamTiers
from culet.gateway.viewers.viewer import Viewer
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.watch import LESSER, Lesser, Stream
from gateway.simulated_link import ASKED, STEP, SimulatedLink

SIZE = 1280, 720
FULL = 60_000
"""Bytes of a frame without limits."""
FAST, SLOW, SLOWER, LIKE = 2_500_000.0, 250_000.0, 60_000.0, 2_000_000.0
"""Bytes per second."""


@dataclass
class Room:
    """A session whose first viewer decides, with an engine that makes the frames that each tier has room for."""

    links: list[SimulatedLink]
    viewers: list[Viewer] = field(default_factory=list)
    tiers: StreamTiers = field(default_factory=StreamTiers)
    now: float = 0.0
    number: int = 0
    lesser_frames: int = 0
    changes: int = 0

    def __post_init__(self) -> None:
        for number, link in enumerate(self.links):
            viewer = Viewer(number, 0.0)
            viewer.credit = link.credit
            viewer.resize(*SIZE)
            self.viewers.append(viewer)

    def run(self, seconds: float) -> None:
        """So much longer: frames come ASKED times a second."""
        end = self.now + seconds
        due = self.now
        while self.now < end:
            self.now += STEP
            if self.now >= due:
                due += 1 / ASKED
                self.number += 1
                self._make()
            for link in self.links:
                link.run(STEP, engine=False)
            before = [viewer.feed.lesser for viewer in self.viewers]
            self.tiers.assign(self.viewers, self.viewers[0], SIZE, self.now)
            self.changes += sum(was != viewer.feed.lesser for was, viewer in zip(before, self.viewers, strict=True))

    def _make(self) -> None:
        first = self._size(self.viewers[:1])
        less = [viewer for viewer in self.viewers if viewer.feed.lesser]
        self.tiers.came(Codec.JPEG, first, self.now)
        if less:
            self.lesser_frames += 1
        second = min(first, self._size(less)) if less else 0
        for link, viewer in zip(self.links, self.viewers, strict=True):
            link.come(self.number, second if viewer.feed.lesser else first)

    def _size(self, viewers: list[Viewer]) -> int:
        room = min(viewer.credit.bytes_per_frame(ASKED, self.now) for viewer in viewers)
        return int(max(2_000, min(FULL, 0.95 * room)))


def room(*rates: float) -> Room:
    return Room([SimulatedLink(rate=lambda _, rate=rate: rate, round_trip=0.05) for rate in rates])  # type: ignore[misc]


def shown(link: SimulatedLink, seconds: float) -> float:
    """Frames a second, lately."""
    return len(link.since(link.now - seconds)) / seconds


@pytest.mark.parametrize("rates", [(FAST,), (FAST, FAST), (FAST, LIKE, FAST), (SLOW, FAST), (SLOW, 0.8 * SLOW)])
def test_viewers_who_differ_little_cost_no_second_picture(rates: tuple[float, ...]) -> None:
    session = room(*rates)
    session.run(8)
    assert session.lesser_frames == 0


def test_a_slow_viewer_sees_more_frames_by_lesser_pictures_and_delays_nobody() -> None:
    alone, both = room(FAST), room(FAST, SLOW)
    for session in (alone, both):
        session.run(15)
    assert [viewer.feed.lesser for viewer in both.viewers] == [False, True]
    assert both.changes == 1, "and it stays so"
    fast, slow = both.links
    assert [frame.size for frame in fast.since(10)] == [frame.size for frame in alone.links[0].since(10)]
    assert [frame.number for frame in fast.since(10)] == [frame.number for frame in alone.links[0].since(10)]
    of_full_frames = SLOW / FULL
    assert shown(slow, 5) > 3 * of_full_frames
    assert max(frame.queued for frame in slow.since(10)) < 0.3


def test_who_becomes_fast_gets_what_the_others_have_and_who_becomes_slow_does_not_keep_it() -> None:
    rates = [SLOW]
    slow = SimulatedLink(rate=lambda _: rates[-1], round_trip=0.05)
    session = Room([SimulatedLink(rate=lambda _: FAST, round_trip=0.05), slow])
    lesser = []
    for rate, seconds in ((SLOW, 8), (FAST, 15), (SLOW, 8)):
        rates.append(rate)
        session.run(seconds)
        lesser.append(session.viewers[1].feed.lesser)
    assert lesser == [True, False, True]
    assert session.changes == 3


def test_the_slowest_decides_what_lesser_pictures_are() -> None:
    session = room(FAST, SLOW, SLOWER)
    session.run(20)
    assert [viewer.feed.lesser for viewer in session.viewers] == [False, True, True]
    assert shown(session.links[2], 5) > 2 * SLOWER / FULL * 2


def test_the_viewer_who_decides_has_the_first_tier_whatever_its_link_is() -> None:
    session = room(FAST, SLOW)
    session.run(10)
    session.tiers.assign(session.viewers, session.viewers[1], SIZE, session.now)
    assert not session.viewers[1].feed.lesser, "who decided has left"


def watching(*sizes: tuple[int, int]) -> list[Viewer]:
    viewers = [Viewer(number, 0.0) for number in range(len(sizes))]
    for viewer, size in zip(viewers, sizes, strict=True):
        viewer.resize(*size)
    return viewers


@pytest.mark.parametrize(
    ("size", "lesser"), [((600, 338), True), ((1280, 720), False), ((390, 844), False), ((700, 394), False)]
)
def test_a_window_of_less_than_half_the_size_each_way_is_sent_no_more_than_it_shows(
    size: tuple[int, int], lesser: bool
) -> None:
    """A tall one may cut the picture off at its sides."""
    tiers, viewers = StreamTiers(), watching(SIZE, size)
    for now in (0.0, ENTER_SECONDS / 2, ENTER_SECONDS):
        tiers.assign(viewers, viewers[0], SIZE, now)
    assert viewers[1].feed.lesser is lesser


def test_pictures_at_rest_move_nobody_to_another_tier() -> None:
    tiers, viewers = StreamTiers(), watching(SIZE, SIZE)
    slow = viewers[1].credit
    slow.take(1, FULL, 0)
    slow.acknowledge(1, 2)
    slow.take(2, FULL, 2)
    for tick in range(40):
        now = 2 + tick / 10
        assert not slow.available(FULL, now)
        if tick % 10 < FEW_FRAMES - 1:
            tiers.came(Codec.JPEG, FULL, now)
        tiers.assign(viewers, viewers[0], SIZE, now)
    assert not viewers[1].feed.lesser


def moved(tiers: StreamTiers, viewers: list[Viewer], now: float, seconds: float) -> float:
    """Ticks in which nothing comes; the time afterwards."""
    for _ in range(round(seconds / 0.1)):
        now += 0.1
        tiers.assign(viewers, viewers[0], SIZE, now)
    return now


def test_a_small_window_that_grows_at_rest_gets_the_first_tier_and_the_frame_anew() -> None:
    tiers, viewers = StreamTiers(), watching(SIZE, (320, 180))
    viewers[1].credit.take(1, 8_000, 0)
    viewers[1].credit.acknowledge(1, 0.1)
    now, lesser = 1.0, []
    for size in ((320, 180), SIZE):
        viewers[1].resize(*size)
        now = moved(tiers, viewers, now, 2 * LEAVE_SECONDS)
        lesser.append(viewers[1].feed.lesser)
    assert lesser == [True, False]
    assert viewers[1].feed.lacks_picture


def test_a_window_that_is_dragged_to_and_fro_about_half_the_size_changes_tiers_once() -> None:
    tiers, viewers = StreamTiers(), watching(SIZE, SIZE)
    now, lesser = 0.0, []
    for width in (700, 600, 700, 800):
        viewers[1].resize(width, width * 9 // 16)
        now = moved(tiers, viewers, now, 2 * LEAVE_SECONDS)
        lesser.append(viewers[1].feed.lesser)
    assert lesser == [False, True, True, False]


def test_a_slow_viewer_keeps_lesser_pictures_at_rest() -> None:
    session = room(FAST, SLOW)
    session.run(8)
    now = moved(session.tiers, session.viewers, session.now, 10)
    assert session.viewers[1].feed.lesser
    session.viewers[1].resize(320, 180)
    now = moved(session.tiers, session.viewers, now, 1)
    session.viewers[1].resize(*SIZE)
    moved(session.tiers, session.viewers, now, 2 * LEAVE_SECONDS)
    assert session.viewers[1].feed.lesser, "its link is as it was"


def test_a_small_window_of_a_viewer_of_video_goes_on_with_that() -> None:
    tiers, viewers = StreamTiers(), watching(SIZE, (320, 180))
    now, lesser = 0.0, []
    for codec in (Codec.H264, None):
        viewers[1].feed.follow(codec)
        now = moved(tiers, viewers, now, 2 * ENTER_SECONDS)
        lesser.append(viewers[1].feed.lesser)
    assert lesser == [False, True]


def test_of_frames_no_more_is_remembered_than_is_counted() -> None:
    tiers = StreamTiers()
    for number in range(6_000):
        tiers.came(Codec.JPEG, FULL, number / 60)
        tiers.came(LESSER, FULL, number / 60)
    assert sum(map(len, tiers._came.values())) <= 62


def test_a_viewer_of_lesser_pictures_is_offered_those_and_their_video_alone() -> None:
    (viewer,) = watching(SIZE)
    viewer.feed.follow(Codec.H264)
    viewer.feed.follow_lesser(lesser=True)
    streams: tuple[Stream, ...] = (Codec.H264, Lesser.H264)
    assert viewer.feed.codecs == {LESSER, Lesser.H264}
    key = Frame(bytes(16), Codec.H264, Flags.KEY, 7, 1, 1, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"key")
    for stream in streams:
        viewer.offer(key, b"key", 0, stream)
        assert viewer.feed.in_step == (stream is Lesser.H264)
    assert viewer.feed.codecs == {Lesser.H264}
    viewer.feed.follow_lesser(lesser=False)
    assert not viewer.feed.in_step
    assert viewer.feed.codecs == {Codec.JPEG, Codec.H264}

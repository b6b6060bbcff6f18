"""The second picture of a frame: of the same rendering, within the limits of slower links and smaller windows."""

from __future__ import annotations

from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
import simplejpeg
from numpy.typing import NDArray

from culet.engine.governing.thrift import BEST_CRF, FINAL_TIMES, GROWN, NO_LIMITS, ByteAllowance, Encoding
from culet.engine.painting.coded import Coded
from culet.engine.painting.lesser_tier import LesserTier, shrunk
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.live_picture import LivePicture, PictureState
from culet.engine.painting.painter import Painter
from culet.engine.painting.renderer import AnyRenderer
from culet.engine.painting.still import EncodeStill, StillQueue
from culet.engine.painting.video_track import BYTES_PER_PIXEL, CHANGE_SECONDS, VideoTrack
from culet.errors import CuletError
from culet.rendering.film.target import Target
from culet_protocol.frame import Codec, Flags
from culet_protocol.watch import LESSER, Lesser, Stream, topic_of
from engine.painting.test_frame_sender import VIDEO_TOPIC, WATCH, Desk, Telling

LESSER_TOPIC = topic_of(WATCH, LESSER)
WIDTH, HEIGHT = 640, 360


@pytest.fixture
async def desk() -> AsyncIterator[Desk]:
    desk = Desk()
    yield desk
    desk.sender.stop()


@pytest.fixture
def frame(desk: Desk) -> LiveFrame:
    """Of much detail, so that it has many bytes."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    levels = 128 + 60 * np.sin(columns / 3) + 60 * np.sin(rows / 5 + columns / 17)
    rgb = np.stack([levels, np.roll(levels, 7, 0), np.roll(levels, 9, 1)], -1).astype(np.uint8)
    return replace(desk.frame, rgb=rgb, encoding=Encoding(85, np.inf, thrifty=False))


def within(per_frame: int, at_rest: int | None = None) -> LesserTier:
    tier = LesserTier()
    tier.allowance = ByteAllowance(per_frame, at_rest)
    tier.room = tier.allowance.room(30, 30)
    return tier


async def test_it_has_no_more_bytes_than_the_link_has_room_for_and_the_first_one_is_as_it_was(frame: LiveFrame) -> None:
    first = frame.encoded(NO_LIMITS)
    most = len(first.data) // 4
    less = within(most).encoded(frame)
    assert len(less.data) <= GROWN * 2 * most, "as often as 15 times a second, at most"
    assert less.thrifty
    assert frame.encoded(NO_LIMITS) == first
    shown = simplejpeg.decode_jpeg(less.data)
    assert shown.shape == (less.height, less.width, 3)
    assert abs(shown.mean() - frame.rgb.mean()) < 2  # levels; 0.3 measured


async def test_with_as_much_room_as_the_first_it_is_the_same_picture(frame: LiveFrame) -> None:
    assert LesserTier().encoded(frame) == frame.encoded(NO_LIMITS)
    assert within(10**7).encoded(frame) == frame.encoded(NO_LIMITS)


@pytest.mark.parametrize(
    ("window", "size"), [((320, 180), (320, 180)), ((180, 320), (569, 320)), ((2000, 100), (WIDTH, HEIGHT))]
)
async def test_it_fills_the_window_and_is_no_larger_than_what_was_drawn(
    frame: LiveFrame, window: tuple[int, int], size: tuple[int, int]
) -> None:
    tier = LesserTier()
    tier.size = window
    less = tier.encoded(frame)
    assert (less.width, less.height) == size
    assert not less.thrifty, "the window is small, not the link slow"


async def test_at_rest_it_has_the_bytes_that_there_are_for_a_picture_at_rest(frame: LiveFrame) -> None:
    resting = replace(frame, planned=False, encoding=None)
    most = len(resting.encoded(NO_LIMITS).data) // 3
    assert len(within(1, most).encoded(resting).data) <= most


async def test_the_last_picture_at_rest_has_the_bytes_of_some_seconds(desk: Desk, frame: LiveFrame) -> None:
    """Of either tier: none comes after it that could be better."""
    resting = replace(frame, planned=False, encoding=None)
    best = resting.encoded(NO_LIMITS)
    most = int(len(best.data) / (0.8 * FINAL_TIMES))
    coarse, last = (within(1, most).encoded(replace(resting, final=final)) for final in (False, True))
    assert coarse.thrifty
    assert len(coarse.data) <= most
    assert last == best
    desk.outgoing.allowance = ByteAllowance(1, most)
    for final in (False, True):
        desk.frame = replace(resting, final=final)
        await desk.publish()
    assert [len(sent.payload) for sent in desk.sent] == [len(coarse.data), len(best.data)]


async def test_it_goes_out_under_the_number_of_the_frame_by_a_topic_of_its_own(desk: Desk, frame: LiveFrame) -> None:
    desk.frame = frame
    desk.watch(Codec.JPEG, Codec.H264)
    desk.outgoing.watch(LESSER, subscribed=True)
    desk.outgoing.lesser.size = (320, 180)
    sent = await desk.publish()
    assert sent == [(VIDEO_TOPIC, Codec.H264, 1), (WATCH, Codec.JPEG, 1), (LESSER_TOPIC, Codec.JPEG, 1)]
    assert [sent.width for sent in desk.sent] == [WIDTH, WIDTH, 320]
    assert Flags.KEY in desk.sent[-1].flags
    desk.sender.repeat(desk.outgoing)
    assert desk.sent[-1].width == 320


async def test_the_first_tier_leaves_before_it_is_made(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    before = []
    encoded = LesserTier.encoded

    def noting(tier: LesserTier, frame: LiveFrame) -> Coded:
        before.append([(sent.watch, sent.sequence) for sent in desk.sent])
        return encoded(tier, frame)

    monkeypatch.setattr(LesserTier, "encoded", noting)
    desk.watch(Codec.JPEG, Codec.H264)
    desk.outgoing.watch(LESSER, subscribed=True)
    await desk.publish()
    assert before == [[(VIDEO_TOPIC, 1), (WATCH, 1)]]


async def test_one_that_fails_costs_the_others_no_frame_and_no_key_frame(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise CuletError("it cannot be shrunk")

    problems: list[CuletError] = []
    monkeypatch.setattr(LesserTier, "encoded", fails)
    monkeypatch.setattr(desk.sender, "_tell_problem", lambda _, problem: problems.append(problem))
    desk.watch(Codec.JPEG, Codec.H264)
    desk.outgoing.watch(LESSER, subscribed=True)
    for number in (1, 2):
        assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, number), (WATCH, Codec.JPEG, number)]
        assert len(problems) == number
        assert desk.outgoing.unsent == 0
    assert [sent.depends_on for sent in desk.sent if sent.codec is Codec.H264] == [0, 1]


async def test_who_has_it_can_be_sent_the_frame_under_another_number(desk: Desk, frame: LiveFrame) -> None:
    desk.frame = frame
    desk.watch(Codec.JPEG)
    await desk.publish(planned=False)
    desk.sender.send_anew(desk.session, desk.outgoing)
    assert [sent.sequence for sent in desk.sent] == [1, 1], "nobody has another picture of that number"
    desk.outgoing.watch(LESSER, subscribed=True)
    desk.outgoing.lesser.size = (320, 180)
    await desk.publish(planned=False)
    first, lesser = desk.sent[2:]
    desk.outgoing.watch(LESSER, subscribed=False)
    desk.sender.send_anew(desk.session, desk.outgoing)
    (again,) = desk.sent[4:]
    assert (first.sequence, lesser.sequence, again.sequence) == (2, 2, 3)
    assert (again.watch, again.payload, again.flags, again.samples) == (WATCH, first.payload, first.flags, 1)
    await desk.publish(planned=False)
    assert desk.sent[-1].sequence == 4


async def test_alone_it_is_repeated_too(desk: Desk) -> None:
    desk.watch()
    desk.outgoing.watch(LESSER, subscribed=True)
    assert await desk.publish(planned=False) == [(LESSER_TOPIC, Codec.JPEG, 1)]
    desk.sender.repeat(desk.outgoing)
    assert [sent.watch for sent in desk.sent] == [LESSER_TOPIC, LESSER_TOPIC]


async def at_rest(desk: Desk, window: tuple[int, int]) -> LivePicture:
    """A picture that is as good as it becomes, and was sent as a lesser one for such a window alone."""
    live = LivePicture(desk.session, watched=True, outgoing=desk.outgoing)
    live.painted, live.painted_size, live.size, live.state = (
        live.session.shown,
        live.size,
        live.size,
        PictureState.FINAL,
    )
    desk.watch()
    desk.outgoing.watch(LESSER, subscribed=True)
    live.resize_lesser(window)
    await desk.publish(planned=False)
    assert live.at_rest
    return live


@pytest.mark.parametrize(
    ("window", "state"),
    [((640, 300), PictureState.BLANK), ((320, 180), PictureState.FINAL), ((100, 100), PictureState.FINAL)],
)
async def test_at_rest_it_is_drawn_anew_for_a_larger_window_only(
    desk: Desk, window: tuple[int, int], state: PictureState
) -> None:
    live = await at_rest(desk, (320, 180))
    live.resize_lesser(window)
    assert live.state is state


async def test_who_comes_to_a_session_at_rest_of_which_there_is_only_a_lesser_picture_has_one_drawn(desk: Desk) -> None:
    live = await at_rest(desk, (320, 180))
    painter = Painter(
        cast(AnyRenderer, None), cast(ThreadPoolExecutor, None), StillQueue(1, 1), send=lambda _: None,
        tell_problem=lambda *_: None, encode_still=cast(EncodeStill, None), still_seconds=1, rest=Target(1, None),
    )  # fmt: skip
    states = []
    for stream in (LESSER, Codec.JPEG):
        desk.outgoing.watch(stream, subscribed=True)
        painter.show_again(live, stream)
        states.append(live.state)
    assert states == [PictureState.FINAL, PictureState.BLANK]


async def test_for_nobody_it_is_not_made(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise AssertionError("nobody asked")

    monkeypatch.setattr(LesserTier, "encoded", fails)
    assert await desk.publish() == [(WATCH, Codec.JPEG, 1)]
    desk.outgoing.watch(LESSER, subscribed=True)
    desk.outgoing.watch(LESSER, subscribed=False)
    assert await desk.publish() == [(WATCH, Codec.JPEG, 2)]


async def test_while_video_is_held_those_with_lesser_pictures_go_on(desk: Desk) -> None:
    desk.watch(Codec.H264)
    desk.outgoing.watch(LESSER, subscribed=True)
    await desk.publish()
    desk.outgoing.hold(Codec.H264, desk.now, held=True)
    assert await desk.publish() == [(LESSER_TOPIC, Codec.JPEG, 2)]


LESSER_VIDEO_TOPIC = topic_of(WATCH, Lesser.H264)


def follow(desk: Desk, frame: LiveFrame, *streams: Stream) -> None:
    """Those watch; every encoder only says what it was given."""
    Telling.fails = False
    desk.frame = frame
    desk.watch()
    for stream in streams:
        desk.outgoing.watch(stream, subscribed=True)
    for tracks in (desk.outgoing.tracks, desk.outgoing.lesser.tracks):
        for codec in tracks:
            tracks[codec] = VideoTrack(codec, Telling)


async def test_each_tier_has_video_of_its_own_of_the_same_frames(desk: Desk, frame: LiveFrame) -> None:
    follow(desk, frame, Codec.H264, Lesser.H264)
    desk.outgoing.lesser.size = (320, 180)
    for number in (1, 2):
        sent = await desk.publish()
        assert sent == [(VIDEO_TOPIC, Codec.H264, number), (LESSER_VIDEO_TOPIC, Codec.H264, number)]
    assert [(sent.width, sent.depends_on) for sent in desk.sent] == [(WIDTH, 0), (320, 0), (WIDTH, 1), (320, 1)]
    sizes = BYTES_PER_PIXEL[Codec.H264] * (WIDTH * HEIGHT + 320 * 180)
    assert desk.outgoing.nbytes == sizes
    assert (desk.outgoing.give_back(), desk.outgoing.nbytes) == (sizes, 0)
    await desk.publish()
    assert [sent.depends_on for sent in desk.sent[-2:]] == [0, 0]
    desk.outgoing.hold(Lesser.H264, desk.now, held=True)
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 4)], "skipped before it is encoded"
    desk.outgoing.hold(Lesser.H264, desk.now, held=False)
    await desk.publish()
    assert [sent.depends_on for sent in desk.sent[-2:]] == [4, 3], "of its own packets"


async def test_the_lesser_video_keeps_to_the_link_and_is_no_better_than_the_first(desk: Desk, frame: LiveFrame) -> None:
    follow(desk, frame, Lesser.H264)
    desk.outgoing.lesser.room = ByteAllowance(1500, None).room(30, 30)
    await desk.publish()
    (sent,) = desk.sent
    assert Flags.THRIFTY in sent.flags
    size, crf = desk.outgoing.lesser.video_of(frame)
    assert crf > BEST_CRF or size < frame.size
    coarse = replace(frame, encoding=Encoding(50, np.inf, thrifty=True, crf=40))
    desk.outgoing.lesser.room = None
    assert desk.outgoing.lesser.video_of(coarse) == (frame.size, 40)


async def test_the_lesser_video_of_all_codecs_is_of_one_size_and_shrunk_once(
    desk: Desk, frame: LiveFrame, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = list[tuple[int, int]]()

    def counted(rgb: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
        sizes.append((width, height))
        return shrunk(rgb, width, height)

    monkeypatch.setattr("culet.engine.painting.frame_sender.shrunk", counted)
    follow(desk, frame, Lesser.H264, Lesser.VP9)
    desk.outgoing.lesser.size = (320, 180)
    desk.outgoing.lesser.room = ByteAllowance(1500, None).room(30, 30)
    for number in (1, 2, 3):
        desk.now += CHANGE_SECONDS  # what an encoder was given before does not keep it from another size
        await desk.publish()
        assert len(sizes) == number
        assert {(sent.width, sent.height) for sent in desk.sent[-2:]} == {sizes[-1]}
        assert {sent.codec for sent in desk.sent[-2:]} == {Codec.H264, Codec.VP9}


async def test_stills_and_frames_of_an_encoder_that_failed_twice_are_lesser_pictures(
    desk: Desk, frame: LiveFrame
) -> None:
    follow(desk, frame, Codec.JPEG, Lesser.H264, LESSER)
    topics = (WATCH, LESSER_VIDEO_TOPIC, LESSER_TOPIC)
    assert await desk.publish() == [
        (WATCH, Codec.JPEG, 1), (LESSER_VIDEO_TOPIC, Codec.H264, 1), (LESSER_TOPIC, Codec.JPEG, 1),
    ]  # fmt: skip
    assert set(await desk.publish(planned=False)) == {(topic, Codec.JPEG, 2) for topic in topics}
    Telling.fails = True
    for number in (3, 4, 5):
        assert set(await desk.publish()) == {(topic, Codec.JPEG, number) for topic in topics}
    assert not desk.outgoing.lesser.tracks[Codec.H264].works


async def test_without_room_for_its_encoder_it_is_pictures(desk: Desk, frame: LiveFrame) -> None:
    follow(desk, frame, Lesser.H264)
    desk.room = 0
    assert await desk.publish() == [(LESSER_VIDEO_TOPIC, Codec.JPEG, 1)]
    assert desk.outgoing.nbytes == 0


async def test_who_follows_its_video_is_sent_no_first_picture_while_things_move(desk: Desk, frame: LiveFrame) -> None:
    follow(desk, frame, Codec.JPEG, Lesser.H264)
    await desk.publish()
    before = len(desk.sent)
    desk.sender.repeat(desk.outgoing)
    assert [sent.watch for sent in desk.sent[before:]] == [WATCH]
    desk.outgoing.watch(Lesser.H264, subscribed=False)
    assert not desk.outgoing.lesser.tracks

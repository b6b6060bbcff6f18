"""What of a frame goes out, by which topic; the encoder of video here only says what it was given."""

from __future__ import annotations

import asyncio
import math
import threading
from collections.abc import AsyncIterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.engine.governing.thrift import FINAL_TIMES, NO_LIMITS, ByteAllowance
from culet.engine.painting.coded import Coded
from culet.engine.painting.counters import SharedCounters
from culet.engine.painting.frame_sender import FrameSender, Outgoing
from culet.engine.painting.lesser_tier import LesserTier
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.resting_picture import encode_png, encode_resting
from culet.engine.painting.video import Packet, VideoEncoder, VideoError
from culet.engine.painting.video_track import BYTES_PER_PIXEL, CHANGE_SECONDS, MOST_FAILURES, ROOM_SECONDS, VideoTrack
from culet.engine.session.session import Session
from culet.errors import CuletError
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.watch import LESSER, topic_of, video_topic, watch_key
from shared.patience import PATIENCE

NAME = "0" * 32
WATCH = watch_key(NAME)
VIDEO_TOPIC = video_topic(WATCH, Codec.H264)


class Telling(VideoEncoder):
    fails = False

    def __init__(self, codec: Codec, width: int, height: int, crf: int) -> None:
        self.codec, self.width, self.height, self.crf = codec, width, height, crf
        self.count = 0

    def encode(self, rgb: NDArray[np.uint8], now: float, *, key: bool = False) -> Packet:
        if Telling.fails:
            raise VideoError("the encoder was killed")
        self.count += 1
        return Packet(b"packet %d" % self.count, self.count == 1 or key)

    def close(self) -> None:
        pass


class Desk:
    """A sender, and what it has sent."""

    def __init__(self) -> None:
        self.now = 0.0
        self.sent: list[Frame] = []
        self.learnt: list[Coded] = []
        self.room = math.inf
        self.asked: list[int] = []
        """Bytes for which there was to be room."""
        self.session = Session(NAME, Stage.of(Scene()))
        self.outgoing = Outgoing()
        self.sender = FrameSender(
            self._take, self._fail, lambda: None, SharedCounters(), lambda: self.now, self._has_room
        )
        shown = self.session.shown
        self.frame = LiveFrame(
            rgb=np.zeros((18, 32, 3), np.uint8), shown=shown, optics=shown.scene.optics, bands=3, samples=1,
            simulate_seconds=0, render_seconds=0, develop_seconds=0, cut=0, error=math.nan, shown_error=math.nan,
            rest_error=math.nan, expected_error=0.1, final=False, slow=False, light_cut=0, light_error=0,
            shadows_only=False, encoding=None, planned=True,
        )  # fmt: skip

    def _take(self, message: bytes) -> None:
        self.sent.append(Frame.unpack(message))

    def _has_room(self, size: int) -> bool:
        self.asked.append(size)
        return size <= self.room

    def _fail(self, _: Session, error: CuletError) -> None:
        raise error

    def watch(self, *codecs: Codec) -> None:
        self.outgoing.codecs = frozenset()
        for codec in codecs:
            self.outgoing.watch(codec, subscribed=True)
        if Codec.H264 in codecs:
            self.outgoing.tracks[Codec.H264] = VideoTrack(Codec.H264, Telling)

    async def publish(self, *, planned: bool = True) -> list[tuple[bytes, Codec, int]]:
        """Topic, codec and number of what a frame led to."""
        before = len(self.sent)
        self.sender.publish(self.session, self.outgoing, self.learnt.append, replace(self.frame, planned=planned), 0)
        assert self.outgoing.latest is not None
        await self.outgoing.latest
        return [(frame.watch, frame.codec, frame.sequence) for frame in self.sent[before:]]


@pytest.fixture
async def desk() -> AsyncIterator[Desk]:
    Telling.fails = False
    desk = Desk()
    yield desk
    desk.sender.stop()


async def test_nobody_wanting_video_none_is_made(desk: Desk) -> None:
    assert await desk.publish() == [(WATCH, Codec.JPEG, 1)]


async def test_frames_of_video_name_the_one_before_and_stills_between_them_need_none(desk: Desk) -> None:
    desk.watch(Codec.H264)
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 1)]
    assert await desk.publish(planned=False) == [(VIDEO_TOPIC, Codec.JPEG, 2)]
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 3)]
    key, still, delta = desk.sent
    assert [(frame.depends_on, Flags.KEY in frame.flags) for frame in (key, still, delta)] == [
        (0, True), (0, True), (1, False),
    ]  # fmt: skip
    assert delta.payload == b"packet 2"


async def test_who_wants_video_and_who_does_not_get_the_same_frame_under_one_number(desk: Desk) -> None:
    desk.watch(Codec.JPEG, Codec.H264)
    sent = await desk.publish()
    assert sent == [(VIDEO_TOPIC, Codec.H264, 1), (WATCH, Codec.JPEG, 1)], "who has the picture begins no video with it"


async def test_video_that_is_held_is_skipped_before_it_is_encoded(desk: Desk) -> None:
    desk.watch(Codec.JPEG, Codec.H264)
    await desk.publish()
    desk.outgoing.hold(Codec.H264, desk.now, held=True)
    assert await desk.publish() == [(WATCH, Codec.JPEG, 2)]
    desk.outgoing.hold(Codec.H264, desk.now, held=False)
    await desk.publish()
    (after,) = [frame for frame in desk.sent[3:] if frame.codec is Codec.H264]
    assert (after.depends_on, after.payload) == (1, b"packet 2")


async def test_while_all_is_held_the_picture_before_is_not_shown_again_as_the_latest(desk: Desk) -> None:
    desk.watch(Codec.H264)
    await desk.publish(planned=False)
    assert desk.outgoing.message is not None
    desk.outgoing.hold(Codec.H264, desk.now, held=True)
    assert await desk.publish() == []
    assert desk.outgoing.message is None


async def test_a_still_is_repeated_to_all_who_watch_and_a_packet_to_nobody(desk: Desk) -> None:
    desk.watch(Codec.JPEG, Codec.H264)
    await desk.publish(planned=False)
    desk.sender.repeat(desk.outgoing)
    assert {frame.watch for frame in desk.sent[2:]} == {WATCH, VIDEO_TOPIC}
    desk.watch(Codec.H264)
    await desk.publish()
    before = len(desk.sent)
    desk.sender.repeat(desk.outgoing)
    assert len(desk.sent) == before


async def test_an_encoder_that_is_killed_twice_leaves_jpeg_to_all(desk: Desk) -> None:
    desk.watch(Codec.H264)
    await desk.publish()
    Telling.fails = True
    for number in range(MOST_FAILURES):
        assert await desk.publish() == [(VIDEO_TOPIC, Codec.JPEG, 2 + number)], "at once, and as JPEG"
    Telling.fails = False
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.JPEG, 2 + MOST_FAILURES)]


async def test_after_one_failure_video_goes_on_with_a_key_frame(desk: Desk) -> None:
    desk.watch(Codec.H264)
    await desk.publish()
    Telling.fails = True
    await desk.publish()
    Telling.fails = False
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 3)]
    assert desk.sent[-1].depends_on == 0


async def test_encoders_are_given_back_while_nothing_is_sent_and_video_goes_on_with_a_key_frame(desk: Desk) -> None:
    desk.watch(Codec.H264)
    await desk.publish()
    await desk.publish()
    held = desk.outgoing.nbytes
    assert held == BYTES_PER_PIXEL[Codec.H264] * 32 * 18
    desk.outgoing.unsent += 1
    assert desk.outgoing.give_back() == 0, "one may be encoding"
    desk.outgoing.unsent -= 1
    assert (desk.outgoing.give_back(), desk.outgoing.nbytes) == (held, 0)
    await desk.publish()
    assert [frame.depends_on for frame in desk.sent] == [0, 1, 0]


async def test_without_room_for_an_encoder_frames_are_pictures_until_there_is(desk: Desk) -> None:
    desk.watch(Codec.H264)
    needed = BYTES_PER_PIXEL[Codec.H264] * 32 * 18
    desk.room = needed - 1
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.JPEG, 1)]
    video = [desk.outgoing.is_video]
    desk.room = needed
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.JPEG, 2)]
    assert desk.asked == [needed], "others would have to give back what they need once a frame"
    desk.now += ROOM_SECONDS
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 3)]
    video.append(desk.outgoing.is_video)
    assert video == [False, True], "the link's limits are those of what is sent"
    desk.room = 0
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 4)], "it has what it needs"


async def test_what_an_encoder_is_about_to_take_counts_as_taken(desk: Desk) -> None:
    needed = BYTES_PER_PIXEL[Codec.H264] * 32 * 18
    first, second = (VideoTrack(Codec.H264, Telling) for _ in range(2))

    def has_room(size: int) -> bool:
        return first.nbytes + second.nbytes + size <= needed

    assert first.find_room((32, 18), 30, 0, has_room)
    assert first.nbytes == needed
    assert not second.find_room((32, 18), 30, 0, has_room)
    first.encode(desk.frame.rgb, 30, 0)
    assert (first.nbytes, second.nbytes) == (needed, 0)


async def test_nothing_counts_as_taken_for_a_frame_that_is_held(desk: Desk) -> None:
    desk.watch(Codec.H264)
    desk.outgoing.hold(Codec.H264, desk.now, held=True)
    assert await desk.publish() == []
    assert desk.asked
    assert desk.outgoing.nbytes == 0


async def test_frames_that_are_repeated_at_rest_need_no_encoder(desk: Desk) -> None:
    desk.watch(Codec.H264)
    desk.now = 10
    await desk.publish()
    desk.now = 11
    await desk.publish(planned=False)
    for _ in range(3):
        desk.now += 1
        desk.sender.repeat(desk.outgoing)
    assert (desk.outgoing.sent_at, desk.outgoing.encoded_at) == (14, 10)


async def test_of_an_encoder_of_another_size_only_what_is_more_needs_room(desk: Desk) -> None:
    desk.watch(Codec.H264)
    await desk.publish()
    desk.now += CHANGE_SECONDS
    desk.frame = replace(desk.frame, rgb=np.zeros((36, 64, 3), np.uint8))
    desk.room = 0
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.JPEG, 2)]
    assert desk.asked[-1] == 3 * desk.asked[0]
    desk.frame = replace(desk.frame, rgb=np.zeros((18, 32, 3), np.uint8))
    assert await desk.publish() == [(VIDEO_TOPIC, Codec.H264, 3)]
    assert desk.sent[-1].depends_on == 1, "of the encoder that was there all the time"


async def test_a_picture_at_rest_is_repeated_ever_more_rarely_until_somebody_comes(desk: Desk) -> None:
    def waits(times: int) -> list[float]:
        """s between so many repetitions that come by themselves."""
        waited = []
        for _ in range(times):
            waited.append(desk.outgoing.silent_seconds)
            desk.now += desk.outgoing.silent_seconds
            desk.sender.repeat_by_itself(desk.outgoing)
            assert desk.outgoing.sent_at == desk.now
        return waited

    await desk.publish(planned=False)
    assert waits(6) == [1, 2, 4, 8, 8, 8]
    assert len(desk.sent) == 1 + 6
    desk.sender.repeat(desk.outgoing)
    assert waits(2) == [1, 2], "for who has just come, and may have missed it"
    await desk.publish(planned=False)
    assert waits(2) == [1, 2]
    resting = Resting(desk)
    resting.allow(0.4)
    await desk.publish(planned=False)
    assert waits(2) == [1, 2]
    resting.allow(2)
    assert await resting.improve()
    assert waits(2) == [1, 2], "a better one is a new one"


class Resting:
    """A picture at rest of much detail, and the bytes that it has with as much loss as those before it."""

    def __init__(self, desk: Desk) -> None:
        rows, columns = np.mgrid[:360, :640]
        levels = (128 + 60 * np.sin(columns / 3) + 60 * np.sin(rows / 5 + columns / 17)).astype(np.uint8)
        self.desk = desk
        desk.frame = replace(desk.frame, rgb=np.stack([levels] * 3, -1), final=True)
        self.bytes = len(encode_resting(desk.frame.rgb, NO_LIMITS, final=False).data)

    def allow(self, share: float, lesser: float = 1.0) -> None:
        """Links have room for so much of it, as the final picture."""
        self.desk.outgoing.allowance = ByteAllowance(10**6, int(share * self.bytes / FINAL_TIMES))
        self.desk.outgoing.lesser.allowance = ByteAllowance(10**6, int(lesser * self.bytes / FINAL_TIMES))

    async def improve(self) -> list[tuple[bytes, int]]:
        """Topic and number of what is sent because of that."""
        before, outgoing = len(self.desk.sent), self.desk.outgoing
        self.desk.sender.improve(self.desk.session, outgoing)
        while outgoing.unsent:
            assert outgoing.latest is not None
            await outgoing.latest
        return [(frame.watch, frame.sequence) for frame in self.desk.sent[before:]]


async def test_the_picture_at_rest_is_sent_again_in_better_quality_once_the_link_is_better(desk: Desk) -> None:
    resting = Resting(desk)
    resting.allow(0.4)
    await desk.publish(planned=False)
    small = desk.sent[-1]
    assert Flags.THRIFTY in small.flags
    assert await resting.improve() == []
    resting.allow(0.5)
    assert await resting.improve() == [], "that is not worth it"
    resting.allow(2)
    assert await resting.improve() == [(WATCH, 2)]
    better = desk.sent[-1]
    assert len(better.payload) == resting.bytes > len(small.payload)
    assert Flags.FINAL in better.flags
    assert Flags.THRIFTY not in better.flags
    assert desk.outgoing.message is not None
    assert Frame.unpack(desk.outgoing.message).payload == better.payload, "for whoever comes, too"
    resting.allow(2.5)
    assert await resting.improve() == [], "that is not worth it"
    resting.allow(4 * FINAL_TIMES)
    assert await resting.improve() == [(WATCH, 3)]
    assert (desk.sent[-1].codec, desk.sent[-1].payload) == (Codec.PNG, encode_png(desk.frame.rgb))
    resting.allow(40 * FINAL_TIMES)
    assert await resting.improve() == [], "there is no better one"


async def test_a_link_that_gets_better_while_the_picture_is_on_its_way_counts_too(desk: Desk) -> None:
    resting = Resting(desk)
    resting.allow(0.4)
    desk.sender.publish(desk.session, desk.outgoing, desk.learnt.append, replace(desk.frame, planned=False), 0)
    await asyncio.sleep(0)
    await asyncio.sleep(0)  # its quality is being chosen
    resting.allow(2)
    desk.sender.improve(desk.session, desk.outgoing)
    await resting.improve()
    assert len(desk.sent[-1].payload) == resting.bytes


@pytest.mark.parametrize("begun", [False, True], ids=["waits", "begun"])
@pytest.mark.parametrize("again", [False, True], ids=["first", "again"])
async def test_what_an_input_changes_waits_for_no_final_picture(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, *, again: bool, begun: bool
) -> None:
    """Neither for its own, nor for those of others that are encoded before it."""
    resting, going_on = Resting(desk), threading.Event()
    encode = LiveFrame.encoded

    def held_up(frame: LiveFrame, allowance: ByteAllowance) -> Coded:
        assert not frame.final or going_on.wait(PATIENCE)
        return encode(frame, allowance)

    if again:
        resting.allow(0.4)
        await desk.publish(planned=False)
        resting.allow(2)
    monkeypatch.setattr(LiveFrame, "encoded", held_up)
    if again:
        desk.sender.improve(desk.session, desk.outgoing)
    else:
        final = replace(desk.frame, planned=False)
        desk.sender.publish(desk.session, desk.outgoing, desk.learnt.append, final, 0)
    if begun:
        await asyncio.sleep(0)
    assert desk.outgoing.unsent == 1
    given_up, count = desk.outgoing.latest, len(desk.sent)
    desk.frame = replace(desk.frame, final=False)
    try:
        assert await desk.publish() == [(WATCH, Codec.JPEG, count + 1)]
        assert given_up is not None
        assert given_up.cancelled()
        assert desk.outgoing.unsent == 0
    finally:
        going_on.set()
    await desk.publish()
    assert not any(Flags.FINAL in frame.flags for frame in desk.sent[count:]), "it would be seen after what came later"


@pytest.mark.parametrize("kept", ["moving", "replaced", "not final"])
async def test_nothing_else_than_the_final_picture_is_sent_again(desk: Desk, kept: str) -> None:
    resting = Resting(desk)
    resting.allow(0.4)
    if kept == "not final":
        desk.frame = replace(desk.frame, final=False)
    await desk.publish(planned=kept == "moving")
    if kept == "replaced":
        await desk.publish()
    resting.allow(2)
    assert await resting.improve() == []


async def test_the_lesser_picture_at_rest_grows_by_itself_and_so_does_the_first(desk: Desk) -> None:
    desk.outgoing.watch(LESSER, subscribed=True)
    topic, resting = topic_of(WATCH, LESSER), Resting(desk)
    resting.allow(0.4, 0.2)
    await desk.publish(planned=False)
    resting.allow(0.4, 0.4)
    assert await resting.improve() == [(topic, 2)]
    resting.allow(2, 0.4)
    assert await resting.improve() == [(WATCH, 3)]
    resting.allow(2, 2)
    assert await resting.improve() == [(topic, 4)]
    assert [len(frame.payload) for frame in desk.sent[-2:]] == [resting.bytes] * 2
    desk.sender.send_anew(desk.session, desk.outgoing)
    assert {(frame.watch, frame.sequence) for frame in desk.sent[-2:]} == {(WATCH, 5), (topic, 5)}, (
        "whoever has the lesser one takes no other of its number"
    )


async def test_a_picture_that_nobody_is_sent_is_not_encoded_again_until_somebody_is(desk: Desk) -> None:
    """It would be encoded for ever, as often as the loop turns."""
    desk.outgoing.watch(LESSER, subscribed=True)
    resting = Resting(desk)
    resting.allow(0.4, 2)
    await desk.publish(planned=False)
    desk.outgoing.watch(Codec.JPEG, subscribed=False)
    resting.allow(2, 2)
    assert await resting.improve() == []
    desk.outgoing.watch(Codec.JPEG, subscribed=True)
    assert await resting.improve() == [(WATCH, 2)]


async def test_whether_a_better_picture_is_sent_is_decided_when_it_is_encoded_for_each_tier(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The links may have got worse since it was seen that they had got better."""
    desk.outgoing.watch(LESSER, subscribed=True)
    resting = Resting(desk)
    resting.allow(0.4, 0.4)
    await desk.publish(planned=False)
    resting.allow(2, 2)
    desk.sender.improve(desk.session, desk.outgoing)
    resting.allow(0.2, 0.2)
    assert await resting.improve() == []
    encode = LiveFrame.encoded

    def worsening(frame: LiveFrame, allowance: ByteAllowance) -> Coded:
        resting.allow(2, 0.2)
        return encode(frame, allowance)

    monkeypatch.setattr(LiveFrame, "encoded", worsening)
    resting.allow(2, 2)
    assert await resting.improve() == [(WATCH, 2)], "of the lesser one there was room while the first was encoded"


async def test_of_a_tier_that_is_left_while_its_better_picture_is_encoded_nothing_is_kept(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk.outgoing.watch(LESSER, subscribed=True)
    resting = Resting(desk)
    resting.allow(2, 0.2)
    await desk.publish(planned=False)
    encode = LesserTier.encoded

    def left(tier: LesserTier, frame: LiveFrame) -> Coded:
        desk.outgoing.watch(LESSER, subscribed=False)
        return encode(tier, frame)

    monkeypatch.setattr(LesserTier, "encoded", left)
    resting.allow(2, 2)
    assert await resting.improve() == []
    assert (desk.outgoing.lesser.lossy, desk.outgoing.lesser.message) == (None, None)


async def test_of_a_picture_that_nobody_watches_any_more_no_better_one_is_sent(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    resting = Resting(desk)
    resting.allow(0.4)
    await desk.publish(planned=False)
    encode = LiveFrame.encoded

    def left(frame: LiveFrame, allowance: ByteAllowance) -> Coded:
        desk.outgoing.forget_frame()
        return encode(frame, allowance)

    monkeypatch.setattr(LiveFrame, "encoded", left)
    resting.allow(2)
    assert await resting.improve() == []
    assert desk.outgoing.lossy is None

"""The second picture of a frame: of the same rendering, within the limits of slower links and smaller windows."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import replace

import numpy as np
import pytest
import simplejpeg

from culet.engine.governing.thrift import GROWN, Allowance, Encoding
from culet.engine.painting.lesser_tier import LesserTier
from culet.engine.painting.live_frame import LiveFrame
from culet_protocol.frame import Codec, Flags
from culet_protocol.watch import LESSER, topic_of
from engine.painting.test_frame_sender import VIDEO_TOPIC, WATCH, Desk

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
    tier.allowance = Allowance(per_frame, at_rest)
    tier.room = tier.allowance.room(30, 30)
    return tier


async def test_it_has_no_more_bytes_than_the_link_has_room_for_and_the_first_one_is_as_it_was(frame: LiveFrame) -> None:
    first = frame.encoded(np.inf)
    most = len(first.data) // 4
    less = within(most).encoded(frame)
    assert len(less.data) <= GROWN * 2 * most, "as often as 15 times a second, at most"
    assert less.thrifty
    assert frame.encoded(np.inf) == first
    shown = simplejpeg.decode_jpeg(less.data)
    assert shown.shape == (less.height, less.width, 3)
    assert abs(shown.mean() - frame.rgb.mean()) < 2  # levels; 0.3 measured


async def test_with_as_much_room_as_the_first_it_is_the_same_picture(frame: LiveFrame) -> None:
    assert LesserTier().encoded(frame) == frame.encoded(np.inf)
    assert within(10**7).encoded(frame) == frame.encoded(np.inf)


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
    most = len(resting.encoded(np.inf).data) // 3
    assert len(within(1, most).encoded(resting).data) <= most


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

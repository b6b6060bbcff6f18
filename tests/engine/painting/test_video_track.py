"""When video is encoded, when it begins anew, and when it is given up; the encoder here only says what it is asked."""

from __future__ import annotations

import numpy as np
import pytest

from culet.engine.painting.video import Packet, VideoEncoder, VideoError
from culet.engine.painting.video_track import (
    CHANGE_SECONDS,
    HOLD_SECONDS,
    KEY_SECONDS,
    MOST_FAILURES,
    TrackedPacket,
    VideoTrack,
)
from culet_protocol.frame import Codec

CRF = 20
BEGUN = 100.0
"""s: when the first encoder is made."""


class Telling(VideoEncoder):
    """Its first frame is a key frame, as every encoder's is."""

    def __init__(self, codec: Codec, width: int, height: int, crf: int) -> None:
        self.codec, self.width, self.height, self.crf = codec, width, height, crf
        self.count = 0

    def encode(self, rgb: np.ndarray, now: float, *, key: bool = False) -> Packet:
        self.count += 1
        return Packet(b"packet", key or self.count == 1)

    def close(self) -> None:
        pass


class Failing(Telling):
    def encode(self, rgb: np.ndarray, now: float, *, key: bool = False) -> Packet:
        raise VideoError("the encoder was killed")


def encode(track: VideoTrack, now: float, width: int = 640, height: int = 360, crf: int = CRF) -> TrackedPacket:
    packet = track.encode(np.zeros((height, width, 3), np.uint8), crf, now)
    assert packet is not None
    return packet


def test_the_first_frame_is_a_key_frame_and_those_after_it_are_not() -> None:
    track = VideoTrack(Codec.H264, Telling)
    assert [encode(track, now / 30).is_key for now in range(5)] == [True, False, False, False, False]


def test_key_frames_that_are_asked_for_come_once_a_second_at_most() -> None:
    track = VideoTrack(Codec.H264, Telling)
    keys = []
    for tick in range(90):
        track.want_key()
        if encode(track, tick / 30).is_key:
            keys.append(tick / 30)
    assert keys == pytest.approx([0, KEY_SECONDS, 2 * KEY_SECONDS])


def test_sizes_that_flicker_are_brought_to_one_until_it_is_worth_another_key_frame() -> None:
    track = VideoTrack(Codec.H264, Telling)
    encode(track, BEGUN)
    for now in (0.1, 0.2, CHANGE_SECONDS - 0.1):
        packet = encode(track, BEGUN + now, 480, 270)
        assert (packet.width, packet.height, packet.is_key) == (640, 360, False)
    packet = encode(track, BEGUN + CHANGE_SECONDS, 480, 270)
    assert (packet.width, packet.height, packet.is_key) == (480, 270, True)
    assert not encode(track, BEGUN + 9, 496, 279).is_key, "nearly the same size is not worth one"


def test_pictures_of_another_shape_are_not_squeezed_into_the_one_before() -> None:
    track = VideoTrack(Codec.H264, Telling)
    encode(track, 0)
    packet = encode(track, 0.1, 360, 360)
    assert (packet.width, packet.height, packet.is_key) == (360, 360, True)


def test_another_quality_waits_for_its_time() -> None:
    track = VideoTrack(Codec.H264, Telling)
    encode(track, BEGUN)
    assert encode(track, BEGUN + CHANGE_SECONDS - 0.1, crf=CRF + 3).crf == CRF
    assert encode(track, BEGUN + CHANGE_SECONDS, crf=CRF + 3).crf == CRF + 3


def test_a_link_that_carries_much_less_is_heeded_sooner() -> None:
    track = VideoTrack(Codec.H264, Telling)
    encode(track, BEGUN)
    assert encode(track, BEGUN + KEY_SECONDS, crf=32).crf == 32
    assert encode(track, BEGUN + 2 * KEY_SECONDS, 320, 180, crf=32).width == 320


def test_a_hold_ends_when_it_is_told_to_or_by_itself() -> None:
    track = VideoTrack(Codec.H264, Telling)
    track.hold(5, held=True)
    assert track.is_held(5.1)
    track.hold(5.2, held=False)
    assert not track.is_held(5.3)
    track.hold(6, held=True)
    assert not track.is_held(6 + HOLD_SECONDS), "whoever holds it may be gone"


def test_an_encoder_that_fails_is_replaced_and_after_so_many_failures_none_is_tried_any_more() -> None:
    track = VideoTrack(Codec.H264, Failing)
    picture = np.zeros((36, 64, 3), np.uint8)
    for failures in range(MOST_FAILURES):
        assert track.works, f"{failures} failures"
        assert track.encode(picture, CRF, failures) is None
    assert not track.works

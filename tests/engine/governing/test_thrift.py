"""Frames are as good as a link has room for, and no larger."""

from __future__ import annotations

import random
from itertools import pairwise

import numpy as np
import pytest

from culet.engine.governing.thrift import LEAST_PIXELS, NO_LIMITS, ByteAllowance, ByteRoom, Thrift, read_byte_ladder

LADDER = read_byte_ladder()
HD = 1280, 720


def chosen(thrift: Thrift, room: ByteRoom, wanted: tuple[int, int] = HD) -> tuple[tuple[int, int], int]:
    """Size and quality of the next frame."""
    scale = thrift.scale(wanted, room)
    size = round(wanted[0] * scale), round(wanted[1] * scale)
    return size, thrift.encoding(size, room).quality


def expected(size: tuple[int, int], quality: int) -> float:
    return float(LADDER.expected(size[0] * size[1])[LADDER.qualities.index(quality)])


def room_of(bytes_per_second: float, asked: float = 30.0, made: float = 60.0) -> ByteRoom:
    room = ByteAllowance(per_frame=int(bytes_per_second / asked)).room(asked, made)
    assert room is not None
    return room


def test_the_ladder_is_what_pictures_are_like() -> None:
    """A better quality has more bytes and less error, a larger picture too."""
    assert (np.diff(LADDER.bytes, axis=1) < 0).all()
    assert (np.diff(LADDER.errors, axis=1) >= 0).all()
    assert (np.diff(LADDER.errors, axis=0) > 0).all()
    for row, scale in enumerate(LADDER.scales):
        between = LADDER.expected(LADDER.pixels * scale**2)
        assert between == pytest.approx(LADDER.bytes[row])
    larger = [expected((width, width * 9 // 16), 50) for width in (160, 320, 640, 1280, 1920, 3840)]
    assert all(more > less for less, more in pairwise(larger)), "beyond what was measured too"


def test_without_limits_there_is_no_room_to_keep_to() -> None:
    assert NO_LIMITS.room(30, 60) is None


def test_a_fast_link_gets_all() -> None:
    assert chosen(Thrift(LADDER), room_of(10e6)) == (HD, LADDER.qualities[0])


@pytest.mark.parametrize("wanted", [HD, (640, 360), (1920, 1080), (390, 844)])
@pytest.mark.parametrize("kilobytes", [1000, 500, 250, 125])
def test_frames_have_the_bytes_that_there_is_room_for(wanted: tuple[int, int], kilobytes: float) -> None:
    room = room_of(kilobytes * 1e3)
    size, quality = chosen(Thrift(LADDER), room, wanted)
    count = expected(size, quality)
    assert count <= room.slow_bytes
    if count > room.bytes:  # fewer frames come then: none that is seen well would be small enough
        least = min(wanted[0] * wanted[1], LEAST_PIXELS)
        assert float(LADDER.expected(least)[-1]) > 0.7 * room.bytes


def test_the_less_room_the_less_picture() -> None:
    pixels = []
    for kilobytes in (2000, 1000, 500, 250, 125, 60):
        size, _ = chosen(Thrift(LADDER), room_of(kilobytes * 1e3))
        pixels.append(size[0] * size[1])
    assert all(more >= less for more, less in pairwise(pixels))
    assert pixels[0] > 2 * pixels[-1]


def test_what_is_too_much_for_any_link_is_as_small_as_frames_become() -> None:
    size, quality = chosen(Thrift(LADDER), room_of(100))
    assert size == (256, 144)
    assert quality == LADDER.qualities[-1]


def test_an_engine_that_is_slow_gives_each_frame_more_bytes() -> None:
    slow, fast = room_of(600e3, made=15), room_of(600e3, made=60)
    assert slow.bytes == 2 * fast.bytes
    assert room_of(600e3, made=2).bytes == slow.bytes, "but not for fewer than are seen as motion"


def test_a_scene_whose_frames_have_more_bytes_gets_smaller_ones_at_once() -> None:
    thrift, room = Thrift(LADDER), room_of(2e6)
    size, quality = chosen(thrift, room)
    thrift.encoded(size, quality, round(3 * expected(size, quality)))
    smaller, quality = chosen(thrift, room)
    assert 3 * expected(smaller, quality) <= room.bytes * 1.001
    for _ in range(20):
        thrift.encoded(smaller, quality, round(expected(smaller, quality)))
    assert chosen(thrift, room)[0] == size, "and the size back when they have fewer again"


def test_a_link_that_is_nearly_steady_does_not_change_the_size_of_pictures() -> None:
    thrift, rng, sizes = Thrift(LADDER), random.Random(1), []  # noqa: S311
    for _ in range(200):
        size, _ = chosen(thrift, room_of(1e6 * rng.uniform(0.93, 1.07)))
        sizes.append(size)
    assert sum(before != after for before, after in pairwise(sizes)) <= 2  # 79 without a preference for the last one

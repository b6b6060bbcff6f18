"""The picture that a viewer looks at for long: the last one is what was rendered, if the link carries that in time."""

from __future__ import annotations

import io

import numpy as np
import pytest
import simplejpeg
from numpy.typing import NDArray
from PIL import Image

from culet.engine.governing.thrift import FINAL_TIMES, NO_LIMITS, ByteAllowance
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet.engine.painting.resting_picture import FINER_QUALITIES, encode_png, encode_resting
from culet_protocol.frame import Codec


@pytest.fixture(scope="module")
def rgb() -> NDArray[np.uint8]:
    """Smooth colours with a little noise, as of a picture that is nearly done."""
    rows, columns = np.mgrid[:180, :320]
    levels = 128 + 60 * np.sin(columns / 13) + 60 * np.sin(rows / 15 + columns / 37)
    smooth = np.stack([levels, np.roll(levels, 7, 0), np.roll(levels, 9, 1)], -1)
    return np.clip(smooth + np.random.default_rng(1).normal(0, 1, smooth.shape), 0, 255).astype(np.uint8)


def off(coded: Coded, rgb: NDArray[np.uint8]) -> float:
    """Root mean square, from 0 to 1."""
    if coded.codec is Codec.PNG:
        with Image.open(io.BytesIO(coded.data), formats=["PNG"]) as picture:
            shown = np.asarray(picture)
    else:
        shown = simplejpeg.decode_jpeg(coded.data, "RGB")
    return float(np.sqrt(np.mean(np.square((shown.astype(float) - rgb) / 255))))


def test_the_last_picture_is_without_loss_and_those_before_are_jpegs(rgb: NDArray[np.uint8]) -> None:
    before, last = (encode_resting(rgb, NO_LIMITS, final=final) for final in (False, True))
    assert (before.codec, before.quality, before.thrifty) == (Codec.JPEG, jpeg.RESTING_QUALITY, False)
    assert (last.codec, last.thrifty) == (Codec.PNG, False)
    assert (last.width, last.height) == (320, 180)
    assert off(before, rgb) > 0
    assert off(last, rgb) == 0


def test_for_a_link_without_limits_no_picture_with_loss_is_made(
    rgb: NDArray[np.uint8], monkeypatch: pytest.MonkeyPatch
) -> None:
    def nothing(*_: object) -> bytes:
        raise AssertionError

    monkeypatch.setattr(jpeg, "encode", nothing)
    assert encode_resting(rgb, NO_LIMITS, final=True).codec is Codec.PNG


def test_a_link_has_the_least_loss_that_it_carries_as_soon_as_any_picture_at_rest(rgb: NDArray[np.uint8]) -> None:
    """Not in the time of which only the last picture may have more: what an input changes comes behind it."""
    sizes = [len(encode_png(rgb)), *(len(jpeg.encode(rgb, quality)) for quality in (*FINER_QUALITIES, 92))]
    assert sizes == sorted(sizes, reverse=True)
    errors = list[float]()
    for most in range(sizes[0], sizes[-1] // FINAL_TIMES, -sizes[0] // 40):
        coded = encode_resting(rgb, ByteAllowance(at_rest=most), final=True)
        expected = next((size for size in sizes[:-1] if size <= most), sizes[-1])
        assert len(coded.data) == expected
        assert not coded.thrifty, "it is as good as those before it"
        errors.append(off(coded, rgb))
    assert errors == sorted(errors)
    assert len(set(errors)) == len(sizes)


def test_a_slow_link_has_the_coarse_picture_in_the_time_that_the_last_one_may_take(rgb: NDArray[np.uint8]) -> None:
    most = len(jpeg.encode(rgb, 92)) // (2 * FINAL_TIMES)
    coded = encode_resting(rgb, ByteAllowance(at_rest=most), final=True)
    assert (coded.codec, coded.thrifty) == (Codec.JPEG, True)
    assert len(coded.data) <= FINAL_TIMES * most


def test_what_has_no_room_is_not_encoded(rgb: NDArray[np.uint8], monkeypatch: pytest.MonkeyPatch) -> None:
    def never(_: NDArray[np.uint8]) -> bytes:
        pytest.fail("a PNG has more than twice the bytes of the JPEG")

    monkeypatch.setattr("culet.engine.painting.resting_picture.encode_png", never)
    most = 2 * len(jpeg.encode(rgb, 92)) - 1
    assert encode_resting(rgb, ByteAllowance(at_rest=most), final=True).codec is Codec.JPEG

"""Video as FFmpeg makes it; without PyAV there is none, and nothing else is missing."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.engine.painting.video import VideoEncoder, VideoError, luma_and_chroma, video_codecs
from culet.study.stream import trial_frames
from culet_client.video import VideoDecoder
from culet_protocol.frame import Codec, Flags, Frame
from video_extra import needs_av

WIDTH, HEIGHT = 96, 64
FRAME = Frame(bytes(16), Codec.H264, Flags.KEY, 1, WIDTH, HEIGHT, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"")


def picture(number: int) -> NDArray[np.uint8]:
    """Stripes of red and blue, one pixel wide, with a white square that moves."""
    stripes = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    stripes[:, 0::2], stripes[:, 1::2] = (230, 40, 40), (50, 60, 230)
    stripes[8:24, 8 + 4 * number : 24 + 4 * number] = 250
    return stripes


@needs_av
@pytest.mark.parametrize("codec", [Codec.H264, Codec.VP9])
def test_each_packet_gives_its_picture_at_once_with_all_of_its_colour(codec: Codec) -> None:
    encoder, decoder = VideoEncoder(codec, WIDTH, HEIGHT, crf=10), VideoDecoder()
    for number in range(1, 7):
        packet = encoder.encode(picture(number), number / 30)
        assert packet.is_key == (number == 1)
        flags = Flags.KEY if packet.is_key else Flags.NONE
        depends_on = 0 if packet.is_key else number - 1
        decoded = decoder.decode(
            replace(FRAME, codec=codec, payload=packet.data, sequence=number, depends_on=depends_on, flags=flags)
        )
        assert decoded is not None
        # 3.1 (H.264) and 1.9 (VP9) levels measured; halved chroma turns the stripes purple: 60.
        assert np.abs(decoded.astype(int) - picture(number)).mean() < 5


@needs_av
def test_a_key_frame_that_is_asked_for_needs_no_frame_before_it() -> None:
    encoder = VideoEncoder(Codec.H264, WIDTH, HEIGHT, crf=20)
    encoder.encode(picture(1), 0)
    packet = encoder.encode(picture(2), 0.033, key=True)
    assert packet.is_key
    decoded = VideoDecoder().decode(replace(FRAME, payload=packet.data))
    assert decoded is not None


@needs_av
def test_a_packet_without_the_one_that_it_needs_has_no_picture() -> None:
    encoder, decoder = VideoEncoder(Codec.H264, WIDTH, HEIGHT, crf=20), VideoDecoder()
    packets = [encoder.encode(picture(number), number / 30).data for number in range(3)]
    assert decoder.decode(replace(FRAME, payload=packets[0])) is not None
    assert decoder.decode(replace(FRAME, payload=packets[2], flags=Flags.NONE, sequence=3, depends_on=2)) is None


@needs_av
def test_pictures_of_another_size_are_brought_to_that_of_the_run() -> None:
    packet = VideoEncoder(Codec.H264, WIDTH, HEIGHT, crf=20).encode(picture(1)[::2, ::2], 0)
    decoded = VideoDecoder().decode(replace(FRAME, payload=packet.data))
    assert decoded is not None
    assert decoded.shape == (HEIGHT, WIDTH, 3)


@needs_av
@pytest.mark.parametrize("codec", [Codec.H264, Codec.VP9])
def test_the_frames_by_which_the_page_tries_decoders_show_the_pattern(codec: Codec) -> None:
    data = trial_frames.key_frame(codec)
    side = trial_frames.SIDE
    decoded = VideoDecoder().decode(replace(FRAME, codec=codec, payload=data, width=side, height=side))
    assert decoded is not None
    assert np.abs(decoded.astype(int) - trial_frames.pattern()).max() <= 5  # 3 measured


def test_without_pyav_nothing_is_offered_and_an_encoder_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "av" else find(name))
    monkeypatch.setitem(sys.modules, "av", None)
    video_codecs.cache_clear()
    try:
        assert video_codecs() == ()
        with pytest.raises(VideoError, match="96 x 64"):
            VideoEncoder(Codec.H264, WIDTH, HEIGHT, crf=20)
    finally:
        video_codecs.cache_clear()


def test_colours_are_converted_by_the_standard_to_the_nearest_level() -> None:
    rgb = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    red, green, blue = (rgb[..., channel].astype(float) for channel in range(3))
    luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue  # BT.709, and its colour differences
    wanted = [luma, (blue - luma) / 1.8556 + 128, (red - luma) / 1.5748 + 128]
    found = luma_and_chroma(rgb).astype(float)
    assert np.abs(found - np.minimum(wanted, 255)).max() < 0.51

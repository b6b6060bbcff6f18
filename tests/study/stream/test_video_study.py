"""What a study of video says of its rows."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from culet.study.stream.video_study import Row, VideoStudy, at, described

ROW = Row("JPEG", 85, 100e3, 100e3, 3.0, 40.0, 0.03, 0.95)
HALF = replace(ROW, codec="H264", quality=20, bytes=40e3, psnr=41.0, flip=0.025, chroma_kept=0.90)
LESS = replace(HALF, quality=26, bytes=10e3, psnr=39.0, flip=0.035, chroma_kept=0.70)


def test_bytes_at_a_quality_lie_between_those_measured_in_proportion() -> None:
    assert at([HALF, LESS], "psnr", 40.0, "bytes") == pytest.approx(20e3), "half way in logarithms"
    assert at([HALF, LESS], "bytes", 20e3, "chroma_kept") == pytest.approx(0.8)


def test_nothing_is_said_beyond_what_was_measured() -> None:
    assert math.isnan(at([HALF, LESS], "psnr", 42.0, "bytes"))


def test_video_is_told_in_parts_of_the_bytes_that_frames_have_as_jpeg() -> None:
    rows = (ROW, replace(ROW, quality=30, bytes=20e3, chroma_kept=0.5), HALF, LESS)
    said = list(described(VideoStudy(1280, 720, 60, 0.02, rows)))
    assert "H264 at the PSNR of JPEG 85: 0.20 of its bytes" in said
    assert "H264 at the chroma of JPEG 85: cannot be told" in said
    assert "H264 at 35 kB a frame keeps 0.88 of the chroma" in said

"""Codecs on one frame whose likeness can be foretold."""

from __future__ import annotations

import numpy as np
import pytest

from culet.study.report import Point
from culet.study.stream.streaming import codecs, measure

RAMP = np.tile(np.arange(64, dtype=np.uint8)[None, :, None] * 3, (48, 1, 3))
NOISY = np.clip(RAMP + np.random.default_rng(2).integers(-40, 40, RAMP.shape), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def points() -> dict[str, Point]:
    return {codec.name: measure("still", codec, [NOISY], 1) for codec in codecs(quick=False)}


def figure(points: dict[str, Point], name: str, figure_: str) -> float:
    value = points[name].figures[figure_]
    assert value is not None
    return value


@pytest.mark.parametrize("name", ["PNG level 1", "PNG level 9", "TGA", "TGA, run lengths"])
def test_lossless_codecs_lose_nothing(points: dict[str, Point], name: str) -> None:
    assert figure(points, name, "ssim") == 1
    assert figure(points, name, "delta_e") == 0


def test_higher_quality_costs_bytes_and_is_more_alike(points: dict[str, Point]) -> None:
    ladder = [f"JPEG {quality} 4:4:4" for quality in (50, 70, 85, 97)]
    for name in ("bytes", "ssim"):
        values = [figure(points, each, name) for each in ladder]
        assert values == sorted(values)
        assert values[0] < values[-1]
    likeness, error = (figure(points, ladder[0], name) for name in ("ssim", "dissimilarity"))
    assert error == pytest.approx(1 - likeness)


def test_halved_chroma_saves_bytes_and_costs_colour(points: dict[str, Point]) -> None:
    assert figure(points, "JPEG 92 4:2:0", "bytes") < figure(points, "JPEG 92 4:4:4", "bytes")
    assert figure(points, "JPEG 92 4:2:0", "delta_e") > figure(points, "JPEG 92 4:4:4", "delta_e")


def test_a_plain_tga_has_three_bytes_a_pixel(points: dict[str, Point]) -> None:
    assert figure(points, "TGA", "bytes") == NOISY.size + 18 + 26  # header, and the footer of TGA 2.0

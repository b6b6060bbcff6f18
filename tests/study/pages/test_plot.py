"""Log-log plots, read back from their SVG."""

from __future__ import annotations

import re
from xml.etree import ElementTree as ET

import pytest

from culet.study.pages.plot import Mark, Series, log_log


def circles(svg: str) -> list[tuple[float, float]]:
    """The marks, without the legend's at the right."""
    places = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"[^>]*><title>', svg)
    return [(float(x), float(y)) for x, y in places]


def test_equal_factors_are_equal_distances() -> None:
    marks = [Mark(x, 1 / x, f"{x}") for x in (1.0, 10.0, 100.0)]
    (x0, y0), (x1, y1), (x2, y2) = circles(log_log([Series("s", marks)], "x", "y"))
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.2)  # a place is written to a tenth
    assert y1 - y0 == pytest.approx(y2 - y1, abs=0.2)
    assert x0 < x1
    assert y0 < y1  # less is lower on the page


def test_it_is_well_formed_and_escapes_its_words() -> None:
    svg = log_log([Series("a < b & c", [Mark(1, 1, 'say "x" & <y>')])], "x & y", "<z>", [Mark(1, 1)])
    texts = [element.text for element in ET.fromstring(svg).iter() if element.text]  # noqa: S314 - our own
    assert "a < b & c" in texts
    assert "<z>" in texts


def test_marks_that_have_no_logarithm_are_left_out() -> None:
    svg = log_log([Series("s", [Mark(1, 1, "t"), Mark(0, 1, "t"), Mark(1, 0, "t")])], "x", "y")
    assert len(circles(svg)) == 1


def test_nothing_to_draw_is_said_in_words() -> None:
    assert log_log([Series("s", [Mark(1, 0)])], "x", "y").startswith("<p>")


def test_one_point_has_a_frame_around_it() -> None:
    ((x, y),) = circles(log_log([Series("s", [Mark(3e-5, 7, "t")])], "x", "y"))
    assert 74 < x < 620
    assert 14 < y < 418


def test_the_frontier_is_numbered_from_left_to_right() -> None:
    svg = log_log([Series("s", [])], "x", "y", [Mark(1, 3), Mark(2, 1)])
    assert re.findall(r'class="number">(\d)</text>', svg) == ["1", "2"]

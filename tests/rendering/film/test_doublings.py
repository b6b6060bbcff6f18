"""What doublings of a picture's samples let expect, and which samples are shown meanwhile."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.rendering.film.doublings import RATE, Doublings
from culet.rendering.film.sums import Sums
from culet.rendering.renderer import Renderer


def doubled(*of_one: float) -> Doublings:
    """Two, four, eight ... samples, of which each doubling says that a single one is off by so much."""
    doublings = Doublings()
    for number, error in enumerate(of_one, 1):
        apart = 2 * error / (2**number) ** RATE  # half of which is the error of all
        doublings.add(2**number, 30 * apart**2, components=30)
    return doublings


def test_the_last_two_doublings_count_alike() -> None:
    assert doubled(1).error(1) == pytest.approx(1)
    assert doubled(1, 3).error(1) == pytest.approx(math.sqrt((1 + 9) / 2))
    assert doubled(50, 1, 3).error(1) == pytest.approx(math.sqrt((1 + 9) / 2))


def test_what_is_put_aside_is_shown_until_there_are_as_many_others(renderer: Renderer) -> None:
    sums = Sums(renderer.fold, renderer.allocate, 4, 3, np.float32)
    for shown in (0, 0, 0):
        sums.target()
        for _ in sums.added():
            pass
        assert sums.samples_aside == shown
    for _ in sums.put_aside():
        pass
    for shown in (3, 3, 0):
        sums.target()
        for _ in sums.added():
            pass
        assert sums.samples_aside == shown
    assert sums.aside is None

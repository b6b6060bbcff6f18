"""The study of growth: powers are fitted to what is measured, and every sweep runs."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from culet.study.pages.page import page
from culet.study.report import Point, Report
from culet.study.serving import growth
from culet.study.serving.growth import (
    GrowthEffort,
    GrowthSweep,
    beside_each_other,
    fits_of,
    steeper_than_they_should_be,
)
from culet.study.studies import study_growth

LOAD_SECONDS = 1.0
"""Some frames of a turning camera: the system tells a process's time in hundredths of a second."""
TINY = GrowthEffort(
    {name: GrowthSweep((1, 2), sweep.most) for name, sweep in growth.FULL.sweeps.items()}, 18, 1, 0.2, LOAD_SECONDS
)
TINY.sweeps.update(
    {
        "pixels": GrowthSweep((144, 576), 1),
        "facets": GrowthSweep((16, 32), 1),
        "bands": GrowthSweep((3, 6), 1),
        "bounces": GrowthSweep((1, 8), 1),
    }
)


@contextlib.contextmanager
def untold(stage: str, steps: int) -> Iterator[Callable[[str, int], None]]:
    yield lambda label, done: None


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Report:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(growth, "QUICK", TINY)
        patched.setattr("culet.study.serving.crowd.SETTLE_SECONDS", 0.3)
        return study_growth(tmp_path_factory.mktemp("growth"), untold, quick=True)


def test_every_sweep_is_measured_and_fitted(finished: Report) -> None:
    assert [fit.label for fit in finished.fits] == list(growth.FULL.sweeps)
    for point in finished.points:
        cost = point.figures["processor_seconds"]
        assert cost is not None, point.key
        assert cost > 0, point.key


def test_more_is_more(finished: Report) -> None:
    """What is swept reaches the renderer: segments do not depend on the machine's speed."""
    for name in ("pixels", "bands", "bounces"):
        few, many = (point.figures["segments"] or 0 for point in finished.points if point.group == name)
        assert many > 1.5 * few > 0, name


def test_frames_come_to_every_viewer(finished: Report) -> None:
    for point in finished.points:
        if point.group in ("sessions", "viewers"):
            assert (point.figures["frames_per_second"] or 0) > 0, point.key


def test_a_power_is_found_in_the_larger_half_and_judged() -> None:
    extent = GrowthEffort({"stones": GrowthSweep((1, 2, 4, 8), 1.05)}, 18, 1, 1, 1)
    costs = {1: 2.7, 2: 2**1.5, 4: 4**1.5, 8: 8**1.5}
    points = [
        Point(key=f"stones={n}", group="stones", label=str(n), knobs={"stones": n}, figures={"processor_seconds": cost})
        for n, cost in costs.items()
    ]
    (fit,) = fits_of(points, extent)
    assert fit.order == pytest.approx(1.5)
    (words,) = steeper_than_they_should_be([fit], extent)
    assert words == "stones: cost grows as the number to the 1.50, expected at most 1.05"
    assert not list(steeper_than_they_should_be([fit], extent._replace(sweeps={"stones": GrowthSweep((1,), 1.8)})))


@pytest.mark.parametrize("number", [1, 2, 12, 64])
def test_stones_side_by_side_cover_what_one_does_and_do_not_touch(number: int) -> None:
    stones = beside_each_other(number).stones
    assert sum(stone.scale**2 for stone in stones) == pytest.approx(1)
    places = {stone.position for stone in stones}
    assert len(places) == number
    for one in stones:
        for other in stones:
            if one is not other:
                apart = sum((a - b) ** 2 for a, b in zip(one.position, other.position, strict=True)) ** 0.5
                assert apart >= one.scale + other.scale - 1e-9


def test_the_report_draws_each_sweep(finished: Report, tmp_path: Path) -> None:
    shown = page(finished, tmp_path)
    assert shown.count("<svg") == len(growth.FULL.sweeps)

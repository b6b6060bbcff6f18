"""What the ladder's study makes of measured settings, on ones made by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest

from culet.engine.governing.governor import Setting
from culet.engine.governing.measured_errors import SettingErrors
from culet.study.serving.ladder import (
    BOUNCES,
    CLOSEST,
    CUTOFFS,
    LEAST_SCALE,
    SCALES,
    MeasuredSetting,
    errors_of,
    ladder_of,
    smoothed,
)


def error(scale: float, cutoff: float, bounces: int) -> float:
    """A smaller picture, a higher cut-off and fewer bounces each add to it, but full size has noise of its own."""
    return (1.1 - scale) / 20 + cutoff / 10 + 0.1 / bounces + (0.02 if scale == 1 else 0)


MEASURED = [
    MeasuredSetting(
        Setting(scale, cutoff, bounces, scale**2 * (0.01 / cutoff) ** 0.5 * (bounces / 256) ** 0.2, shown), 2 * shown
    )
    for scale, cutoff, bounces in product(SCALES, CUTOFFS, BOUNCES)
    for shown in [error(scale, cutoff, bounces)]
]


def test_the_ladder_is_the_best_setting_and_the_frontier_of_the_cheaper_ones() -> None:
    best, *others = ladder_of(MEASURED)
    assert (best.scale, best.cutoff, best.max_bounces, best.cost) == (1.0, 0.01, 256, 1.0)
    assert best.error > others[0].error, "its noise"
    assert all(after.cost < before.cost and after.error > before.error for before, after in pairwise(others))
    assert len(others) > 5


def test_the_cheapest_setting_of_each_range_of_sizes_is_a_rung_however_close_it_is() -> None:
    """A slow machine has nothing below it. Others that cost as much as the one above them are not."""

    def cost(setting: Setting) -> float:
        """Of 16 reflections it is 0.996 of 24's."""
        return setting.scale**2 * math.sqrt(0.01 / setting.cutoff) * math.pow(setting.max_bounces / 256, 0.01)

    measured = [replace(each, setting=replace(each.setting, cost=cost(each.setting))) for each in MEASURED]
    rungs = ladder_of(measured)
    costs = {each.setting.max_bounces: each.setting.cost for each in measured[-len(BOUNCES) :]}
    assert costs[16] > CLOSEST * costs[24]
    smallest = min(rungs, key=lambda rung: rung.cost)
    assert (smallest.scale, smallest.cutoff, smallest.max_bounces) == (min(SCALES), max(CUTOFFS), min(BOUNCES))
    assert (LEAST_SCALE, max(CUTOFFS), min(BOUNCES)) in {(r.scale, r.cutoff, r.max_bounces) for r in rungs}
    close = [after for before, after in pairwise(rungs) if after.cost > CLOSEST * before.cost]
    assert {rung.max_bounces for rung in close} == {min(BOUNCES)}
    assert len(close) == 2


def test_the_engine_reads_the_errors_as_they_were_measured() -> None:
    written = errors_of(MEASURED)
    shown, radiance = np.array(written.pop("shown")), np.array(written.pop("radiance"))
    read = SettingErrors(shown_errors=shown, radiance_errors=radiance, **written)
    for each in MEASURED:
        place = each.setting.scale, each.setting.cutoff, each.setting.max_bounces
        assert read.shown(*place) == round(each.setting.error, 4)
        assert read.radiance(*place) == round(each.radiance_error, 4)


def test_a_time_s_noise_is_smoothed_by_what_other_sizes_took() -> None:
    chance = np.random.default_rng(1)
    settings = list(product(SCALES, CUTOFFS, BOUNCES))
    true = [scale**1.9 * (0.01 / cutoff) ** 0.2 * (bounces / 256) ** 0.1 for scale, cutoff, bounces in settings]
    exact = smoothed(settings, true)
    assert exact == pytest.approx(true, rel=1e-9)
    noisy = smoothed(
        settings, [seconds * factor for seconds, factor in zip(true, chance.lognormal(0, 0.05, len(true)), strict=True)]
    )
    assert max(abs(np.log(np.array(noisy) / true))) < 0.05

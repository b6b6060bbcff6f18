"""The fixed-step clock: every second is stepped once, whatever the frames, and a stall does not spiral."""

from __future__ import annotations

import math

import pytest

from culet.errors import InputError
from culet.simulation.clock import (
    LEAST_WORK,
    MAX_CATCH_UP,
    MOST_WORK,
    SHARED_WORK,
    WORK_SHARE,
    Allowance,
    FixedStepClock,
    Pace,
)


@pytest.mark.parametrize("frames_per_second", [7, 24, 30, 59.94, 144, 1000])
def test_ten_seconds_are_three_hundred_steps_at_any_frame_rate(frames_per_second: float) -> None:
    clock = FixedStepClock(1 / 30)
    frames = round(10 * frames_per_second)
    steps = sum(clock.advance(1 / frames_per_second) for _ in range(frames))
    due = frames / frames_per_second * 30
    assert steps + clock.fraction == pytest.approx(due, abs=1e-9)  # nothing lost: measured 4e-12
    assert clock.dropped == 0


def test_the_fraction_is_what_is_left_of_a_step() -> None:
    clock = FixedStepClock(0.125)
    assert clock.advance(0.0625) == 0
    assert clock.fraction == 0.5
    assert clock.advance(0.09375) == 1
    assert clock.fraction == 0.25
    assert clock.advance(0) == 0
    assert clock.fraction == 0.25


def test_the_fraction_stays_between_zero_and_one() -> None:
    clock = FixedStepClock(1 / 30)
    for index in range(10_000):
        clock.advance((index % 17) * 0.0007)
        assert 0 <= clock.fraction <= 1


def test_after_a_stall_at_most_a_quarter_second_is_caught_up_and_the_rest_is_counted_as_dropped() -> None:
    clock = FixedStepClock(1 / 64)
    clock.advance(1 / 128)
    assert clock.advance(3600.0) == MAX_CATCH_UP * 64
    assert clock.dropped == 3600 - MAX_CATCH_UP
    assert clock.fraction == 0.5


def test_frames_slower_than_the_limit_never_owe_more_steps() -> None:
    clock = FixedStepClock(1 / 64)
    assert [clock.advance(1.0) for _ in range(5)] == [16] * 5


def test_the_longest_step_still_advances() -> None:
    clock = FixedStepClock(0.25)
    assert [clock.advance(0.125) for _ in range(4)] == [0, 1, 0, 1]


def test_a_restart_forgets_what_was_put_by() -> None:
    clock = FixedStepClock(0.5)
    clock.advance(0.25)
    clock.restart()
    assert clock.fraction == 0
    assert clock.advance(0.25) == 0


@pytest.mark.parametrize("elapsed", [-0.001, math.nan, math.inf])
def test_time_that_does_not_pass_forward_is_refused(elapsed: float) -> None:
    with pytest.raises(InputError, match="forward"):
        FixedStepClock(0.1).advance(elapsed)


@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan, math.inf])
def test_a_step_that_is_no_time_is_refused(time_step: float) -> None:
    with pytest.raises(InputError, match="positive"):
        FixedStepClock(time_step)


def test_steps_given_up_are_counted_as_dropped() -> None:
    clock = FixedStepClock(0.125)
    clock.advance(0.25)
    clock.drop(2)
    assert clock.dropped == 0.25


def test_an_allowance_is_overdrawn_by_one_step_at_most_and_paid_back_by_time() -> None:
    allowance = Allowance()
    spent = [allowance.spent]
    for change, seconds in (
        (allowance.spend, MOST_WORK + 1.0),
        (allowance.grow, 0.99 / WORK_SHARE),
        (allowance.grow, 0.02 / WORK_SHARE),
        (allowance.grow, 3600.0),
        (allowance.spend, MOST_WORK),  # there is never more
    ):
        change(seconds)
        spent.append(allowance.spent)
    assert spent == [False, True, True, False, False, True]


def test_beside_others_steps_may_take_a_part_of_their_share() -> None:
    allowance, step, taken = Allowance(), 0.0005, 0.0
    for _ in range(600):
        allowance.grow(1 / 6, share=1 / 20)
        while not allowance.spent:
            allowance.spend(step)
            taken += step
    assert taken / 100 == pytest.approx(SHARED_WORK / 20, rel=0.1)


def test_the_fewer_share_the_time_the_more_steps_may_come_in_a_row() -> None:
    allowance = Allowance()
    allowance.grow(1.0, share=1 / 20)
    allowance.spend(LEAST_WORK * MOST_WORK)
    assert allowance.spent


def test_the_pace_tells_what_part_of_real_time_a_simulation_keeps() -> None:
    pace, dropped = Pace(), 0.0
    slow = [pace.slow]
    for _ in range(600):
        dropped += 0.06
        pace.passed(0.1, dropped)
    assert pace.lately == pytest.approx(0.4)
    slow.append(pace.slow)
    assert (pace.seconds, pace.dropped) == pytest.approx((60, 36))
    for _ in range(100):
        pace.passed(0.1, dropped)
    slow.append(pace.slow)
    assert slow == [False, True, False]


def test_a_new_clock_has_dropped_nothing_that_was_counted_before() -> None:
    pace = Pace()
    pace.passed(1.0, 0.5)
    pace.passed(1.0, 0.25)
    assert pace.dropped == 0.75

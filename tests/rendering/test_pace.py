"""How many steps a launch gets, from how long those before it took."""

import math

import pytest

from culet.rendering.pace import FIRST_STEP, LAUNCH, LEAST_STEPS, MOST_STEPS, KernelPace


def launched(pace: KernelPace, step: float, times: int) -> float:
    """Seconds of the last of some launches of 25 ms each, of steps that take so long."""
    seconds = math.nan
    for _ in range(times):
        steps = pace.steps(0.025)
        seconds = LAUNCH + steps * step
        pace.made(steps, seconds)
    return seconds


def test_the_first_launch_is_too_short_rather_than_too_long() -> None:
    assert KernelPace().steps(0.025) == int(0.025 / FIRST_STEP)


@pytest.mark.parametrize("step", [1e-7, 1e-6, 1e-4])
def test_launches_take_their_time_after_the_first(step: float) -> None:
    assert launched(KernelPace(), step, 2) == pytest.approx(0.025, rel=0.1)


def test_a_dearer_part_of_the_picture_makes_one_launch_long_and_no_second() -> None:
    pace = KernelPace()
    launched(pace, 1e-6, 5)
    assert launched(pace, 1e-5, 1) > 0.2
    assert launched(pace, 1e-5, 1) == pytest.approx(0.025, rel=0.1)


def test_a_cheaper_part_makes_launches_longer_by_and_by() -> None:
    pace = KernelPace()
    launched(pace, 1e-5, 5)
    assert launched(pace, 1e-6, 2) < 0.01
    assert launched(pace, 1e-6, 20) == pytest.approx(0.025, rel=0.2)


def test_a_launch_is_never_so_short_that_it_costs_more_than_its_steps() -> None:
    pace = KernelPace()
    pace.made(1, 10.0)
    assert pace.steps(0.025) == LEAST_STEPS
    assert pace.steps(math.inf) == MOST_STEPS


def test_launches_of_no_steps_say_nothing() -> None:
    pace = KernelPace()
    pace.made(0, 1.0)
    assert pace.steps(0.025) == int(0.025 / FIRST_STEP)

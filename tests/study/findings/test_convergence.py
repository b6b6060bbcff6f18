"""Orders and times from curves whose orders and times are known."""

from __future__ import annotations

import pytest

from culet.study.findings.convergence import COARSE, ROUNDING, fit_order, resting_error, time_to

STEPS = [0.1, 0.05, 0.025, 0.0125]


@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_power_law_has_its_exponent_as_order(order: int) -> None:
    fit = fit_order(STEPS, [0.3 * step**order for step in STEPS])
    assert fit is not None
    assert fit.order == pytest.approx(order, abs=1e-12)
    assert fit.points == 4


def test_errors_at_rounding_and_errors_of_steps_too_long_do_not_count() -> None:
    errors = [2 * COARSE, 1e-4, 1e-4 / 4, ROUNDING / 10]
    fit = fit_order(STEPS, errors)
    assert fit is not None
    assert fit.order == pytest.approx(2, abs=1e-12)
    assert fit.points == 2


def test_one_usable_error_has_no_order() -> None:
    assert fit_order(STEPS, [1.0, 0.1, 0.0, 0.0]) is None


def test_a_target_between_two_points_is_reached_along_a_power_law() -> None:
    # error = 1 / sqrt(t): 0.5 is reached at 4 s
    assert time_to([1, 16], [1, 0.25], 0.5).seconds == pytest.approx(4)


def test_a_target_beyond_the_last_point_is_extrapolated_and_says_so() -> None:
    reached = time_to([1, 4], [1, 0.5], 0.1)
    assert reached.seconds == pytest.approx(100)
    assert reached.extrapolated


def test_a_target_that_the_first_point_has_takes_at_most_its_time() -> None:
    assert time_to([3, 4], [0.1, 0.05], 0.2) == (3, False)


def test_below_its_bias_nothing_is_reached() -> None:
    assert time_to([1, 2, 4], [0.3, 0.2, 0.2], 0.1, floor=0.2).seconds is None


def test_nothing_measured_reaches_nothing() -> None:
    assert time_to([], [], 0.1).seconds is None


def test_noise_that_still_falls_is_at_rest_nowhere() -> None:
    assert resting_error([1, 2, 4, 5], [1, 2**-0.5, 0.5, 5**-0.5]) is None  # however near the last two points are


def test_a_bias_is_where_the_error_comes_to_rest() -> None:
    assert resting_error([1, 2, 4], [0.3, 0.21, 0.2]) == 0.2

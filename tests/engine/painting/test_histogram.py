import pytest

from culet.engine.painting.histogram import BOUNDS, Histogram


def test_a_duration_is_counted_up_to_and_with_its_bound() -> None:
    histogram = Histogram()
    for seconds in (0.0, 0.001, 0.0011, 0.05, 11.0):
        histogram.add(seconds)
    shown = histogram.as_json()
    by_bound = dict(zip([*BOUNDS, None], shown["counts"], strict=True))
    assert {bound: count for bound, count in by_bound.items() if count} == {0.001: 2, 0.0025: 1, 0.05: 1, None: 1}
    assert histogram.count == 5
    assert (shown["sum"], shown["longest"]) == (pytest.approx(11.0521), 11.0)

"""The credit rule, with a clock that the test sets."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as some

from culet.gateway.credit import FULL_RATE, HEADROOM, LEAST_RATE, STALLED_SECONDS, WINDOW, Credit


def test_a_window_of_frames_goes_out_and_then_none_until_one_is_acknowledged() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        assert credit.available(0)
        credit.take(sequence, 0)
    assert not credit.available(1)
    credit.acknowledge(0, 1)
    assert credit.available(1)


def test_an_acknowledgement_covers_the_frames_sent_before() -> None:
    credit = Credit()
    credit.take(7, 0)
    credit.take(9, 0)
    credit.acknowledge(9, 0.1)
    for sequence in range(WINDOW):
        assert credit.available(1)
        credit.take(sequence, 1)


def test_an_acknowledgement_of_what_was_never_sent_gives_nothing() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 0)
    credit.acknowledge(1000, 0.1)
    assert not credit.available(0.1)


def test_time_gives_no_credit() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 0)
    assert not credit.available(86400)


steps = some.lists(
    some.tuples(some.sampled_from(["offer", "acknowledge", "acknowledge twice", "lie"]), some.floats(0, 60)),
    max_size=200,
)


@given(steps)
def test_whatever_is_said_in_whatever_order_no_more_than_the_window_is_in_flight(
    steps: list[tuple[str, float]],
) -> None:
    credit, now, sequence = Credit(), 0.0, 0
    in_flight: list[int] = []
    for step, pause in steps:
        now += pause
        match step:
            case "offer":
                assert credit.available(now) == (len(in_flight) < WINDOW)
                if credit.available(now):
                    sequence += 1
                    credit.take(sequence, now)
                    in_flight.append(sequence)
            case "lie":
                credit.acknowledge(sequence + 7, now)
            case _:
                for _ in range(2 if step == "acknowledge twice" else 1):
                    if in_flight:
                        credit.acknowledge(in_flight[0], now)
                if in_flight:
                    in_flight.pop(0)
        assert 0 <= credit.rate(now) <= FULL_RATE
    for left in in_flight:
        credit.acknowledge(left, now)
    assert credit.available(now), "all that was sent is acknowledged"


def test_on_a_slow_link_the_delay_of_a_frame_is_that_of_the_window_and_does_not_grow() -> None:
    bytes_per_second, size = 30_000.0, 40_000
    credit, free_at, delays, now = Credit(), 0.0, [], 0.0
    coming: list[tuple[int, float, float]] = []  # number, when it went out, when all of it has arrived
    for sequence in range(3600):  # a minute of 60 frames a second
        now = sequence / 60
        while coming and coming[0][2] <= now:
            number, left, arrived = coming.pop(0)
            credit.acknowledge(number, arrived)
            delays.append(arrived - left)
        if credit.available(now):
            credit.take(sequence, now)
            free_at = max(free_at, now) + size / bytes_per_second
            coming.append((sequence, now, free_at))
    assert len(delays) > 40, "the link is used to the full"
    assert max(delays) <= WINDOW * size / bytes_per_second + 1 / 60


def test_the_rate_is_full_until_credit_is_short_and_then_a_little_more_than_what_was_taken() -> None:
    credit = Credit()
    assert credit.rate(0) == FULL_RATE
    for sequence in range(10):  # 10 frames a second, each acknowledged when the next is already refused
        now = sequence / 10
        credit.take(2 * sequence, now)
        credit.take(2 * sequence + 1, now)
        assert not credit.available(now)
        credit.acknowledge(2 * sequence + 1, now + 0.05)
    assert credit.rate(1) == 10 * HEADROOM
    assert credit.rate(3) == FULL_RATE, "not short of credit for over a second"


def test_a_viewer_that_never_acknowledges_is_offered_one_frame_a_second_and_after_a_while_none() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 0)
    assert not credit.available(1.5)
    assert credit.rate(1.5) == LEAST_RATE
    assert not credit.stalled(STALLED_SECONDS - 0.1)
    assert credit.stalled(STALLED_SECONDS)
    assert credit.rate(STALLED_SECONDS) == 0
    credit.acknowledge(WINDOW - 1, STALLED_SECONDS)
    assert credit.rate(STALLED_SECONDS) > 0

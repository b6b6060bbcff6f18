"""The credit rule, with a clock that the test sets."""

from __future__ import annotations

from culet.gateway.credit import FULL_RATE, HEADROOM, IN_FLIGHT_SECONDS, WINDOW, Credit


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
    assert credit.returns_at() is None


def test_an_acknowledgement_of_what_was_never_sent_gives_nothing() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 0)
    credit.acknowledge(1000, 0.1)
    assert not credit.available(0.1)


def test_a_lost_acknowledgement_costs_time_and_not_the_stream() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 5)
    assert credit.returns_at() == 5 + IN_FLIGHT_SECONDS
    assert not credit.available(5 + IN_FLIGHT_SECONDS - 0.01)
    assert credit.available(5 + IN_FLIGHT_SECONDS)


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


def test_a_viewer_that_never_acknowledges_is_offered_one_frame_a_second() -> None:
    credit = Credit()
    for sequence in range(WINDOW):
        credit.take(sequence, 0)
    assert not credit.available(1.5)
    assert credit.rate(1.5) == 1

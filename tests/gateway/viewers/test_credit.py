"""The credit rule, on links and with a clock that the tests make."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from culet.gateway.viewers.credit import (
    FIRST_BYTES,
    FULL_RATE,
    LARGEST_WINDOW,
    LEAST_RATE,
    REST_SECONDS,
    STALLED_SECONDS,
    Credit,
)
from gateway.simulated_link import ASKED, SimulatedLink

SIZE = 10_000
MEGABIT = 125_000.0
"""Bytes."""


def test_one_frame_goes_out_and_then_none_until_it_is_acknowledged() -> None:
    credit = Credit()
    assert credit.available(SIZE, 0)
    credit.take(1, SIZE, 0)
    assert not credit.available(SIZE, 1)
    credit.acknowledge(1, 1)
    assert credit.available(SIZE, 1)


def test_an_acknowledgement_covers_the_frames_sent_before() -> None:
    credit = Credit()
    credit.take(7, SIZE, 0)
    credit.take(9, SIZE, 0)
    credit.acknowledge(9, 0.1)
    assert not credit.stalled(STALLED_SECONDS + 1)
    assert credit.available(SIZE, 0.1)


def test_an_acknowledgement_of_what_was_never_sent_gives_nothing() -> None:
    credit = Credit()
    credit.take(1, SIZE, 0)
    credit.acknowledge(1000, 0.1)
    assert not credit.available(SIZE, 0.1)


def test_the_window_grows_once_for_a_frame_that_had_to_wait_and_not_without_one() -> None:
    credit, windows = Credit(), []
    for number, waits in enumerate([True, False, False]):
        credit.take(number, SIZE, number)
        assert not waits or not credit.available(SIZE, number)
        credit.acknowledge(number, number + 0.01)
        windows.append(credit.window)
    assert windows == [2, 2, 2]


def test_time_gives_no_credit() -> None:
    credit = Credit()
    credit.take(1, SIZE, 0)
    assert not credit.available(SIZE, 86400)


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
                if credit.available(SIZE, now):
                    sequence += 1
                    credit.take(sequence, SIZE, now)
                    in_flight.append(sequence)
                assert 0 < len(in_flight) <= LARGEST_WINDOW
            case "lie":
                credit.acknowledge(sequence + 7, now)
            case _:
                for _ in range(2 if step == "acknowledge twice" else 1):
                    if in_flight:
                        credit.acknowledge(in_flight[0], now)
                if in_flight:
                    in_flight.pop(0)
        assert 0 <= credit.rate(now) <= FULL_RATE
        assert credit.bytes_per_frame(FULL_RATE, now) >= 1
        assert credit.bytes_at_rest(now) >= 1
    for left in in_flight:
        credit.acknowledge(left, now)
    assert credit.available(SIZE, now), "all that was sent is acknowledged"


links = some.tuples(
    some.sampled_from([0.24, 0.5, 2.0, 5.0, 20.0, 100.0]),  # megabits a second
    some.sampled_from([0.002, 0.04, 0.15, 0.3]),  # s, there and back
    some.sampled_from([8.0, 15.0, 30.0]),  # frames a second that can be made
    some.integers(0, 1000),
)


@settings(max_examples=25)
@given(links)
def test_on_any_link_the_queue_stays_short_and_the_last_frame_is_shown(link: tuple[float, float, float, int]) -> None:
    megabits, round_trip, made, seed = link
    simulated = SimulatedLink(lambda _: megabits * MEGABIT, round_trip, made=made, random=random.Random(seed))  # noqa: S311
    simulated.run(12)  # of the slowest link the first frame alone takes two seconds
    longest = max(frame.queued for frame in simulated.since(6))
    largest = max(frame.size for frame in simulated.since(6)) / (megabits * MEGABIT)
    # Two frames, and what is in flight when a rate that is tried proves too high: of 576 links at most 0.07 s more.
    assert longest <= 2 * largest + 0.2
    simulated.run(3, engine=False)
    assert simulated.shown[-1].number == simulated.made_last


@pytest.mark.parametrize(
    ("megabits", "round_trip", "least_rate", "most_latency"),
    [
        (2, 0.15, 15, 0.4),  # measured 22.6 frames/s, 0.23 s
        (20, 0.04, 29, 0.1),  # measured 30.0 frames/s, 0.06 s
        (0.24, 0.1, 5, 0.6),  # measured 7.3 frames/s, 0.41 s; frames of 4 kB cannot come faster than 7.5 times a second
        (5, 0.3, 20, 0.4),  # measured 27.8 frames/s, 0.26 s
    ],
)
def test_a_link_is_used_and_frames_are_fresh(
    megabits: float, round_trip: float, least_rate: float, most_latency: float
) -> None:
    simulated = SimulatedLink(lambda _: megabits * MEGABIT, round_trip)
    simulated.run(12)
    late = sorted(frame.latency for frame in simulated.since(3))
    assert len(late) / 9 >= least_rate
    assert late[int(0.95 * len(late))] <= most_latency


def test_a_slow_engine_gets_as_many_bytes_a_frame_as_the_link_has() -> None:
    """Frames with gaps between them look as if the link carried no more than they have."""
    simulated = SimulatedLink(lambda _: 20 * MEGABIT, 0.15, made=6)
    simulated.run(12)
    assert min(frame.size for frame in simulated.since(6)) > 0.85 * simulated.full


def test_a_link_that_changes_is_followed_within_three_seconds() -> None:
    simulated = SimulatedLink(lambda now: (2 if 8 <= now < 18 else 20) * MEGABIT, 0.04)
    simulated.run(28)
    slow = [frame for frame in simulated.since(11) if frame.at < 18]
    assert len(slow) / 7 >= 15  # measured 22
    assert max(frame.latency for frame in slow) <= 0.3  # measured 0.16 s
    assert max(frame.latency for frame in simulated.shown) <= 1.5  # measured 0.54 s, of what was in flight
    fast = simulated.since(21)
    assert len(fast) / 7 >= 29
    assert sum(frame.size for frame in fast) / len(fast) >= 0.95 * simulated.full


def test_a_route_that_becomes_longer_is_not_taken_for_a_queue_for_long() -> None:
    simulated = SimulatedLink(lambda _: 20 * MEGABIT, 0.04)
    simulated.run(5)
    simulated.round_trip = 0.3
    simulated.run(10)
    assert len(simulated.since(8)) / 7 >= 25  # measured 30
    assert min(frame.size for frame in simulated.since(13)) > 0.8 * simulated.full


def test_a_viewer_of_whose_link_nothing_is_known_is_sent_little() -> None:
    credit = Credit()
    assert credit.bytes_per_frame(ASKED, 0) == credit.bytes_at_rest(0) == FIRST_BYTES
    credit.take(1, 30_000, 0)
    credit.acknowledge(1, 1.0)
    assert credit.bytes_per_frame(ASKED, 1) == 1000
    assert credit.bytes_at_rest(1) == 30_000 * REST_SECONDS


def test_an_acknowledgement_that_is_missing_says_that_the_link_has_become_slow() -> None:
    credit = Credit()
    for number in range(10):
        credit.take(number, 30_000, number)
        credit.acknowledge(number, number + 0.01)
    assert credit.bytes_per_frame(ASKED, 10) > 30_000
    credit.take(10, 30_000, 10)
    assert credit.bytes_per_frame(ASKED, 13.01) <= 30_000 / 3 / ASKED


def test_a_viewer_that_never_acknowledges_is_offered_one_frame_a_second_and_after_a_while_none() -> None:
    credit = Credit()
    credit.take(1, SIZE, 0)
    assert not credit.available(SIZE, 1.5)
    assert credit.rate(1.5) == LEAST_RATE
    assert not credit.stalled(STALLED_SECONDS - 0.1)
    assert credit.stalled(STALLED_SECONDS)
    assert credit.rate(STALLED_SECONDS) == 0
    credit.acknowledge(1, STALLED_SECONDS)
    assert credit.rate(STALLED_SECONDS) > 0

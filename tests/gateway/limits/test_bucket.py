"""What a bucket lets through, with a clock that the test sets."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as some

from culet.gateway.limits.bucket import BURST_SECONDS, FORGOTTEN_OVER, Bucket, ClientBuckets

RATE = 50.0
ROUNDING = 1e-6
"""Relative, of sums of up to 300 floats."""
asked = some.lists(some.tuples(some.floats(0, 65), some.floats(0, 3)), max_size=300)
"""Costs, and the seconds before each."""


@given(asked)
def test_in_any_span_of_time_no_more_is_let_through_than_the_rate_a_burst_and_one_request(
    asked: list[tuple[float, float]],
) -> None:
    bucket, now = Bucket(RATE), 0.0
    let_through: list[tuple[float, float]] = []
    for cost, pause in asked:
        now += pause
        if bucket.overdrawn_for(now) == 0:
            bucket.spend(cost, now)
            let_through.append((now, cost))
    for first, (began, _) in enumerate(let_through):
        spent = 0.0
        for at, cost in let_through[first:]:
            assert spent <= (RATE * (at - began + BURST_SECONDS)) * (1 + ROUNDING) + ROUNDING, "before the last one"
            spent += cost


@given(asked)
def test_who_waits_as_long_as_told_gets_through_and_waits_no_longer_than_the_cost_before(
    asked: list[tuple[float, float]],
) -> None:
    bucket, now = Bucket(RATE), 0.0
    for cost, pause in asked:
        now += pause
        wait = bucket.overdrawn_for(now)
        assert wait <= 65 / RATE + ROUNDING
        now = math.nextafter(now + wait, math.inf)
        assert bucket.overdrawn_for(now) <= ROUNDING
        bucket.spend(cost, now)


def test_who_keeps_to_the_rate_never_waits() -> None:
    bucket = Bucket(RATE)
    for number in range(10_000):
        assert bucket.overdrawn_for(number / RATE) == 0
        bucket.spend(1, number / RATE)


def test_a_full_bucket_holds_a_burst() -> None:
    bucket = Bucket(RATE)
    through = 0
    while bucket.overdrawn_for(1000) == 0:
        bucket.spend(1, 1000)
        through += 1
    assert through == pytest.approx(RATE * BURST_SECONDS, abs=1)


def test_each_client_has_a_bucket_of_its_own() -> None:
    clients = ClientBuckets(RATE)
    clients.of("203.0.113.9", 0).spend(1000, 0)
    assert clients.of("203.0.113.9", 0).overdrawn_for(0) > 0
    assert clients.of("203.0.113.10", 0).overdrawn_for(0) == 0


def test_a_million_clients_take_no_more_memory_than_some_thousand_and_who_owes_is_not_forgotten() -> None:
    """Though it was seen before all others."""
    clients, last = ClientBuckets(RATE), 3 * FORGOTTEN_OVER
    debtor = clients.of("debtor", 0)
    debtor.spend(2 * last * RATE, 0)
    for number in range(last):
        clients.of(str(number), number).spend(1, number)
        assert len(clients) <= FORGOTTEN_OVER + 2
    assert clients.of("debtor", last) is debtor
    assert debtor.overdrawn_for(last) > 0

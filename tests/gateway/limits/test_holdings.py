"""What each client holds at the moment, counted."""

from __future__ import annotations

import pytest

from culet.gateway.limits.holdings import Holdings


def test_each_client_is_counted_by_itself_and_all_together() -> None:
    holdings = Holdings()
    holdings.take("a", 5)
    holdings.take("b")
    holdings.take(None, 2)
    assert (holdings.of("a"), holdings.of("b"), holdings.of(None), holdings.of("c")) == (5, 1, 2, 0)
    assert holdings.total == 8
    holdings.give_back("a", 3)
    assert (holdings.of("a"), holdings.total) == (2, 5)


def test_what_is_held_for_a_while_is_given_back_whatever_happens() -> None:
    holdings = Holdings()

    def fail() -> None:
        with holdings.held("a", 3):
            assert holdings.of("a") == 3
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert holdings.of("a") == 0


def test_a_client_that_holds_nothing_is_forgotten() -> None:
    """Or the clients of a public server would be remembered for ever."""
    holdings = Holdings()
    for number in range(1000):
        with holdings.held(f"client {number}"):
            assert len(holdings) == 1
        assert holdings.of(f"client {number}") == 0
    assert len(holdings) == 0

"""Who gets the render thread's time: played with pieces of work of any length, no clock but the one that they move."""

from __future__ import annotations

import weakref

import pytest

from culet.engine.painting.shares import Account, Shares, share


class Thread:
    """Gives its time to whoever is next."""

    def __init__(self) -> None:
        self.now = 0.0
        self.shares = Shares()
        self.had: dict[Account, float] = {}

    def play(self, pieces: dict[Account, float], until: float) -> None:
        """All want as much as they can get, each in pieces of so many seconds."""
        while self.now < until:
            chosen = min(pieces, key=self.shares.start)
            self.now += pieces[chosen]
            self.shares.charge(chosen, pieces[chosen], self.now)
            self.had[chosen] = self.had.get(chosen, 0.0) + pieces[chosen]


def account(weight: float = 1.0) -> Account:
    return Account(object(), weight)


def test_time_is_shared_and_not_turns() -> None:
    thread, long, short = Thread(), account(), account()
    thread.play({long: 0.1, short: 0.001}, until=60)
    assert thread.had[short] == pytest.approx(30, rel=0.01)


def test_time_is_shared_by_weight() -> None:
    thread, heavy, light = Thread(), account(1.0), account(0.25)
    thread.play({heavy: 0.01, light: 0.02}, until=60)
    assert thread.had[heavy] / thread.had[light] == pytest.approx(4, rel=0.02)


def test_who_slept_is_next_but_has_saved_up_nothing() -> None:
    thread, busy, sleeper = Thread(), account(), account()
    thread.play({busy: 0.01}, until=100)
    assert thread.shares.start(sleeper) < thread.shares.start(busy)
    thread.had.clear()
    thread.play({busy: 0.01, sleeper: 0.01}, until=110)
    assert thread.had[sleeper] == pytest.approx(5, rel=0.01), "not the 10 that it did not use before"


def test_a_newcomer_does_not_catch_up_with_those_who_were_there() -> None:
    thread, first = Thread(), account()
    thread.play({first: 0.01}, until=50)
    newcomer = account()
    thread.had.clear()
    thread.play({first: 0.01, newcomer: 0.03}, until=60)
    assert thread.had[first] == pytest.approx(5, rel=0.02)


def use(account: Account, part: float, *, until: float = 10.0) -> Account:
    """It had that part of the time for long, in pieces of 10 ms."""
    for number in range(int(until * 100)):
        account.add(part / 100, (number + 1) / 100)
    return account


def test_who_is_alone_has_all_of_the_time() -> None:
    own = use(account(), 0.8)
    assert share(own, [own], 10.0) == 1
    assert share(own, [own, Account(own.owner, 0.25, used=0.5, used_at=10.0)], 10.0) == 1, "its own refinement"


def test_greedy_ones_have_equal_shares() -> None:
    accounts = [use(account(), 0.05) for _ in range(20)]
    assert share(accounts[0], accounts, 10.0) == pytest.approx(1 / 20, rel=0.01)


def test_what_modest_ones_leave_is_for_the_others() -> None:
    own, modest, greedy = use(account(), 0.45), use(account(), 0.1), use(account(), 0.45)
    assert share(own, [own, modest, greedy], 10.0) == pytest.approx(0.45, rel=0.02)
    assert share(own, [own, modest], 10.0) == pytest.approx(0.9, rel=0.02)


def test_who_has_gone_is_forgotten_within_seconds() -> None:
    own, gone = use(account(), 0.5), use(account(), 0.5)
    assert share(own, [own, gone], 10.0) == pytest.approx(0.5, rel=0.02)
    assert share(own, [own, gone], 14.0) == 1


def test_what_rests_counts_by_its_smaller_weight() -> None:
    own, resting = use(account(), 0.8), use(account(0.25), 0.2)
    assert share(own, [own, resting], 10.0) == pytest.approx(0.8, rel=0.02)


def test_who_has_paid_for_a_piece_is_forgotten_with_it() -> None:
    """An account leads to its session, which may be closed."""
    shares, own, other = Shares(), account(), account()
    own.payers = [(own, 0.5), (other, 0.5)]
    shares.charge(own, 1.0, 0.0)
    assert (own.ended, other.ended) == (0.5, 0.5)
    shares.charge(own, 1.0, 1.0)
    assert (own.ended, other.ended) == (1.5, 0.5), "each piece has payers of its own"
    gone = weakref.ref(other)
    del other
    assert gone() is None

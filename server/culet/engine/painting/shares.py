"""Shares of the render thread's time: whose work is next, and how much of the time an owner of work can count on.

Start-time fair queueing (P. Goyal, H. Vin and H. Cheng, SIGCOMM 1996): time goes by in units of service. A piece of
work starts where the last piece of its owner ended, or at the present if the present is later. So an owner saves up no
time by sleeping, and a new owner has nothing to catch up with. The earliest start is next.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

MEMORY_SECONDS = 0.5
"""Over which the use of the render thread is averaged: longer than the interval of a slow session's frames, and short
enough that a session which is left alone soon has all of the time."""
IDLE_USE = 1e-3
"""Part of the time below which somebody counts as idle."""


@dataclass(eq=False)
class Account:
    """Of one kind of work of one owner."""

    owner: object
    """Whoever competes with others, but never with itself: a session, or all stills."""
    weight: float = 1.0
    """Share of the time beside others that have 1."""
    ended: float = 0.0
    """When its last piece ended, in units of service."""
    used: float = 0.0
    """Part of the time that it had, averaged up to `used_at`."""
    used_at: float = -math.inf
    """s, steady clock."""
    payers: Sequence[tuple[Account, float]] = ()
    """Who pays for its next piece, and which part of it; by default itself."""

    def use(self, now: float) -> float:
        """Part of the time that it had lately, 0 to 1."""
        return self.used * math.exp(-max(0.0, now - self.used_at) / MEMORY_SECONDS)

    def add(self, seconds: float, now: float) -> None:
        """It had so many seconds, which end now."""
        self.used = self.use(now) + seconds / MEMORY_SECONDS
        self.used_at = now


class Shares:
    """Of the render thread."""

    def __init__(self) -> None:
        """Nobody has had anything."""
        self._present = 0.0
        """The start of the piece that was served last, in units of service."""

    def start(self, account: Account) -> float:
        """Where the next piece would start: the earliest goes first."""
        return max(self._present, account.ended)

    def is_due(self, account: Account) -> bool:
        """Whether it has had no more than others."""
        return account.ended <= self._present

    def charge(self, account: Account, seconds: float, now: float) -> None:
        """A piece was served that took so many seconds and ends now."""
        self._present = self.start(account)
        payers, account.payers = account.payers or ((account, 1.0),), ()  # which else hold pictures of closed sessions
        for payer, part in payers:
            payer.ended = self.start(payer) + part * seconds / payer.weight
            payer.add(part * seconds, now)


def share(account: Account, others: Iterable[Account], now: float) -> float:
    """The part of the time that an owner can have beside the others, 0 to 1: as much as each owner that wants more, and
    what is left by owners that want less (max-min fairness: D. Bertsekas and R. Gallager, Data Networks, 6.5)."""
    uses: dict[int, list[float]] = {}
    for other in others:
        if other.owner is not account.owner and (use := other.use(now)) > IDLE_USE:
            of_owner = uses.setdefault(id(other.owner), [0.0, 0.0])
            of_owner[0] += use
            of_owner[1] = max(of_owner[1], other.weight)
    left, weights = 1.0, account.weight + sum(weight for _, weight in uses.values())
    for use, weight in sorted(uses.values(), key=lambda of_owner: of_owner[0] / of_owner[1]):
        if use / weight >= left / weights:
            break
        left -= use
        weights -= weight
    return left * account.weight / weights

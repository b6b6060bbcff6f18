"""Steps are taken by the clock, each motion's one at a time, and a slow one keeps nobody else waiting."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import pytest

from culet.engine.session.stepper import Stepper
from shared import patience

PATIENCE = patience.PATIENCE


@pytest.fixture
def stepper() -> Iterator[Stepper]:
    stepper = Stepper(threads=2)
    yield stepper
    stepper.stop()


class Counted:
    """Due again at once, so many times."""

    def __init__(self, runs: int) -> None:
        self.left, self.done = runs, threading.Event()

    def run(self, now: float) -> float | None:
        self.left -= 1
        if self.left > 0:
            return now
        self.done.set()
        return None


class Blocked:
    """Takes until it is let go."""

    def __init__(self) -> None:
        self.begun, self.go, self.runs = threading.Event(), threading.Event(), 0

    def run(self, _now: float) -> float | None:
        self.runs += 1
        self.begun.set()
        self.go.wait(PATIENCE)
        return None


class Timed:
    """Due at those times."""

    def __init__(self, *due: float) -> None:
        self.due, self.seen, self.done = list(due), list[float](), threading.Event()

    def run(self, now: float) -> float | None:
        if self.seen or now >= self.due[0]:
            self.seen.append(now)
            self.due.pop(0)
        if self.due:
            return self.due[0]
        self.done.set()
        return None


def test_what_is_kept_going_runs_until_nothing_is_left_to_do(stepper: Stepper) -> None:
    several = [Counted(50) for _ in range(6)]
    for each in several:
        stepper.keep_going(each)
        stepper.keep_going(each)
    for each in several:
        assert each.done.wait(PATIENCE)


def test_a_step_is_taken_when_it_is_due_and_not_before(stepper: Stepper) -> None:
    begun = time.monotonic()
    later, sooner = Timed(begun + 0.2, begun + 0.3), Timed(begun + 0.1)
    stepper.keep_going(later)
    stepper.keep_going(sooner)
    for timed, due in ((later, (0.2, 0.3)), (sooner, (0.1,))):
        assert timed.done.wait(PATIENCE)
        assert all(seen - begun >= at for seen, at in zip(timed.seen, due, strict=True))


def test_a_step_that_takes_long_keeps_no_other_motion_waiting(stepper: Stepper) -> None:
    slow, quick = Blocked(), Counted(100)
    stepper.keep_going(slow)
    assert slow.begun.wait(PATIENCE)
    stepper.keep_going(quick)
    assert quick.done.wait(PATIENCE)
    slow.go.set()


def test_what_is_kept_going_while_it_runs_for_the_last_time_runs_again(stepper: Stepper) -> None:
    slow = Blocked()
    stepper.keep_going(slow)
    assert slow.begun.wait(PATIENCE)
    slow.begun.clear()
    stepper.keep_going(slow)
    slow.go.set()
    assert slow.begun.wait(PATIENCE)
    assert slow.runs == 2


def test_of_one_motion_never_two_runs_are_made_at_a_time(stepper: Stepper) -> None:
    """Though a thread is free, and the motion was to be kept going meanwhile."""
    slow, quick = Blocked(), Counted(100)
    stepper.keep_going(slow)
    assert slow.begun.wait(PATIENCE)
    stepper.keep_going(slow)
    stepper.keep_going(quick)  # by the thread that is free, after whatever was due before
    assert quick.done.wait(PATIENCE)
    assert slow.runs == 1
    slow.go.set()


def test_while_a_step_takes_long_what_was_put_off_before_is_run_when_it_is_due(stepper: Stepper) -> None:
    slow, later = Blocked(), Timed(time.monotonic() + 0.1)
    stepper.keep_going(later)
    stepper.keep_going(slow)
    assert slow.begun.wait(PATIENCE)
    assert later.done.wait(PATIENCE)
    slow.go.set()


def test_nothing_runs_after_the_end() -> None:
    stepper = Stepper(threads=2)
    first, late = Counted(1), Counted(1)
    stepper.keep_going(first)
    assert first.done.wait(PATIENCE)
    stepper.stop()
    stepper.keep_going(late)
    assert not late.done.wait(0.05)
    for thread in threading.enumerate():
        if thread.name.startswith("step-"):
            thread.join(PATIENCE)
            assert not thread.is_alive()

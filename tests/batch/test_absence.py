"""That no worker is there is told once, and ends work whose workers are its own."""

from __future__ import annotations

import pytest

from culet.batch.absence import END_AFTER, TELL_AFTER, Absence
from culet.errors import WorkersError


def test_workers_that_are_replaced_at_once_are_not_missed() -> None:
    absence = Absence("the scheduler at tls://a:1")
    looks = [(0.0, 2), (1.0, 0), (TELL_AFTER, 0), (TELL_AFTER + 0.5, 1), (TELL_AFTER + 1, 0), (2 * TELL_AFTER, 0)]
    assert [absence.seen(now, workers) for now, workers in looks] == [None] * 6


def test_that_no_worker_is_there_is_told_once_and_that_one_is_again() -> None:
    absence = Absence("the scheduler at tls://a:1")
    for begin in (5.0, 5000.0):
        assert absence.seen(begin, 0) is None
        said = absence.seen(begin + TELL_AFTER, 0)
        assert said == "workers: the scheduler at tls://a:1 has had none for 10 s; it waits for some; Ctrl-C ends"
        assert absence.seen(begin + 100 * END_AFTER, 0) is None, "others may start some at any time"
        said = absence.seen(begin + 100 * END_AFTER + 1, 3)
        assert said == "workers: the scheduler at tls://a:1 has workers again; the work goes on"
        assert absence.seen(begin + 100 * END_AFTER + 2, 3) is None


def test_work_whose_own_workers_do_not_come_back_ends() -> None:
    absence = Absence("this command", END_AFTER)
    assert absence.seen(0, 0) is None
    said = absence.seen(TELL_AFTER, 0)
    assert said is not None
    assert "it ends after 120 s, or by Ctrl-C" in said
    assert absence.seen(END_AFTER - 1, 0) is None
    with pytest.raises(WorkersError, match="this command has had none for 120 s"):
        absence.seen(END_AFTER, 0)

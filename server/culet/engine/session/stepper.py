"""Threads that step what moves as real time passes, so that no frame waits for a step."""

from __future__ import annotations

import heapq
import itertools
import threading
import time
from collections.abc import Callable
from typing import Protocol

THREADS = 4
"""As many worlds whose steps take long, up to a second each at the extremes, do not keep the others from moving."""


class Stepping(Protocol):
    """What takes its steps by the clock."""

    def run(self, now: float) -> float | None:
        """Take the steps that are due at `now` (s, steady clock); when the next one is, or None if none will be."""


class Stepper:
    """Runs everything that it is told to keep going, each when it is due; of one thing never two runs at a time.

    One thread waits for whatever is due first (the leader), the others for something to do: Schmidt et al., Leader /
    Followers (2000).
    """

    def __init__(self, threads: int = THREADS, clock: Callable[[], float] = time.monotonic) -> None:
        """The threads begin with the first thing to do, and do not keep a process from ending."""
        self._threads = threads
        self._now = clock
        self._lock = threading.Lock()
        self._sooner = threading.Condition(self._lock)
        """Something is due sooner than what the leader waits for."""
        self._free = threading.Condition(self._lock)
        """The place of the leader is free, and something is to come."""
        self._due: list[tuple[float, int, Stepping]] = []
        """A heap."""
        self._numbers = itertools.count()
        self._kept: set[Stepping] = set()
        """What is in the heap, or is being run."""
        self._again: set[Stepping] = set()
        """What was to be kept going while it was being run."""
        self._leading = False
        self._begun = False
        self._stopped = False

    def keep_going(self, steps: Stepping) -> None:
        """Run it now, and on until it says that there is nothing more to do."""
        with self._lock:
            if self._stopped:
                return
            if not self._begun:
                self._begun = True
                for number in range(self._threads):
                    threading.Thread(target=self._work, name=f"step-{number}", daemon=True).start()
            if steps in self._kept:
                self._again.add(steps)
            else:
                self._kept.add(steps)
                self._put(self._now(), steps)

    def stop(self) -> None:
        """Run nothing any more; what is being run goes on to its end."""
        with self._lock:
            self._stopped = True
            self._sooner.notify_all()
            self._free.notify_all()

    def _put(self, due: float, steps: Stepping) -> None:
        item = due, next(self._numbers), steps
        heapq.heappush(self._due, item)
        if not self._leading:
            self._free.notify()
        elif self._due[0] is item:
            self._sooner.notify()

    def _work(self) -> None:
        while (steps := self._next()) is not None:
            due = steps.run(self._now())
            with self._lock:
                again = steps in self._again
                self._again.discard(steps)
                if due is None and again:
                    due = self._now()
                if due is None:
                    self._kept.discard(steps)
                else:
                    self._put(due, steps)

    def _next(self) -> Stepping | None:
        """What is due, once something is; None if nothing will be any more."""
        with self._lock:
            while not self._stopped:
                wait = self._due[0][0] - self._now() if self._due else None
                if self._leading or wait is None:
                    self._free.wait()
                elif wait > 0:
                    self._leading = True
                    self._sooner.wait(wait)
                    self._leading = False
                else:
                    steps = heapq.heappop(self._due)[2]
                    if self._due:
                        self._free.notify()  # to lead while this thread is busy
                    return steps
            return None

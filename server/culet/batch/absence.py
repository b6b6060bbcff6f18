"""How long workers have been away, what is told of it, and when it ends the work."""

from __future__ import annotations

from culet.errors import WorkersError

TELL_AFTER = 10.0
"""s without any worker, until that is told: one that has died is replaced within some seconds."""
END_AFTER = 120.0
"""s without any, until work ends whose workers are its own: nobody else will start some."""


class Absence:
    """Of all workers at once. It has no clock: times come from who looks."""

    def __init__(self, name: str, end_after: float | None = None) -> None:
        """`name` is of those whose workers they are; without `end_after`, in s, others may come at any time."""
        self._name, self._end_after = name, end_after
        self._since: float | None = None
        self._told = False

    def seen(self, now: float, workers: int) -> str | None:
        """So many at a time, in s; what there is to tell, each once. WorkersError after too long."""
        if workers:
            told, self._since, self._told = self._told, None, False
            return f"workers: {self._name} has workers again; the work goes on" if told else None
        self._since = now if self._since is None else self._since
        gone = now - self._since
        if self._end_after is not None and gone >= self._end_after:
            raise WorkersError(f"workers: {self._name} has had none for {gone:.0f} s, and no new one has come")
        if self._told or gone < TELL_AFTER:
            return None
        self._told = True
        ending = "Ctrl-C ends" if self._end_after is None else f"it ends after {self._end_after:.0f} s, or by Ctrl-C"
        return f"workers: {self._name} has had none for {gone:.0f} s; it waits for some; {ending}"

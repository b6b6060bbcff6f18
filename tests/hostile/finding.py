"""What a trial found: a row of the table in docs/explanation/reliability.md, and a claim that a test makes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Group(StrEnum):
    """Parts of the table."""

    LOAD = "Load held"
    SHARES = "Fair shares"
    FAULTS = "Faults survived, and time to recover"
    INPUTS = "Hostile inputs tried"


@dataclass(frozen=True)
class Finding:
    """One row."""

    group: Group
    tried: str
    """What was done."""
    found: str
    """What came of it, in figures."""
    wanted: str
    """What must hold."""
    holds: bool

    @property
    def row(self) -> str:
        """Of a Markdown table."""
        return f"| {self.tried} | {self.found} | {self.wanted} | {'yes' if self.holds else '**no**'} |"


def span(values: list[float], unit: str, digits: int = 1) -> str:
    """A list of figures in short."""
    low, high = min(values), max(values)
    if f"{low:.{digits}f}" == f"{high:.{digits}f}":
        return f"{low:.{digits}f} {unit}"
    return f"{low:.{digits}f} to {high:.{digits}f} {unit}"

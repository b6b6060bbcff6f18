"""What a trial has found, beside what it may be."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One number that is held to a limit."""

    claim: str
    value: float
    limit: float
    unit: str = ""
    least: float | None = None
    """What it must at least be; None: any less is better."""

    @property
    def held(self) -> bool:
        """Whether it is within its limits; NaN is not."""
        return self.value <= self.limit and (self.least is None or self.value >= self.least)

    def row(self) -> str:
        """Of a table in Markdown."""
        limit = f"{self.limit:g}" if self.least is None else f"{self.least:g} to {self.limit:g}"
        unit = f" {self.unit}" if self.unit else ""
        return f"| {self.claim} | {self.value:.2g}{unit} | {limit} | {'yes' if self.held else '**no**'} |"

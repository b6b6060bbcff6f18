"""What `culet bench` prints."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.table import Table

from culet.study.bench import FeatureCost, Timing


def case_table(timings: Sequence[Timing]) -> Table:
    """A row for each scene: one sample of every pixel."""
    table = _table("scene", "median ms", "fastest ms", "ratio", "segments", "ns / segment", "cut")
    for timing in timings:
        table.add_row(
            timing.name,
            f"{1e3 * timing.seconds:.2f}",
            f"{1e3 * timing.fastest:.2f}",
            f"{timing.ratio:.2f}",
            str(timing.segments),
            f"{timing.nanoseconds_per_segment:.2f}",
            f"{timing.cut:.2g}",
        )
    return table


def feature_table(costs: Sequence[FeatureCost]) -> Table:
    """A row for each feature: medians without it, idle in the program and in use, and the first two programs' sizes."""
    table = _table("feature", "without ms", "idle ms", "in use ms", "without bytes", "idle bytes")
    for cost in costs:
        table.add_row(
            cost.name,
            f"{cost.without_ms:.2f}",
            f"{cost.idle_ms:.2f}",
            f"{cost.used_ms:.2f}",
            str(cost.without_bytes),
            str(cost.idle_bytes),
        )
    return table


def _table(name: str, *figures: str) -> Table:
    table = Table(name, box=box.SIMPLE_HEAD)
    for figure in figures:
        table.add_column(figure, justify="right", no_wrap=True)
    return table

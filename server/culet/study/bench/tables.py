"""What `culet bench` and `culet study compare-bench` print."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from culet.study.bench.baseline import FIGURES, Comparison, compare_benches
from culet.study.bench.bench import FeatureCost, Timing
from culet.study.bench.light_bench import LightTiming
from culet.study.bench.profile import Profile


def case_table(timings: Sequence[Timing]) -> Table:
    """A row for each scene: one sample of every pixel."""
    table = _table("scene", "median ms", "fastest ms", "prepare ms", "ratio", "segments", "ns / segment", "cut", "rmse")
    for timing in timings:
        table.add_row(
            timing.name,
            f"{1e3 * timing.seconds:.2f}",
            f"{1e3 * timing.fastest:.2f}",
            f"{1e3 * timing.preparation_seconds:.2f}",
            f"{timing.ratio:.2f}",
            str(timing.segments),
            f"{timing.nanoseconds_per_segment:.2f}",
            f"{timing.cut:.2g}",
            f"{timing.rmse:.2g}",
        )
    return table


def light_table(timings: Sequence[LightTiming]) -> Table:
    """A row for each map of light, and each frame with its map."""
    table = _table("light", "median ms", "processor ms", "ratio", "beams")
    for timing in timings:
        table.add_row(
            timing.name,
            f"{1e3 * timing.seconds:.2f}",
            f"{1e3 * timing.processor_seconds:.2f}",
            f"{timing.ratio:.2f}",
            "-" if timing.beams is None else f"{timing.beams:.0f}",
        )
    return table


def profile_table(profile: Profile) -> Table:
    """A row for each stage of a frame, and one for all."""
    table = _table(profile.name, "ms", "of all", "counted", "work", "of the limit")
    for stage in profile.stages:
        counted = "-"
        if stage.instructions is not None:
            counted = f"{stage.instructions / 1e9:.2f} G"
        elif stage.bytes is not None:
            counted = f"{stage.bytes / 1e6:.1f} MB"
        share = stage.share(profile.limits)
        table.add_row(
            stage.name,
            f"{1e3 * stage.seconds:.2f}",
            f"{stage.seconds / profile.seconds:.1%}",
            counted,
            stage.work or "-",
            "-" if share is None else f"{share:.0%}",
        )
    table.add_row("all", f"{1e3 * profile.seconds:.2f}", "100%", "-", "-", "-")
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


def ratio_table(comparison: Comparison) -> Table:
    """A row for each scene: after / before."""
    table = _table("after / before", *(figure.replace("_", " ") for figure in FIGURES))
    for case in comparison.cases:
        table.add_row(case.name, *("-" if ratio is None else f"{ratio:.3f}" for ratio in case.ratios.values()))
    return table


def print_comparison(console: Console, before: dict[str, Any], after: dict[str, Any]) -> None:
    """Of two lines of `culet bench -o`, with what each was measured on."""
    compared = compare_benches(before, after)
    console.print(f"against commit {before.get('commit')} of {str(before.get('made'))[:10]}")
    for remark in compared.remarks:
        console.print(f"note: {remark}", soft_wrap=True)
    console.print(ratio_table(compared))


def _table(name: str, *figures: str) -> Table:
    table = Table(name, box=box.SIMPLE_HEAD)
    for figure in figures:
        table.add_column(figure, justify="right", no_wrap=True)
    return table

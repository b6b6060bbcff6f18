"""Two reports side by side, as ratios: what changed between two states of the code, or two machines."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable
from typing import NamedTuple

from culet.errors import InputError
from culet.study.findings.ratio import ratio, shown
from culet.study.report import Report


class Ratio(NamedTuple):
    """Of one figure of one point."""

    group: str
    label: str
    figure: str
    before: float
    after: float

    @property
    def ratio(self) -> float:
        """after / before."""
        return ratio(self.before, self.after)


class Difference(NamedTuple):
    """Of two reports."""

    ratios: list[Ratio]
    only_before: list[str]
    only_after: list[str]
    warnings: list[str]


def compare_reports(before: Report, after: Report) -> Difference:
    """Ratios of what is better if less or more, of the points that both have; InputError for different studies."""
    if before.study != after.study:
        raise InputError(f"expected two reports of the same study, got {before.study} and {after.study}")
    warnings = [
        f"{name} differ: {shown(old)}, then {shown(new)}"
        for name, old, new in (("scenes", before.scene, after.scene), ("settings", before.settings, after.settings))
        if old != new
    ]
    warnings += [
        f"{name} differs: {before.provenance.get(name)}, then {after.provenance.get(name)}"
        for name in ("processor", "device", "driver", "units")
        if before.provenance.get(name) != after.provenance.get(name)
    ]
    known = {point.key: point for point in before.points}
    ratios: list[Ratio] = []
    for point in after.points:
        if (old_point := known.get(point.key)) is None:
            continue
        for name, value in point.figures.items():
            old_value = old_point.figures.get(name)
            if value is not None and old_value is not None and after.figures[name].better != "neither":
                ratios.append(Ratio(point.group, point.label, name, old_value, value))
    keys = {point.key for point in after.points}
    return Difference(
        ratios, [key for key in known if key not in keys], [key for key in keys if key not in known], warnings
    )


def medians(ratios: Iterable[Ratio]) -> dict[str, float]:
    """Median ratio of each figure, over the points where it is finite."""
    by_figure: dict[str, list[float]] = {}
    for each in ratios:
        if math.isfinite(each.ratio):
            by_figure.setdefault(each.figure, []).append(each.ratio)
    return {name: statistics.median(values) for name, values in by_figure.items()}

"""The Pareto frontier: what to choose from, if both time and error matter."""

from __future__ import annotations

from collections.abc import Iterable

from culet.study.report import Frontier, Point


def frontier(name: str, points: Iterable[Point], cost: str, error: str) -> Frontier:
    """The points that no other beats: at least as good in both figures and better in one. Fastest first.

    Points that lack one of the figures do not take part.
    """
    measured: list[tuple[float, float, str]] = []
    for point in points:
        seconds, wrong = point.figures.get(cost), point.figures.get(error)
        if seconds is not None and wrong is not None:
            measured.append((seconds, wrong, point.key))
    keys: list[str] = []
    least = float("inf")
    for _, wrong, key in sorted(measured):
        if wrong < least:
            keys.append(key)
            least = wrong
    return Frontier(name=name, cost=cost, error=error, keys=tuple(keys))

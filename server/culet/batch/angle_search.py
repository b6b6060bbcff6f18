"""The second part of a search for a better cut: angles of single tiers, all meets kept, from designs of the first.

Tangent ratios steepen all of a crown, or of a pavilion, together. From the best designs by ratios the angles of those
tiers that are free of each other are searched within some degrees, the others following; by a trust region with
quadratic models (COBYQA: T. M. Ragonneau, Z. Zhang, 2022, as scipy has it). Grades come from the same rays throughout.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from scipy.optimize import Bounds, minimize

from culet.batch.search import BRIGHTNESS, FIRE, Candidate, Search, SpentError
from culet.errors import MeshError
from culet.geometry.meets import angle_of_tiers, independent_tiers
from culet.geometry.recut import OF_A_SHAPE, recut_shape
from culet.geometry.shape import Shape
from culet.grading.grades import grade
from culet.grading.metrics import number_of
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.grading.sums import LightSums
from culet.scene.recut import Recut

FIRST_STEP = 0.5
"""Of the reach, how far the first models look."""
SMALLEST_STEP = 0.01
"""Degrees: finer than anybody cuts; within a smaller reach the first step is the last."""
WORSE = 10.0
"""Points by which angles that lose a meet count as worse than the start, so that models stay tame."""
DECIMALS = 3
"""Of degrees that are graded, and told."""
LEAST_REACH = 2 * 10**-DECIMALS
"""Degrees; in less the first step would not be told from none."""
LEAST, MOST = 0.01, 89.99
"""Degrees between which a tier's angle is searched; tiers beyond follow."""


class AngleSearch:
    """Grades designs that differ in tiers' angles."""

    def __init__(
        self, sums: LightSums, shape: Shape, optics: StoneOptics, rules: Rules, weights: Mapping[str, float]
    ) -> None:
        """`shape` is the design as it was given, `weights` of grades by name."""
        self._sums, self._shape, self._optics, self._rules, self._weights = sums, shape, optics, rules, weights

    def run(
        self,
        start: Candidate,
        value: Callable[[Candidate], float],
        reach: float,
        evaluations: int,
        progress: Callable[[], None] = lambda: None,
    ) -> list[Candidate]:
        """The designs that were graded, at most so many, to find a larger value within `reach` degrees of a start's
        angles. None of a shape without tiers that can be turned, or with more facets than angles are changed of."""
        ratios = Recut(crown_ratio=start.crown_ratio, pavilion_ratio=start.pavilion_ratio)
        own = free_angles(recut_shape(self._shape, ratios))
        if not own or evaluations < 2 or reach < LEAST_REACH:
            return []
        tiers, middle = list(own), np.round(list(own.values()), DECIMALS)
        found: dict[tuple[float, ...], Candidate | None] = {}

        def lost(degrees: Any) -> float:  # noqa: ANN401 - as scipy gives them
            key = tuple(np.round(degrees, DECIMALS).tolist())
            if key not in found:
                if len(found) >= evaluations:
                    raise SpentError
                found[key] = self._graded(ratios, dict(zip(tiers, key, strict=True)))
                progress()
            each = found[key]
            return -value(start) + WORSE if each is None else -value(each)

        bounds = Bounds(np.maximum(middle - reach, LEAST), np.minimum(middle + reach, MOST))
        first = FIRST_STEP * reach
        options = {"maxfev": evaluations, "initial_tr_radius": first, "final_tr_radius": min(SMALLEST_STEP, first)}
        with suppress(SpentError):
            minimize(lost, middle, method="COBYQA", bounds=bounds, options=options)
        return [each for each in found.values() if each is not None]

    def _graded(self, ratios: Recut, angles: Mapping[int, float]) -> Candidate | None:
        """None for angles that keep not all meets."""
        try:
            shape = recut_shape(self._shape, Recut(**ratios.model_dump(exclude={"angles"}), angles=angles))
            grades = next(grade(self._sums, shape, self._optics, self._rules))
        except MeshError:
            return None
        numbers = {name: number_of(grades, name) for name in {BRIGHTNESS, FIRE, *self._weights}}
        total = sum(weight * numbers[name].value for name, weight in self._weights.items())
        return Candidate(ratios.crown_ratio, ratios.pavilion_ratio, numbers, total, angles)


def turn_tiers(
    search: Search,
    angles: AngleSearch,
    reach: float,
    evaluations: int,
    progress: Callable[[float], None] = lambda part: None,
) -> None:
    """Add to a search's designs others that differ in angles, from its largest sum, its brightest and its most fiery,
    until it has graded so many in all."""
    values: list[Callable[[Candidate], float]] = [lambda each: each.total]
    values += [lambda each, name=name: each.grades[name].value for name in (BRIGHTNESS, FIRE)]  # type: ignore[misc]
    begun = len(search.candidates)
    graded = 0

    def one_more() -> None:
        nonlocal graded
        graded += 1
        progress(min(1.0, (begun + graded) / evaluations))

    for left, value in zip((3, 2, 1), values, strict=True):
        start = max(search.candidates[:begun], key=value)
        room = (evaluations - begun - graded) // left
        search.candidates += angles.run(start, value, reach, room, one_more)


def free_angles(shape: Shape) -> dict[int, float]:
    """Degrees of the tiers that can each be turned by itself; none where angles cannot be changed."""
    planes, tiers = shape.planes @ OF_A_SHAPE.T, [name.tier for name in shape.names]
    try:
        free = independent_tiers(shape.name, planes, tiers)
    except MeshError:
        return {}
    angles = angle_of_tiers(planes, tiers)
    return {tier: angles[tier] for tier in free if LEAST <= angles.get(tier, 0) <= MOST}

"""A search for the tangent ratios of a design that serve brightness and fire: every design on the front between them.

No single design is best: what is gained in fire is mostly paid for in brightness. A search by dividing rectangles
(DIRECT: Jones, Perttunen and Stuckman, Journal of Optimization Theory and Applications 79, 1993) maximises the weighted
sum of grades that was asked for over the whole range; from the best designs known, searches by simplex (Nelder and
Mead, Computer Journal 7, 1965) then go for sums of ISO and fire alone, from all of the one to all of the other. All
designs are graded by the same rays, so that their differences are better known than their grades.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import direct, minimize

from culet.errors import MeshError
from culet.geometry.recut import recut_shape
from culet.geometry.shape import Shape
from culet.grading.grades import grade
from culet.grading.metrics import number_of
from culet.grading.number import Number
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.grading.sums import LightSums
from culet.scene.recut import Recut

Range = tuple[float, float]

BRIGHTNESS, FIRE = "iso", "fire"
"""The grades between which the front lies."""
BALANCES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Fire's part of the sums that the later searches go for."""
WHOLE_RANGE = 0.5
"""Part of the designs that are graded to look through the whole range."""
SAME = 1e-4
"""Ratios nearer than this are one design: a tenth of a minute of arc or so."""
NO_STONE = 1e3
"""In place of a sum, of ratios that make no stone; grades are at most 100."""


@dataclass(frozen=True)
class Candidate:
    """A design that was graded."""

    crown_ratio: float
    pavilion_ratio: float
    grades: Mapping[str, Number]
    total: float
    """The weighted sum."""
    angles: Mapping[int, float] = field(default_factory=dict)
    """Degrees of tiers, by their numbers, besides the ratios."""


class SpentError(Exception):
    """As many designs as may be graded have been."""


class Search:
    """Grades designs, each once, and keeps them."""

    def __init__(
        self,
        sums: LightSums,
        shape: Shape,
        optics: StoneOptics,
        rules: Rules,
        weights: Mapping[str, float],
        evaluations: int,
        progress: Callable[[float], None] = lambda part: None,
    ) -> None:
        """`weights` of grades by name; so many `evaluations` at most."""
        self.candidates: list[Candidate] = []
        self._known: dict[tuple[int, int], Candidate | None] = {}
        self._sums, self._shape, self._optics, self._rules = sums, shape, optics, rules
        self._weights, self._evaluations, self._progress = weights, evaluations, progress

    def run(self, crown: Range, pavilion: Range) -> None:
        """Fill `candidates`. MeshError if the design as it is cannot be graded."""
        ends = [crown, pavilion]
        self._grade(1.0, 1.0)
        try:
            direct(self._total, ends, maxfun=max(1, round(WHOLE_RANGE * self._evaluations)), maxiter=10_000)
            share = max(1, (self._evaluations - len(self._known)) // len(BALANCES))
            for balance in BALANCES:
                start = max(self.candidates, key=lambda each: _balanced(each, balance))
                minimize(
                    self._balance, (start.crown_ratio, start.pavilion_ratio), (balance,), method="Nelder-Mead",
                    bounds=ends, options={"maxfev": share, "initial_simplex": _simplex(start, ends)},
                )  # fmt: skip
        except SpentError:
            return

    def front(self) -> list[Candidate]:
        """Those that no other beats in brightness and fire both, from the brightest to the most fiery."""
        order = sorted(self.candidates, key=lambda each: (-_value(each, BRIGHTNESS), -_value(each, FIRE)))
        found: list[Candidate] = []
        for each in order:
            if not found or _value(each, FIRE) > _value(found[-1], FIRE):
                found.append(each)
        return found

    def best(self) -> Candidate:
        """By the weighted sum."""
        return max(self.candidates, key=lambda each: each.total)

    def _total(self, ratios: Any) -> float:  # noqa: ANN401 - as scipy gives them
        found = self._of(ratios)
        return NO_STONE if found is None else -found.total

    def _balance(self, ratios: Any, balance: float) -> float:  # noqa: ANN401
        found = self._of(ratios)
        return NO_STONE if found is None else -_balanced(found, balance)

    def _of(self, ratios: Any) -> Candidate | None:  # noqa: ANN401
        crown, pavilion = (float(ratio) for ratio in ratios)
        key = round(crown / SAME), round(pavilion / SAME)
        if key not in self._known:
            if len(self._known) >= self._evaluations:
                raise SpentError
            try:
                self._known[key] = self._grade(crown, pavilion)
            except MeshError:
                self._known[key] = None
            self._progress(len(self._known) / self._evaluations)
        return self._known[key]

    def _grade(self, crown: float, pavilion: float) -> Candidate:
        shape = recut_shape(self._shape, Recut(crown_ratio=crown, pavilion_ratio=pavilion))
        grades = next(grade(self._sums, shape, self._optics, self._rules))
        numbers = {name: number_of(grades, name) for name in {BRIGHTNESS, FIRE, *self._weights}}
        total = sum(weight * numbers[name].value for name, weight in self._weights.items())
        found = Candidate(crown, pavilion, numbers, total)
        self.candidates.append(found)
        return found


def _simplex(start: Candidate, ends: list[Range]) -> Any:  # noqa: ANN401 - as scipy wants it
    """About a start, a tenth of the range long, inside the range."""
    corner = np.array([start.crown_ratio, start.pavilion_ratio])
    step = np.array([(most - least) / 10 for least, most in ends])
    step = np.where(corner + step > [most for _, most in ends], -step, step)
    return np.array([corner, corner + step * [1, 0], corner + step * [0, 1]])


def _balanced(each: Candidate, balance: float) -> float:
    return (1 - balance) * _value(each, BRIGHTNESS) + balance * _value(each, FIRE)


def _value(each: Candidate, name: str) -> float:
    return each.grades[name].value

"""Grades by the names that a sweep and a search know them by."""

from __future__ import annotations

from culet.geometry.shape import Shape
from culet.grading.answer import Grades
from culet.grading.grades import ASET, grade, weighted_light_return
from culet.grading.number import Number
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.grading.sums import LightSums

SHARES = ("glare", *ASET, "leak", "absorbed")
LIGHT_RETURN = "weighted_light_return"
"""The one that has rays of its own."""
GRADES = ("iso", "cos", "sc2", *SHARES, "window", "extinction", "contrast", "fire", "fire_degrees", LIGHT_RETURN)
"""docs/reference/grading.md defines each."""


def number_of(grades: Grades, name: str) -> Number:
    """One of GRADES but LIGHT_RETURN."""
    found = grades.shares[name] if name in SHARES else getattr(grades, name)
    assert isinstance(found, Number)  # noqa: S101 - of every name in GRADES
    return found


def measured(
    sums: LightSums, shape: Shape, optics: StoneOptics, rules: Rules, names: frozenset[str], target: float
) -> dict[str, Number]:
    """Those grades of a stone, ISO's error (twice the standard error, points) below the target; MeshError for a stone
    that is not convex."""
    found: dict[str, Number] = {}
    if names - {LIGHT_RETURN}:
        *_, grades = grade(sums, shape, optics, rules, target)
        found = {name: number_of(grades, name) for name in names - {LIGHT_RETURN}}
    if LIGHT_RETURN in names:
        *_, found[LIGHT_RETURN] = weighted_light_return(sums, shape, optics, rules)
    return found

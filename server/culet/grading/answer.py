"""What a stone is graded as; docs/reference/grading.md defines each number."""

from __future__ import annotations

from dataclasses import dataclass

from culet.grading.number import Number
from culet.grading.rules import Rules
from culet.grading.size import Size


@dataclass(frozen=True)
class Grades:
    """Per cent, but where said otherwise."""

    iso: Number
    cos: Number
    sc2: Number
    shares: dict[str, Number]
    """Of what the viewer sees: glare, green, red and blue (ASET, without glare), leak, absorbed, cut."""
    window: Number
    extinction: Number
    contrast: Number
    fire: Number
    fire_degrees: Number
    """Degrees."""
    rays: int
    """That met the stone."""


@dataclass(frozen=True)
class TiltPoint:
    """Of a tilt curve."""

    degrees: float
    iso: Number
    cos: Number
    sc2: Number


@dataclass(frozen=True)
class GradeReport:
    """What is known so far."""

    stone: str
    """Its id."""
    index: float
    """Refractive index at 589.3 nm."""
    size: Size
    rules: Rules
    grades: Grades
    weighted_light_return: Number | None = None
    """A part of 1."""
    tilt: dict[str, tuple[TiltPoint, ...]] | None = None
    """By the axis of its own shape that the stone turns about, `x` or `z`, level both."""
    done: float = 0.0
    """The part of the work."""

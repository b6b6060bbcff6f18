"""A gem design as cutters write it: tiers of facets, each at an angle, a distance and places on an index wheel.

The frame is GemCad's: z is up, through the table; index 0 lies toward +y and, seen from above, a wheel of positive
teeth counts clockwise. A facet is the half-space n.x <= d with its outward unit normal n.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, assert_never

import numpy as np
from numpy.typing import NDArray

DesignType = Literal["asc", "gem", "gcs"]
FacetSide = Literal["table", "crown", "girdle", "pavilion", "culet"]
PlaneRow = tuple[float, float, float, float]
"""Outward unit normal and distance from the design's origin."""

MOST_TEETH = 3600
"""Wheels have up to 360; a tenth of a degree is finer than any machine's."""


@dataclass(frozen=True)
class Wheel:
    """An index wheel."""

    teeth: int
    """Not 0; a negative number counts the other way round."""
    offset: float = 0.0
    """The index that lies toward +y."""

    def azimuth(self, index: float) -> float:
        """Radians from +y, clockwise seen from above."""
        return (index - self.offset) * 2 * math.pi / self.teeth

    def index(self, azimuth: float) -> float:
        """The place of an azimuth, in (0, teeth]; whole numbers and simple fractions without their rounding."""
        turned = (azimuth * self.teeth / (2 * math.pi) + self.offset) % abs(self.teeth)
        exact = without_noise(turned, 6)
        return exact if exact > 0 else float(abs(self.teeth))


@dataclass(frozen=True)
class Facet:
    """One facet of a tier."""

    index: float
    """Place on the wheel, in teeth, as the file has it; of a table or a culet it means nothing."""
    name: str
    """The facet's own or else the tier's; may be empty."""
    plane: PlaneRow


@dataclass(frozen=True)
class Tier:
    """Facets of one angle and one distance."""

    side: FacetSide
    angle: float
    """Degrees from the horizontal, 0 to 90."""
    distance: float
    """Of its facets from the origin, in the file's units."""
    facets: tuple[Facet, ...]
    notes: str = ""
    """How to cut it."""
    line: int | None = None
    """Of the file, where that is text."""

    @property
    def name(self) -> str:
        """Of its first named facet; may be empty."""
        return next((facet.name for facet in self.facets if facet.name), "")


@dataclass(frozen=True)
class Design:
    """What a file holds."""

    kind: DesignType | Literal["shape"]
    """What file held it; `shape`: made of a stone's facets."""
    wheel: Wheel
    tiers: tuple[Tier, ...]
    """In the order of cutting."""
    fold: int = 1
    """Symmetry that the program had set, no rule to repeat facets."""
    mirror: bool = False
    refractive_index: float | None = None
    """A suggestion."""
    headings: tuple[str, ...] = ()
    footnotes: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    """What the reader took otherwise than the file says, a sentence each."""

    @property
    def title(self) -> str:
        """The first heading that says something."""
        return next((heading for heading in self.headings if heading), "")

    def facets(self) -> Iterator[tuple[int, Facet]]:
        """Every facet with its tier's number, counted from 1."""
        for number, tier in enumerate(self.tiers, 1):
            for facet in tier.facets:
                yield number, facet

    def planes(self) -> NDArray[np.float64]:
        """(F, 4) outward unit normals and distances, in the order of `facets`."""
        return np.array([facet.plane for _, facet in self.facets()], np.float64).reshape(-1, 4)


def plane_of(side: FacetSide, angle: float, azimuth: float, distance: float) -> PlaneRow:
    """The plane at so many degrees from the horizontal, its normal at an azimuth in radians."""
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    match side:
        case "table":
            return (0.0, 0.0, 1.0, distance)
        case "culet":
            return (0.0, 0.0, -1.0, distance)
        case "girdle":
            return (math.sin(azimuth), math.cos(azimuth), 0.0, distance)
        case "crown":
            return (sine * math.sin(azimuth), sine * math.cos(azimuth), cosine, distance)
        case "pavilion":
            return (sine * math.sin(azimuth), sine * math.cos(azimuth), -cosine, distance)
    assert_never(side)


LEVEL = 1e-9
"""A component of a unit normal below this is a rounded 0: files of doubles have up to 3e-14, and no angle that is
written with 6 decimals comes nearer to the horizontal or the vertical."""


def side_and_angle(normal: tuple[float, float, float]) -> tuple[FacetSide, float]:
    """Which side a facet is on, and its degrees from the horizontal."""
    x, y, z = normal
    level = math.hypot(x, y)
    if level < LEVEL:
        return ("table" if z > 0 else "culet"), 0.0
    if abs(z) < LEVEL:
        return "girdle", 90.0
    angle = without_noise(math.degrees(math.atan2(level, abs(z))), 8)
    return ("crown" if z > 0 else "pavilion"), angle


def without_noise(value: float, decimals: int) -> float:
    """The value of few decimals that rounding in double precision has moved, or else the value itself."""
    rounded = round(value, decimals)
    return rounded if abs(rounded - value) < 1e-11 * max(1.0, abs(value)) else value

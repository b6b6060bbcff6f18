"""What is said of a stone's tiers: apart from what finds it, which a gateway does not load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class TierAngle:
    """A tier of sloping facets that are all of one angle."""

    tier: int
    """Its number, as `recut.angles` of a stone has it."""
    names: tuple[str, ...]
    """Of its facets, each once; none where they have no names."""
    facets: int
    side: Literal["crown", "pavilion"]
    degrees: float
    """From the horizontal, as the stone is."""
    independent: bool
    """Whether it can be turned together with all others that are so. The angles of the rest follow from theirs."""
    least: float
    """Degrees: less is refused, and so is what loses a meet between both ends, unless they are its reach."""
    most: float


@dataclass(frozen=True)
class Tiers:
    """The sloping tiers of a stone, in their order of cutting."""

    tiers: tuple[TierAngle, ...]

"""What is said of a design's proportions: apart from what measures them, which a gateway does not load."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Proportions:
    """In the file's units; per cent are of the width."""

    facets: int
    corners: int
    edges: int
    length: float
    """The larger extent along x or y."""
    width: float
    height: float
    volume: float
    table_percent: float | None
    """The table's extent along the width; None without a table."""
    crown_percent: float | None
    """From the girdle's highest corner up; None without upright facets."""
    girdle_percent: float | None
    pavilion_percent: float | None

    @property
    def length_by_width(self) -> float:
        return self.length / self.width

    @property
    def height_by_width(self) -> float:
        return self.height / self.width

    @property
    def volume_factor(self) -> float:
        """Volume by the width's cube: with it and the density, weight comes from the width."""
        return self.volume / self.width**3

"""How a stone is cut anew without drawing its facets anew: what a design by somebody else lets one change."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field

from culet.scene.cuts import USUAL
from culet.scene.fields import Model

LEAST_RATIO, MOST_RATIO = 0.2, 5.0
MOST_ANGLES = 64
"""Tiers of sloping facets; designs have up to thirty."""


def _ratio(of: str) -> Any:  # noqa: ANN401 - as pydantic's own
    return Field(
        ge=LEAST_RATIO,
        le=MOST_RATIO,
        description=f"Tangent ratio: the tangent of every {of} facet's angle is so many times what it was. All meets, "
        "all places on the index wheel and the girdle are kept.",
        json_schema_extra={USUAL: [0.8, 1.25]},
    )


class TierAngles(dict[int, float]):
    """Degrees by tier; like all of a scene it is not changed, and so has a hash."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))


Degrees = Annotated[float, Field(gt=0, lt=90)]
RecutTier = Annotated[int, Field(ge=1)]


class Recut(Model):
    """What becomes of a convex stone's crown, pavilion, table and girdle. What is not said stays as it is."""

    crown_ratio: Annotated[float, _ratio("crown")] = 1
    pavilion_ratio: Annotated[float, _ratio("pavilion")] = 1
    girdle_percent: Annotated[float, Field(gt=0, le=100)] | None = Field(
        None,
        description="From the girdle's lowest corner to its highest, of the width: the crown is lifted or lowered.",
        json_schema_extra={USUAL: [1, 12]},
    )
    table_percent: Annotated[float, Field(gt=0, lt=100)] | None = Field(
        None,
        description="The table's extent along the width, of the width: the table is cut higher or lower.",
        json_schema_extra={USUAL: [30, 80]},
    )

    angles: Annotated[dict[RecutTier, Degrees], Field(max_length=MOST_ANGLES), AfterValidator(TierAngles)] = Field(
        default_factory=TierAngles,
        description="Degrees from the horizontal of a tier's facets, by the tier's number as `culet design show` has "
        "it, once ratios and girdle are changed. All points in which facets meet and the girdle are kept: distances "
        "follow, and other angles where distances alone cannot.",
    )

    @property
    def changes(self) -> bool:
        """Whether anything is said."""
        return self != Recut()

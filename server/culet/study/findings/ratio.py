"""What two comparisons share: a figure after over before, and a fact in a remark."""

from __future__ import annotations

import json
import math

LONGEST = 160
"""Letters of a fact."""


def ratio(before: float, after: float) -> float:
    """after / before, of magnitudes; 1 if nothing has become nothing, infinite if something has come out of nothing."""
    if before == after:
        return 1.0
    return abs(after / before) if before else math.inf


def shown(value: object) -> str:
    """As JSON, the beginning of what is long."""
    text = json.dumps(value, default=str)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."

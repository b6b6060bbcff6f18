"""The second part of a search for a better cut: angles of single tiers, all meets kept, from designs of the first.

Tangent ratios steepen all of a crown, or of a pavilion, together. From the best designs by ratios the angles of those
tiers that are free of each other are searched within some degrees, the others following; by a trust region with
quadratic models (COBYQA: T. M. Ragonneau, Z. Zhang, 2022, as scipy has it). Grades come from the same rays throughout.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import Bounds, minimize

from culet.batch.candidates import (
    ANGLE_DECIMALS,
    BRIGHTNESS,
    FIRE,
    AskTrial,
    Candidate,
    Candidates,
    Search,
    TrialDesign,
)
from culet.errors import MeshError
from culet.geometry.cutting.meets import LEAST_DEGREES, MOST_DEGREES, angle_of_tiers, independent_tiers
from culet.geometry.cutting.recut import OF_A_SHAPE, recut_shape
from culet.geometry.shape import Shape

FIRST_STEP = 0.5
"""Of the reach, how far the first models look."""
SMALLEST_STEP = 0.01
"""Degrees: finer than anybody cuts; within a smaller reach the first step is the last."""
WORSE = 10.0
"""Points by which angles that lose a meet count as worse than the start, so that models stay tame."""
LEAST_REACH = 2 * 10**-ANGLE_DECIMALS
"""Degrees; in less the first step would not be told from none."""


Value = Callable[[Candidate], float]
"""Of which a search wants more."""
VALUES: tuple[Value, ...] = (
    lambda each: each.total,
    lambda each: each.grades[BRIGHTNESS].value,
    lambda each: each.grades[FIRE].value,
)
"""Searches start from the largest of each, and go for more of it."""


def search_angles(candidates: Candidates, reach: float, evaluations: int) -> None:
    """Grade so many more designs at most, within `reach` degrees of the angles of those that were found before. Each
    search has its part of them; what one that ends early leaves is not graded."""
    starts = [max(candidates.found, key=value) for value in VALUES]
    room = evaluations // len(VALUES)
    searches = [
        search
        for start, value in zip(starts, VALUES, strict=True)
        if (search := angle_search(candidates.shape, start, value, reach, room)) is not None
    ]
    candidates.run(searches, room)


def angle_search(shape: Shape, start: Candidate, value: Value, reach: float, most: int) -> Search | None:
    """For a larger value within `reach` degrees of a start's angles. None of a shape without tiers that can be turned,
    or with more facets than angles are changed of; nor with room for less than two designs."""
    ratios = TrialDesign.of(start.crown_ratio, start.pavilion_ratio)
    own = free_angles(recut_shape(shape, ratios.recut()))
    if not own or most < 2 or reach < LEAST_REACH:
        return None
    tiers, middle = list(own), np.round(list(own.values()), ANGLE_DECIMALS)

    def lost(ask: AskTrial, degrees: Any) -> float:  # noqa: ANN401 - as scipy gives them
        each = ask(TrialDesign.of(start.crown_ratio, start.pavilion_ratio, dict(zip(tiers, degrees, strict=True))))
        return -value(start) + WORSE if each is None else -value(each)

    bounds = Bounds(np.maximum(middle - reach, LEAST_DEGREES), np.minimum(middle + reach, MOST_DEGREES))
    first = FIRST_STEP * reach
    options = {"maxfev": most, "initial_tr_radius": first, "final_tr_radius": min(SMALLEST_STEP, first)}

    def search(ask: AskTrial) -> None:
        minimize(partial(lost, ask), middle, method="COBYQA", bounds=bounds, options=options)

    return Search(search, together=2 * len(tiers) + 1)  # the first models' points


def free_angles(shape: Shape) -> dict[int, float]:
    """Degrees of the tiers that can each be turned by itself; none where angles cannot be changed."""
    planes, tiers = shape.planes @ OF_A_SHAPE.T, [name.tier for name in shape.names]
    try:
        free = independent_tiers(shape.name, planes, tiers)
    except MeshError:
        return {}
    angles = angle_of_tiers(planes, tiers)
    return {tier: angles[tier] for tier in free if LEAST_DEGREES <= angles.get(tier, 0) <= MOST_DEGREES}

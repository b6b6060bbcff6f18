"""A search for the tangent ratios of a design that serve brightness and fire: every design on the front between them.

No single design is best: what is gained in fire is mostly paid for in brightness. A search by dividing rectangles
(DIRECT: Jones, Perttunen and Stuckman, Journal of Optimization Theory and Applications 79, 1993) maximises the weighted
sum of grades that was asked for over the whole range; from the best designs known, searches by simplex (Nelder and
Mead, Computer Journal 7, 1965) then go for sums of ISO and fire alone, from all of the one to all of the other. Designs
of one division, and the searches by simplex, need nothing of each other and are graded side by side.
"""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import direct, minimize

from culet.batch.candidates import BRIGHTNESS, FIRE, AskTrial, Candidate, Candidates, Search, TrialDesign, UnknownError

Range = tuple[float, float]

BALANCES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Fire's part of the sums that the later searches go for."""
WHOLE_RANGE = 0.5
"""Part of the designs that are graded to look through the whole range."""
NO_STONE = 1e3
"""In place of a sum, of ratios that make no stone; grades are at most 100."""


def search_ratios(candidates: Candidates, crown: Range, pavilion: Range, evaluations: int) -> None:
    """Grade the design as it is, and so many others at most: each search by simplex has its part of them, and what one
    that ends early leaves is not graded. MeshError if it cannot be graded as it is."""
    ends = [crown, pavilion]
    candidates.grade_given()
    begun = len(candidates.graded)
    divide(candidates, ends, max(1, round(WHOLE_RANGE * evaluations)), begun + evaluations)
    left = evaluations - (len(candidates.graded) - begun)
    starts = [max(candidates.found, key=partial(_balanced, balance)) for balance in BALANCES]
    room = left // len(BALANCES)
    searches = [_simplex_search(balance, start, ends, room) for balance, start in zip(BALANCES, starts, strict=True)]
    candidates.run(searches if room else [], room)


def divide(candidates: Candidates, ends: list[Range], most: int, all_graded: int) -> None:
    """By DIRECT, which is to end after `most` designs, and ends before more than `all_graded` have been.

    It divides rectangles by the values at their centres, several in each division. So it is run from its beginning
    until a division has asked for what is not known yet; that is graded, and it is run again.
    """
    while True:
        unknown: list[TrialDesign] = []
        with suppress(UnknownError):
            direct(
                partial(_known_total, candidates, unknown), ends, maxfun=most, maxiter=10_000,
                callback=partial(_end_division, unknown),
            )  # fmt: skip
        room = all_graded - len(candidates.graded)
        candidates.grade(list(dict.fromkeys(unknown))[:room])
        if not unknown or len(candidates.graded) >= all_graded:
            return


def _known_total(candidates: Candidates, unknown: list[TrialDesign], ratios: Any) -> float:  # noqa: ANN401 - as scipy's
    design = TrialDesign.of(*ratios)
    if design not in candidates.graded:
        unknown.append(design)
        return NO_STONE
    found = candidates.graded[design]
    return NO_STONE if found is None else -found.total


def _end_division(unknown: list[TrialDesign], _: object) -> None:
    if unknown:
        raise UnknownError


def _simplex_search(balance: float, start: Candidate, ends: list[Range], most: int) -> Search:
    """For the sum that has so much of fire."""

    def lost(ask: AskTrial, ratios: Any) -> float:  # noqa: ANN401
        found = ask(TrialDesign.of(*ratios))
        return NO_STONE if found is None else -_balanced(balance, found)

    def search(ask: AskTrial) -> None:
        minimize(
            partial(lost, ask), (start.crown_ratio, start.pavilion_ratio), method="Nelder-Mead", bounds=ends,
            options={"maxfev": most, "initial_simplex": _simplex(start, ends)},
        )  # fmt: skip

    return Search(search, together=3)  # the corners


def _simplex(start: Candidate, ends: list[Range]) -> Any:  # noqa: ANN401 - as scipy wants it
    """About a start, a tenth of the range long, inside the range."""
    corner = np.array([start.crown_ratio, start.pavilion_ratio])
    step = np.array([(most - least) / 10 for least, most in ends])
    step = np.where(corner + step > [most for _, most in ends], -step, step)
    return np.array([corner, corner + step * [1, 0], corner + step * [0, 1]])


def _balanced(balance: float, each: Candidate) -> float:
    return (1 - balance) * each.grades[BRIGHTNESS].value + balance * each.grades[FIRE].value

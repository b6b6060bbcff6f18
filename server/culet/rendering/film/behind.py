"""The colour behind everything where there is no time for a cut-out: a plain backdrop that a screen shows in it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from culet.optics.tone import tone_map
from culet.scene import Scene
from culet.scene.backdrop import PlainBackdrop
from culet.scene.fields import LARGEST_COMPONENT

LEAST = 1e-6
"""Radiance, exposed, that every tone map shows as 0 of 255."""

MOST = {"srgb": 1.0, "none": 1.0, "classic": 1 / 1.2}
"""Radiance, exposed, that is shown as 1 and beyond which those clip; the others climb slowly, up to BEYOND."""
BEYOND = 1e3

BRIGHTEST = 254 / 255
"""Of what is aimed at. Neutral shows only radiance beyond 9 as 255, and a pixel of which a tenth is so bright is white:
the outlines of stones would be jagged."""


def before_its_colour(scene: Scene) -> Scene:
    """The scene before the colour that its film has behind everything; as it is where that has none.

    The camera alone sees it, as any backdrop. Colours that a tone map never shows, as neutral no red of #ff0000, become
    the nearest one that it does. Where the exposure is so low that no backdrop is bright enough, it is the brightest.
    """
    behind = scene.film.behind
    if behind is None:
        return scene
    with np.errstate(over="ignore"):
        radiance = _radiance(behind, scene.film.tone_map) / scene.film.exposure
    red, green, blue = np.minimum(radiance, LARGEST_COMPONENT)
    backdrop = PlainBackdrop(kind="plain", colour=(float(red), float(green), float(blue)))
    return scene.model_copy(update={"backdrop": backdrop})


@lru_cache(maxsize=64)
def _radiance(shown: tuple[int, int, int], name: str) -> NDArray[np.float64]:
    """(3,) exposed, of which the tone map of that name makes those components, 0 to 255, or the nearest to them."""
    from scipy.optimize import least_squares  # few scenes need it, and importing it takes a tenth of a second

    wanted = np.minimum(np.array(shown) / 255, BRIGHTEST)
    start = np.maximum(wanted**2.2, 1e-3)
    low, high = np.log(LEAST), np.log(MOST.get(name, BEYOND))
    starts = (np.clip(np.log(scale * start), low + 1e-9, high - 1e-9) for scale in (0.4, 1, 3))
    answers = [
        least_squares(lambda log: tone_map(np.exp(log), name) - wanted, begin, bounds=(low, high), ftol=1e-12)
        for begin in starts
    ]
    best: NDArray[np.float64] = min(answers, key=lambda answer: float(answer.cost)).x
    return np.exp(best)

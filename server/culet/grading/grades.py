"""Grades of a convex stone as it is seen from above, and as it is tilted; docs/reference/grading.md defines each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.grading.answer import Grades, TiltPoint
from culet.grading.number import Number, ratio
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.grading.sums import KERNEL, NUMBERS, UP, DomeView, LightSums, seen_areas

BATCHES = 16
"""That are drawn apart, to tell errors by."""
FIRST_RAYS, LEAST_RAYS, MOST_RAYS, MOST_PIECES = 4096, 512, 8192, 256
"""Of each batch: at first, then in each further piece of work, of which there are so many at most."""
MORE_RAYS = 1.15
"""Than the error of the rays before lets expect to be enough: that error is known to some 20 %."""
FIRE_TARGET = 2.0
"""In parts of the error that is asked for of ISO, that of fire, to whose chains two thirds of the time go."""
TARGET = 0.1
"""Points, the error of ISO that is asked for if none is named: two standard errors."""
SIGMAS = 2.0
TILTS = tuple(range(-90, 91, 5))
"""Degrees, the points of a tilt curve."""
TILT_RAYS = 2048
"""Of each of BATCHES at each point."""
WLR_BATCHES, WLR_RINGS, WLR_AROUND, WLR_RAYS = 8, 32, 13, 64
"""Of the weighted light return: directions of each batch, one in each ring of equal solid angle and each sector, and
rays of each. A prime number of sectors, with which no symmetry is in step."""
ASET = {"green": (0, 45), "red": (45, 75), "blue": (75, 90)}
"""Degrees of elevation: low, high, and from where the viewer is (AGS: Sasian et al., Optical Engineering 46, 2007)."""

Sums = NDArray[np.float64]


def grade(sums: LightSums, shape: Shape, optics: StoneOptics, rules: Rules, target: float = TARGET) -> Iterator[Grades]:
    """Face up, better and better: until twice the standard error of ISO is below `target`, in points, and that of fire
    below FIRE_TARGET times that, or MOST_PIECES are done. MeshError for a stone that is not convex."""
    found, fiery = np.zeros((2, BATCHES, NUMBERS))
    rays, taken, fire = FIRST_RAYS, 0, True
    for seed in range(MOST_PIECES):
        more = sums.of(shape, optics, rules, [DomeView()], batches=BATCHES, rays=rays, seed=seed, fire=fire)[0]
        found, taken = found + more, taken + rays
        fiery = fiery + more if fire else fiery
        grades = grades_of(found, optics, fiery)
        yield grades
        wanted = max(SIGMAS * grades.iso.error / target, SIGMAS * grades.fire.error / (FIRE_TARGET * target))
        if wanted <= 1:
            return
        fire = SIGMAS * grades.fire.error > FIRE_TARGET * target
        rays = round(min(max((MORE_RAYS * wanted**2 - 1) * taken, LEAST_RAYS), MOST_RAYS))


def grades_of(found: Sums, optics: StoneOptics, with_fire: Sums | None = None) -> Grades:
    """By the sums (batches, NUMBERS) of one view, and of those of its rays that were followed with fire; else all."""
    fiery = found if with_fire is None else with_fire

    def of(name: str) -> Sums:
        return found[:, KERNEL[name]]

    def of_fire(name: str) -> Sums:
        return fiery[:, KERNEL[name]]

    hits = of("HITS")
    elevation = found[:, KERNEL["ELEVATIONS"] :]

    def percent(part: Sums, lost: Sums | None = None) -> Number:
        return _times(100, ratio(part, hits, lost))

    middle = KERNEL["DEGREES"] // 2
    shares = {"glare": percent(of("MIRRORED"))}
    shares |= {
        name: percent(elevation[:, middle + a : middle + b].sum(axis=1), of("LOST")) for name, (a, b) in ASET.items()
    }
    shares |= {"leak": percent(elevation[:, :middle].sum(axis=1), of("LOST")), "absorbed": percent(of("ABSORBED"))}
    shares["cut"] = percent(of("LOST"))
    iso = percent(of("ISO"), of("LOST"))
    mean = iso.value / 100
    deviation = math.sqrt(max(0.0, ratio(of("SQUARES"), hits).value - mean * mean))
    # Of the variance to first order, since a batch that is brighter has a larger mean of squares, too.
    variance_error = ratio(of("SQUARES") - 2 * mean * of("ISO"), hits).error
    deviation_error = variance_error / (2 * deviation) if deviation > 0 else 0.0
    spread = (
        ratio(of_fire("SPREAD"), of_fire("TOGETHER")) if optics.blue_index != optics.red_index else Number(0.0, 0.0)
    )
    return Grades(
        iso=iso,
        cos=percent(of("COS"), of("LOST")),
        sc2=percent(of("SC2"), of("LOST")),
        shares=shares,
        window=percent(of("WINDOW")),
        extinction=percent(of("DARK")),
        contrast=Number(100 * deviation, 100 * deviation_error),
        fire=_times(100, ratio(of_fire("FIRE"), of_fire("HITS"), of_fire("LOST"))),
        fire_degrees=spread,
        rays=int(hits.sum()),
    )


def tilt_curve(
    sums: LightSums,
    shape: Shape,
    optics: StoneOptics,
    rules: Rules,
    azimuth: float = 0.0,
    tilts: Sequence[float] = TILTS,
    rays: int = TILT_RAYS,
) -> Iterator[TiltPoint]:
    """ISO, COS and SC2 as the stone tilts so that the viewer sees it from that azimuth, degrees from +x towards +z.
    Dome and head stay where they are. Point by point, so that nobody waits for all; MeshError as of `grade`."""
    for number, degrees in enumerate(tilts):
        view = DomeView.tilted(degrees, azimuth)
        (found,) = sums.of(shape, optics, rules, [view], batches=BATCHES, rays=rays, seed=1000 + number)
        hits, lost = found[:, KERNEL["HITS"]], found[:, KERNEL["LOST"]]
        iso, cos, sc2 = (_times(100, ratio(found[:, KERNEL[name]], hits, lost)) for name in ("ISO", "COS", "SC2"))
        yield TiltPoint(float(degrees), iso, cos, sc2)


def weighted_light_return(
    sums: LightSums, shape: Shape, optics: StoneOptics, rules: Rules | None = None, rays: int = WLR_RAYS
) -> Iterator[Number]:
    """GIA's, as a part of 1: of light of a uniform hemisphere that falls on the crown, what leaves through the crown,
    weighted by the squared cosine of its angle to the vertical (Hemphill et al., Gems & Gemology 34, 1998).

    Better and better. Chains run backwards from where light leaves (reciprocity); MeshError as of `grade`.
    """
    rules = replace(rules or Rules(), head_degrees=0, glare="none")
    random = np.random.default_rng(0)
    shape_of_batches = (WLR_BATCHES, WLR_RINGS, WLR_AROUND)
    rings, around = np.arange(WLR_RINGS)[:, None], np.arange(WLR_AROUND)
    cosine = (rings + random.random(shape_of_batches)) / WLR_RINGS
    azimuth = 360 * (around + random.random((WLR_BATCHES, WLR_RINGS, 1))) / WLR_AROUND
    views = [
        replace(DomeView.tilted(math.degrees(math.acos(c)), a), axis=UP)
        for c, a in zip(cosine.ravel().tolist(), azimuth.ravel().tolist(), strict=True)
    ]
    weight = cosine.ravel() ** 2
    parts: list[list[float]] = []
    own = len(views) // WLR_BATCHES
    for batch in range(WLR_BATCHES):
        of = slice(batch * own, (batch + 1) * own)
        found = sums.of(shape, optics, rules, views[of], batches=1, rays=rays, seed=batch, crown_alone=True)[:, 0]
        iso, lost, crown = (found[:, KERNEL[name]] for name in ("ISO", "LOST", "CROWN"))
        area = seen_areas(shape, views[of])
        weighted = area * weight[of]
        parts.append([float(weighted @ iso), float(area @ crown), float(weighted @ lost)])
        if len(parts) > 1:
            yield ratio(*np.array(parts).T)


def _times(factor: float, number: Number) -> Number:
    return Number(factor * number.value, factor * number.error, factor * number.bound)

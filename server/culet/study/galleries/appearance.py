"""What a picture of a stone looks like, in numbers: brightness, contrast and fire of what a screen shows.

Lightness L* and chroma C* are CIE 1976 of the displayed colour under D65. Dark, clipped and fire are parts of the
stone's pixels. All depend a little on the picture's size: compare within one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.rendering.projection import project
from culet.rendering.stones.placed_stone import placed_stones
from culet.stage import Stage

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TO_XYZ = np.array(
    [(0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.0721750), (0.0193339, 0.1191920, 0.9503041)]
)
"""From linear sRGB, IEC 61966-2-1."""
WHITE = np.array([0.95047, 1, 1.08883])
"""D65, XYZ."""
DARK, CLIPPED = 70 / 255, 250 / 255
"""A pixel is dark whose largest component is below, and clipped whose smallest is not below."""
FIRE_CHROMA, FIRE_LIGHTNESS = 30.0, 30.0
"""Fire is so far from the stone's median colour, and so bright."""
HOT_CHROMA, HOT_LIGHTNESS = 50.0, 40.0
"""Fire that nobody overlooks."""
LIKE_HUE, FEWEST_NEIGHBOURS = 0.7, 3
"""Isolated is a pixel of fire with fewer neighbours, of eight, whose hue is alike: their cosine is larger."""
CELLS = 48
"""Across the stone, of the grid whose neighbouring cells are compared for contrast: about a facet each."""
FULL_CELL = 0.6
"""Part of a cell that the stone covers at least."""


@dataclass(frozen=True)
class Appearance:
    """Of the stone's pixels."""

    lightness: float
    """Mean L*."""
    low: float
    """5th percentile of L*; then median and 95th."""
    median: float
    high: float
    dark: float
    clipped: float
    michelson: float
    """Mean contrast (a - b) / (a + b) of the luminance of neighbouring cells."""
    fire: float
    hot: float
    isolated: float
    """Part of the fire."""
    chroma: float
    """Median C*."""
    surround: float
    """Mean L* of what is around the stone, to half its size beyond its edge."""
    share: float
    """Of the picture that is stone."""


def stone_mask(stage: Stage, width: int, height: int) -> Mask:
    """(height, width) pixels whose centre's ray meets a convex stone before anything else."""
    stones = placed_stones(stage)
    (stone,) = stones
    rays = project(stage.scene, stones, width, height)
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    foot, direction = (
        rows[0] + x[..., None] * rows[1] + y[..., None] * rows[2] for rows in (rays.foot, rays.direction)
    )
    enter, leave = np.full(x.shape, -rays.reach), np.full(x.shape, np.inf)
    for *normal, offset in stone.planes:
        speed, gap = direction @ np.array(normal), offset - foot @ np.array(normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = gap / speed
        enter = np.where(speed < 0, np.maximum(enter, t), enter)
        leave = np.where(speed > 0, np.minimum(leave, t), leave)
        leave = np.where((speed == 0) & (gap < 0), -np.inf, leave)  # beside a facet that the ray is parallel to
    return np.asarray(enter < leave)


def lab(shown: Array) -> Array:
    """(..., 3) CIE L*a*b* of displayed sRGB from 0 to 1."""
    xyz = decoded(shown) @ TO_XYZ.T / WHITE
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(np.maximum(xyz, 1e-12)), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)


def decoded(shown: Array) -> Array:
    """Linear again: IEC 61966-2-1's inverse."""
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)


def appearance(rgb: NDArray[np.uint8], mask: Mask) -> Appearance:
    """Of (height, width, 3) bytes as they are shown, within a mask that is not empty."""
    shown = rgb / 255.0
    colours = lab(shown)
    lightness = colours[..., 0]
    within = lightness[mask]
    away = colours[..., 1:] - np.median(colours[mask][:, 1:], axis=0)
    apart = np.hypot(away[..., 0], away[..., 1])
    fire = mask & (apart > FIRE_CHROMA) & (lightness > FIRE_LIGHTNESS)
    largest, smallest = shown.max(axis=-1)[mask], shown.min(axis=-1)[mask]
    low, median, high = np.percentile(within, (5, 50, 95))
    around = lightness[_around(mask)]
    return Appearance(
        lightness=float(within.mean()),
        low=float(low),
        median=float(median),
        high=float(high),
        dark=float((largest < DARK).mean()),
        clipped=float((smallest >= CLIPPED).mean()),
        michelson=_contrast(decoded(shown) @ TO_XYZ[1], mask),
        fire=float(fire.sum() / mask.sum()),
        hot=float((mask & (apart > HOT_CHROMA) & (lightness > HOT_LIGHTNESS)).sum() / mask.sum()),
        isolated=_isolated(fire, away / np.maximum(apart, 1e-9)[..., None]),
        chroma=float(np.median(np.hypot(colours[..., 1], colours[..., 2])[mask])),
        surround=float(around.mean()) if around.size else float("nan"),
        share=float(mask.mean()),
    )


def _isolated(fire: Mask, hue: Array) -> float:
    alike = np.zeros(fire.shape)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            if down or right:
                beside, its_hue = np.roll(fire, (down, right), (0, 1)), np.roll(hue, (down, right), (0, 1))
                alike += beside & ((hue * its_hue).sum(axis=-1) > LIKE_HUE)
    return float((fire & (alike < FEWEST_NEIGHBOURS)).sum() / max(1, int(fire.sum())))


def _contrast(luminance: Array, mask: Mask) -> float:
    rows, columns = np.nonzero(mask)
    cell = max(1.0, (max(np.ptp(rows), np.ptp(columns)) + 1) / CELLS)
    places = ((rows - rows.min()) / cell).astype(int), ((columns - columns.min()) / cell).astype(int)
    sums, counts = np.zeros((CELLS + 2, CELLS + 2)), np.zeros((CELLS + 2, CELLS + 2))
    np.add.at(sums, places, luminance[mask])
    np.add.at(counts, places, 1)
    means = np.where(counts > FULL_CELL * cell * cell, sums / np.maximum(counts, 1), np.nan)
    pairs = ((means[1:], means[:-1]), (means[:, 1:], means[:, :-1]))
    found = np.concatenate([(abs(a - b) / np.maximum(a + b, 1e-6)).ravel() for a, b in pairs])
    return float(np.nanmean(found)) if np.isfinite(found).any() else 0.0


def _around(mask: Mask) -> Mask:
    """Pixels near the stone that are not its own."""
    rows, columns = np.nonzero(mask)
    size = max(np.ptp(rows), np.ptp(columns)) + 1
    y, x = np.ogrid[: mask.shape[0], : mask.shape[1]]
    near = (abs(y - rows.mean()) < 0.75 * size) & (abs(x - columns.mean()) < 0.75 * size) & ~mask
    return np.asarray(near if near.any() else ~mask)


@dataclass(frozen=True)
class ColourParts:
    """Of a stone under an instrument's sky: parts of its pixels by the brightest channel."""

    red: float
    green: float
    blue: float
    pure_red: float
    """The other channels are below a fifth of it."""


PURE = 0.2
"""Of the brightest channel, what the others stay below where a colour is pure."""


def colour_parts(linear: NDArray[np.floating], mask: Mask) -> ColourParts:
    """Of (height, width, 3) linear radiance within a mask."""
    pixels = linear[mask].astype(np.float64)
    brightest = pixels.argmax(axis=-1)
    red, green, blue = (float((brightest == channel).mean()) for channel in range(3))
    pure = (brightest == 0) & (pixels[:, 1:].max(axis=-1) < PURE * pixels[:, 0])
    return ColourParts(red, green, blue, float(pure.mean()))

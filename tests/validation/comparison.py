"""Two noisy pictures of one scene, pixel by pixel: are they the same up to their noise?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.stats import t as student

from culet.geometry.shape import Shape
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.stage import Stage
from validation.mitsuba_reference import Array, Reference

SIGNIFICANCE = 0.01
"""Chance that two equal pictures are called different; Mitsuba's own tests use the same."""
EVENTS = 2
"""Variance floor: that of this many samples, squared. A path of small probability shows in few samples or in none, and
then their spread says nothing. With 2, sums of rare events of any rate stay within the limits of a normal one."""


@dataclass(frozen=True, eq=False)
class Seen:
    """culet's picture with its uncertainty."""

    mean: Array
    """(height, width, 3) radiance."""
    variance: Array
    """(height, width, 3) of the mean, as if the samples were independent. They are better spread: an upper bound."""
    path_variance: Array
    """(height, width, 3) of a single random path's radiance: what culet says of the other's noise."""
    on_stone: NDArray[np.bool_]
    """(height, width) pixels that stones are seen in, and their neighbours."""
    samples: int


def seen(
    renderer: Renderer, scene: Scene, shapes: Sequence[Shape], panorama: Array, size: tuple[int, int], samples: int
) -> Seen:
    """The scene's stones, of these shapes, under a grey panorama (h, 2h), each sample read by itself."""
    sky = np.repeat(panorama[..., None], 3, axis=-1).astype(np.float32)
    picture = renderer.picture(Stage(scene, tuple(shapes), sky), *size)
    total = np.zeros((size[1], size[0], 3))
    squares = np.zeros_like(total)
    for number in range(samples):
        picture.refine()
        sum_so_far = picture.linear().astype(np.float64) * (number + 1)
        squares += (sum_so_far - total) ** 2
        total = sum_so_far
    mean = total / samples
    variance = np.maximum(squares / samples - mean**2, 0) / (samples - 1)
    squared = renderer.picture(Stage(scene, tuple(shapes), sky**2), *size)
    squared.refine(samples // 4)
    path_variance = np.maximum(squared.linear() - mean**2, 0)
    on_stone = binary_dilation(picture.cut_map() > 0, np.ones((3, 3)))
    return Seen(mean, variance, path_variance, np.asarray(on_stone), samples)


@dataclass(frozen=True)
class Verdict:
    """How far apart two pictures are."""

    lowest_p: float
    """Two-sided probability of the most different pixel, if the pictures are the same."""
    limit: float
    """Below which that calls them different: Sidak's correction for the number of pixels."""
    beyond_two_sigma: float
    """Part of the pixels of the stones; 0.046 in a normal distribution."""
    mean: float
    """Mean difference, radiance."""
    sigma: float
    """Its standard deviation."""

    @property
    def same(self) -> bool:
        """Whether no pixel is too different to be noise."""
        return self.lowest_p > self.limit

    def __str__(self) -> str:
        return (
            f"lowest p {self.lowest_p:.1e} (limit {self.limit:.1e}), "
            f"{100 * self.beyond_two_sigma:.1f} % beyond 2 sigma, "
            f"mean difference {self.mean:+.1e} ({self.mean / self.sigma:+.1f} sigma)"
        )


def compare(ours: Seen, channel: int, theirs: Reference, exactness: float = 1e-4) -> Verdict:
    """Welch's test in each pixel, with Satterthwaite's degrees of freedom (Biometrics Bulletin 2, 110 (1946)).

    `exactness` is the radiance to which the two skies agree.
    """
    difference = ours.mean[..., channel] - theirs.mean
    floor = np.where(ours.on_stone, EVENTS / theirs.samples, 0) ** 2 + exactness**2
    # Where few samples out of many are different their spread is a guess, and a small one just when too few were: the
    # larger of it and the expected one counts (a score test).
    their_variance = np.maximum(theirs.variance, ours.path_variance[..., channel] / theirs.samples)
    measured = ours.variance[..., channel] + their_variance
    score = difference / np.sqrt(measured + floor)
    spread = ours.variance[..., channel] ** 2 / (ours.samples - 1) + their_variance**2 / (theirs.samples - 1)
    freedom = np.maximum(measured**2 / np.maximum(spread, 1e-300), ours.samples - 1)
    p = 2 * student.sf(abs(score), freedom)
    return Verdict(
        lowest_p=float(p.min()),
        limit=-np.expm1(np.log1p(-SIGNIFICANCE) / p.size),
        beyond_two_sigma=float(((abs(score) > 2) & ours.on_stone).sum() / max(1, ours.on_stone.sum())),
        mean=float(difference.mean()),
        sigma=float(np.sqrt(measured.sum()) / p.size),
    )

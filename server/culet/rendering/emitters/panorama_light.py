"""What a panorama sends to floor and walls, and its few small bright spots, which throw shadows as lamps do.

A panorama is summed once into cells that keep its light times its direction, so that a surface's light is exact in
every cell that is wholly before the surface.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from culet.optics.panoramas import Panorama, check_panorama
from culet.rendering.emitters.lamp_field import ALL, normals
from culet.scene.emitters import RoundLamp

Array = NDArray[np.float64]

ROWS = 256
"""Of cells; twice as many columns."""
FINE_ROWS = 1024
"""Of pixels, at least: one of fewer is seen with others between its own, as kernels see it."""
MOST_SPOTS = 4
BRIGHT = 8.0
"""A spot's radiance over the whole sky's mean, at least."""
SPOT_DEGREES = 10.0
"""Half angle of a spot at most: what is wider is left to the sky."""
SPOT_PART = 0.02
"""Of all the sky's light that a spot sends at least."""


@dataclass(frozen=True, eq=False)
class PanoramaLight:
    """As the panorama's pixels lie, before it is turned; its radiance is the pixels'."""

    moments: Array
    """(C, 3, 3) by cell, channel and axis: the sum of radiance, solid angle and direction."""
    columns: int
    """Of cells, around the sky."""
    spots: tuple[RoundLamp, ...]
    """Brightest first. Their light is among the cells' too."""

    def on_surfaces(self, turn: float, shown: tuple[int, ...]) -> Array:
        """(4, 3) light on floor and walls, as the radiosity of a white surface, turned by so many whole turns."""
        moments = turned(self.moments, turn)
        whole = moments.sum(axis=1)
        cosines = whole @ normals(shown).T
        # Walls are upright: they cut a cell by how far its middle is from them in azimuth, of a cell's width.
        width = np.hypot(whole[:, 0], whole[:, 2])[:, None] * (2 * np.pi / self.columns)
        upright = abs(normals(shown)[:, 1]) < 0.5
        parts = np.where(upright, np.clip(0.5 + cosines / np.maximum(width, 1e-30), 0, 1), cosines > 0)
        received = np.maximum(moments @ normals(ALL).T, 0) * parts.prod(axis=1)[:, None, None]
        return np.asarray(received.sum(axis=0).T / np.pi)


def turned(vectors: Array, turn: float) -> Array:
    """Directions (..., 3) of a panorama's pixels as the sky has them, after so many whole turns about the vertical."""
    cosine, sine = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([cosine * x - sine * z, y, cosine * z + sine * x], axis=-1)


_KNOWN: dict[int, tuple[weakref.ref[Panorama], PanoramaLight]] = {}


def _kept(pixels: Panorama) -> PanoramaLight | None:
    found = None if pixels.flags.writeable else _KNOWN.get(id(pixels))
    return found[1] if found is not None and found[0]() is pixels else None


def is_summed(pixels: Panorama) -> bool:
    """Whether `panorama_light` takes no time. One that can be written to is summed at every call: nothing can be made
    ready."""
    return pixels.flags.writeable or _kept(pixels) is not None


def panorama_light(pixels: Panorama) -> PanoramaLight:
    """Of a panorama; made once for one that nobody can write to, which takes a second. InputError if it is none."""
    if (known := _kept(pixels)) is not None:
        return known
    check_panorama(pixels)
    moments = _moments(pixels)
    found = PanoramaLight(moments, len(moments) // ROWS, _spots(pixels))
    if not pixels.flags.writeable:
        key = id(pixels)
        _KNOWN[key] = weakref.ref(pixels, lambda _: _KNOWN.pop(key, None)), found
    return found


@lru_cache(maxsize=8)
def _light_of(light: PanoramaLight, turn: float, shown: tuple[int, ...]) -> Array:
    found = light.on_surfaces(turn, shown)
    found.flags.writeable = False
    return found


def panorama_on_surfaces(pixels: Panorama, turn_degrees: float, shown: tuple[int, ...]) -> Array:
    """(4, 3) a panorama's light on floor and walls, as the radiosity of a white surface."""
    return _light_of(panorama_light(pixels), turn_degrees / 360, shown)


def _between_pixels(pixels: Panorama) -> Panorama:
    """A small panorama with more pixels, as kernels see it between its own: at the poles a row looks across to its
    other half."""
    height, width = pixels.shape[:2]
    finer = -(-FINE_ROWS // height)
    if finer < 2:
        return pixels
    half = width // 2
    rows = np.concatenate([np.roll(pixels[:1], half, 1), pixels, np.roll(pixels[-1:], half, 1)]).astype(float)
    for axis in (0, 1):
        if axis == 1:
            rows = np.concatenate([rows[:, -1:], rows, rows[:, :1]], axis=1)
        count = (height, width)[axis]
        place = (np.arange(count * finer) + 0.5) / finer + 0.5
        low = np.floor(place).astype(int)
        share = np.expand_dims(place - low, (1, 2) if axis == 0 else (0, 2))
        rows = np.take(rows, low, axis) * (1 - share) + np.take(rows, low + 1, axis) * share
    return rows.astype(np.float32)


def _solid_angles(height: int, width: int) -> Array:
    """(height,) sr of a row's pixels."""
    return -np.diff(np.cos(np.arange(height + 1) * np.pi / height)) * (2 * np.pi / width)


def _moments(pixels: Panorama) -> Array:
    pixels = _between_pixels(pixels)
    height, width = pixels.shape[:2]
    theta = (np.arange(height) + 0.5) * np.pi / height
    azimuth = (np.arange(width) + 0.5) * 2 * np.pi / width
    solid_angle = _solid_angles(height, width)
    row_edges = np.arange(ROWS + 1) * height // ROWS
    columns = np.arange(2 * ROWS) * width // (2 * ROWS) if width >= 2 * ROWS else np.arange(width)
    cells = np.empty((ROWS, len(columns), 3, 3))
    for row, (first, last) in enumerate(pairwise(row_edges)):
        strip = pixels[first:last].astype(float) * solid_angle[first:last, None, None]
        level = np.tensordot(np.sin(theta[first:last]), strip, 1)
        upright = np.tensordot(np.cos(theta[first:last]), strip, 1)
        parts = level * np.sin(azimuth)[:, None], upright, -level * np.cos(azimuth)[:, None]
        cells[row] = np.stack([np.add.reduceat(part, columns, axis=0) for part in parts], axis=-1)
    return cells.reshape(-1, 3, 3).astype(np.float32)


def _spots(pixels: Panorama) -> tuple[RoundLamp, ...]:
    from scipy import ndimage  # few scenes need it, and importing it takes 50 ms

    height, width = pixels.shape[:2]
    grey = pixels.mean(axis=-1, dtype=np.float32)
    solid_angle = _solid_angles(height, width)
    all_light = float(grey.sum(axis=1, dtype=float) @ solid_angle)
    if all_light <= 0:
        return ()
    bright = grey > BRIGHT * all_light / (4 * np.pi)
    labels, _ = ndimage.label(bright, np.ones((3, 3)))
    for row in np.flatnonzero((labels[:, 0] > 0) & (labels[:, -1] > 0)):  # over the seam
        labels[labels == labels[row, -1]] = labels[row, 0]
    found: list[tuple[float, RoundLamp]] = []
    rows, columns = np.nonzero(labels)
    of_pixel = labels[rows, columns]
    theta, azimuth = (rows + 0.5) * np.pi / height, (columns + 0.5) * 2 * np.pi / width
    directions = np.stack([np.sin(theta) * np.sin(azimuth), np.cos(theta), -np.sin(theta) * np.cos(azimuth)], axis=-1)
    for label in np.unique(of_pixel):
        own = of_pixel == label
        weight = grey[rows[own], columns[own]] * solid_angle[rows[own]]
        light = float(weight.sum())
        extent = light**2 / float((grey[rows[own], columns[own]] * weight).sum())  # sr of an even disc
        if light < SPOT_PART * all_light or extent > 2 * np.pi * (1 - np.cos(np.radians(SPOT_DEGREES))):
            continue
        colour = pixels[rows[own], columns[own]].astype(float).T @ solid_angle[rows[own]] / extent
        middle = weight @ directions[own]
        x, y, z = middle / np.linalg.norm(middle)
        found.append((light, _disc((x, y, z), (float(colour[0]), float(colour[1]), float(colour[2])), extent)))
    return tuple(spot for _, spot in sorted(found, key=lambda each: -each[0])[:MOST_SPOTS])


def _disc(direction: tuple[float, float, float], radiance: tuple[float, float, float], solid_angle: float) -> RoundLamp:
    """The round lamp, softened as lamps are, of that solid angle: of 1 - cosine the smoothstep's mean counts."""
    softness = 0.25
    mean = solid_angle / (2 * np.pi)
    # half angle h with mean = ((1 - cos h) + (1 - cos(h (1 - softness)))) / 2, by Newton's method from small angles
    half = np.sqrt(4 * mean / (1 + (1 - softness) ** 2))
    for _ in range(4):
        error = 1 - (np.cos(half) + np.cos(half * (1 - softness))) / 2 - mean
        half -= error / ((np.sin(half) + (1 - softness) * np.sin(half * (1 - softness))) / 2)
    return RoundLamp.model_construct(
        direction=direction, softness=softness, radiance=radiance, half_angle_degrees=float(np.degrees(half))
    )

"""Skies as pictures of all directions: the studio's own, made by code, and those read from files.

A panorama is (height, width, 3) float32 linear radiance, twice as wide as high: the zenith is above, -z at the left
edge, +x a quarter of the way to the right. So has it Mitsuba's `envmap`, and, turned, most files of the kind.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError, SceneError
from culet.scene.sky import ImageEnvironment

Panorama = NDArray[np.float32]

STUDIO_HEIGHT = 512
"""Rows of the studio's own panoramas: a third of a degree each."""


def directions(height: int) -> NDArray[np.float64]:
    """(height, 2 height, 3) unit vectors through the pixels' centres."""
    theta = (np.arange(height) + 0.5) * np.pi / height
    phi = (np.arange(2 * height) + 0.5) * np.pi / height
    sine = np.sin(theta)[:, None]
    return np.stack(
        [sine * np.sin(phi), np.broadcast_to(np.cos(theta)[:, None], (height, 2 * height)), -sine * np.cos(phi)],
        axis=-1,
    )


def _smooth(x: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    t = np.clip((x - low) / (high - low), 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def light_box(height: int = STUDIO_HEIGHT) -> Panorama:
    """A photographer's light box: a bright ceiling, softer sides, a dark slit at the camera's side and below."""
    d = directions(height)
    ceiling = _smooth(d[..., 1], 0.55, 0.65)
    sides = 0.45 * _smooth(d[..., 1], -0.05, 0.05) * (1 - ceiling) * _smooth(np.abs(d[..., 0]), 0.25, 0.35)
    grey = 0.02 + 1.6 * ceiling + sides
    return np.repeat(grey[..., None], 3, axis=-1).astype(np.float32)


def ring_lights(height: int = STUDIO_HEIGHT) -> Panorama:
    """Three thin bright rings about the vertical, as around a lens: many small lights for much fire."""
    elevation = np.degrees(np.arcsin(directions(height)[..., 1]))
    rings = np.max([_smooth(-np.abs(elevation - centre), -2.5, -1.5) for centre in (25, 50, 75)], axis=0)
    return np.repeat((0.02 + 6 * rings)[..., None], 3, axis=-1).astype(np.float32)


HEADS: Mapping[str, float] = {"aset": 15, "ideal-scope": 10}
"""Degrees about the vertical that the observer's head fills: half the angle of its cone. ASET's 30 degrees in all are
AGS's (Sasian et al., Optical Engineering 46, 2007), who show patterns of 40 too."""


def aset(height: int = STUDIO_HEIGHT, head_degrees: float = HEADS["aset"]) -> Panorama:
    """The Angular Spectrum Evaluation Tool's colours by elevation: green to 45 degrees, red above, and blue where the
    observer's head is in the way; nothing from below."""
    elevation = np.degrees(np.arcsin(directions(height)[..., 1]))
    head = 90 - head_degrees
    bands = [(elevation > 0) & (elevation < 45), (elevation >= 45) & (elevation < head), elevation >= head]
    colours = np.array([(0, 1, 0), (1, 0, 0), (0, 0, 1)])
    return np.asarray(np.stack(bands, axis=-1).astype(float) @ colours, np.float32)


def ideal_scope(height: int = STUDIO_HEIGHT, head_degrees: float = HEADS["ideal-scope"]) -> Panorama:
    """The Ideal-Scope's: red around the observer's dark eye; white light from below, so that what leaks is white."""
    elevation = np.degrees(np.arcsin(directions(height)[..., 1]))
    colours = np.zeros((*elevation.shape, 3), np.float32)
    colours[(elevation > 0) & (elevation < 90 - head_degrees)] = (1, 0, 0)
    colours[elevation <= 0] = 1
    return colours


STUDIO: Mapping[str, Callable[[], Panorama]] = {
    "light-box": light_box,
    "ring-lights": ring_lights,
    "aset": aset,
    "ideal-scope": ideal_scope,
}
"""By the name that a scene gives."""


_SOUND: dict[int, weakref.ref[Panorama]] = {}
"""Arrays that passed and that nobody can write to, by identity: a large one takes a tenth of a second to look at."""


def check_panorama(pixels: Panorama) -> None:
    """InputError unless an array is a panorama: (height, width, 3), its radiance finite and not below 0."""
    if not pixels.flags.writeable and (known := _SOUND.get(id(pixels))) is not None and known() is pixels:
        return
    if pixels.ndim != 3 or pixels.shape[-1] != 3 or pixels.size == 0:
        raise InputError(f"panorama: expected an array of (height, width, 3), got {pixels.shape}", "panorama")
    low, high = float(pixels.min()), float(pixels.max())  # NaN if there is one
    if not (0 <= low <= high < math.inf):
        raise InputError(
            f"panorama: expected radiance that is finite and not below 0, got values from {low:.4g} to {high:.4g}",
            "panorama",
        )
    if not pixels.flags.writeable:
        key = id(pixels)
        _SOUND[key] = weakref.ref(pixels, lambda _: _SOUND.pop(key, None))


@lru_cache(maxsize=8)
def _studio(name: str, head_degrees: float | None = None) -> Panorama:
    pixels = _instrument(name, head_degrees) if name in HEADS and head_degrees is not None else STUDIO[name]()
    pixels.flags.writeable = False  # so that what is derived from them is kept, too
    return pixels


def _instrument(name: str, head_degrees: float) -> Panorama:
    return aset(head_degrees=head_degrees) if name == "aset" else ideal_scope(head_degrees=head_degrees)


def panorama_of(environment: ImageEnvironment, uploads: Mapping[str, Panorama]) -> Panorama:
    """The scene's panorama, or SceneError if there is none of that name."""
    if environment.image in STUDIO:
        return _studio(environment.image, environment.head_degrees)
    if environment.image not in uploads:
        raise SceneError(
            f"environment.image: expected {', '.join(STUDIO)} or the id of an upload, got {environment.image!r}",
            "environment.image",
        )
    return uploads[environment.image]

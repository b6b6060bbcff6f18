"""Pictures for the page: what a setting looks like, and where its error is."""

from __future__ import annotations

import base64
import hashlib
import io
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.scene.film import Film
from culet.study.likeness.image_error import as_shown

LEAST, MOST = 1e-3, 1.0
"""Errors, in radiance, that are shown as black and as white; in between the logarithm counts."""
_STOPS = ((0, 0, 0), (60, 15, 110), (190, 55, 85), (250, 160, 30), (255, 255, 255))
"""From dark to bright on paper too: lightness grows all the way."""


def write_pictures(
    folder: Path, key: str, image: NDArray[np.floating[Any]], reference: NDArray[np.float64], film: Film
) -> None:
    """`<digest>.png`, as shown, and `<digest>.error.png`, both as large as the picture."""
    folder.mkdir(parents=True, exist_ok=True)
    shown, error = picture_paths(folder, key)
    bytes_ = np.rint(255 * as_shown(image, film)).astype(np.uint8)
    PIL.Image.fromarray(bytes_).save(shown, optimize=True)
    error_map(image, reference).save(error, optimize=True)


def picture_paths(folder: Path, key: str) -> tuple[Path, Path]:
    """Where a setting's picture and its error's are, if there are any."""
    digest = hashlib.sha256(key.encode()).hexdigest()[:16]
    return folder / f"{digest}.png", folder / f"{digest}.error.png"


def error_map(image: NDArray[np.floating[Any]], reference: NDArray[np.float64]) -> PIL.Image.Image:
    """The largest error of each pixel's channels on a logarithmic scale from LEAST to MOST, in 64 colours."""
    worst = np.abs(image.astype(np.float64) - reference).max(axis=-1)
    decades = np.log(MOST / LEAST)
    level = np.clip(np.log(np.maximum(worst, LEAST) / LEAST) / decades, 0, 1)
    picture = PIL.Image.fromarray(np.rint(63 * level).astype(np.uint8))
    picture.putpalette(_palette().tobytes())
    return picture


def inline(path: Path) -> str:
    """A PNG file as a data URL."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()


def scale_bar() -> str:
    """The error map's colours from LEAST to MOST, as a data URL."""
    picture = PIL.Image.fromarray(np.tile(np.arange(64, dtype=np.uint8), (8, 1)))
    picture.putpalette(_palette().tobytes())
    buffer = io.BytesIO()
    picture.save(buffer, "PNG")
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()


def _palette() -> NDArray[np.uint8]:
    place = np.linspace(0, len(_STOPS) - 1, 64)
    return np.stack([np.interp(place, range(len(_STOPS)), [s[k] for s in _STOPS]) for k in range(3)], -1).astype(
        np.uint8
    )

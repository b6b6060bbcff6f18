"""How far a picture is from its reference to the eye. Needs scikit-image, of `culet[study]`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import color, metrics

from culet.optics.gamut import into_gamut
from culet.optics.tone import tone_map
from culet.scene.film import Film
from culet.study.likeness.radiance_error import Image

_lab: Any = color.rgb2lab  # scikit-image has types for a part of itself only
_deltae: Any = color.deltaE_ciede2000
_ssim: Any = metrics.structural_similarity


def as_shown(image: Image, film: Film) -> NDArray[np.float64]:
    """(height, width, 3) linear radiance as the film shows it, 0 to 1."""
    exposed = film.exposure * np.nan_to_num(image.astype(np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    return np.clip(tone_map(into_gamut(exposed, film.gamut), film.tone_map), 0, 1)


def colour_difference(image: Image, reference: Image, film: Film) -> float:
    """Mean CIEDE2000 of the two as shown: 1 is just noticeable, side by side."""
    return mean_ciede2000(as_shown(image, film), as_shown(reference, film))


def mean_ciede2000(shown: NDArray[Any], reference: NDArray[Any]) -> float:
    """Of two sRGB pictures, in 8 bits or from 0 to 1."""
    return float(np.mean(_deltae(_lab(reference), _lab(shown))))


def chroma(shown: NDArray[Any]) -> NDArray[np.float64]:
    """(height, width) CIELAB chroma of an sRGB picture, in 8 bits or from 0 to 1."""
    lab = np.asarray(_lab(shown), np.float64)
    return np.hypot(lab[..., 1], lab[..., 2])


def structural_similarity(shown: NDArray[np.uint8], reference: NDArray[np.uint8]) -> float:
    """Mean SSIM of two 8-bit pictures, 1 for equal ones (Wang et al., 2004: Gaussian weights of 1.5 pixels)."""
    options = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False, "data_range": 255}
    return float(_ssim(reference, shown, channel_axis=-1, **options))

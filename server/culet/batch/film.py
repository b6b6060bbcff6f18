"""The frames of an animation as a film: H.264 with all colour, by PyAV."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import PIL.Image

from culet.batch.animation import Animation
from culet.errors import InputError
from culet.places import check_place
from culet_client.errors import ClientError
from culet_client.film import LEAST_SECONDS, Film

LOSSLESS = ("png", "webp", "tga")
"""What frames of a film are kept as."""


def check_film(out: Path, frames_per_second: float, image: str) -> None:
    """InputError for a film that could not be made in the end, before anything is rendered."""
    check_place(out, "out", ["mp4"])
    if find_spec("av") is None:
        raise InputError("out: a film needs PyAV: pip install 'culet[video]'; frames go into a folder without", "out")
    if frames_per_second * LEAST_SECONDS > 1:
        raise InputError(f"fps: expected at most {1 / LEAST_SECONDS:g} of a film, got {frames_per_second:g}", "fps")
    if image not in LOSSLESS:
        raise InputError(f"format: expected one of {', '.join(LOSSLESS)} for a film, got {image}", "format")


def write_film(
    animation: Animation, folder: Path, out: Path, frames_per_second: float, progress: Callable[[float], None]
) -> None:
    """Encode the frames that are in the folder; the film is there whole or not at all. InputError if it cannot be."""
    count = len(animation.stages)
    try:
        film = Film(out, (animation.width, animation.height))
        try:
            for number in range(count):
                with PIL.Image.open(animation.file(folder, number)) as picture:
                    film.add_pixels(np.asarray(picture.convert("RGB")), number / frames_per_second)
                progress((number + 1) / count)
            film.finish(count / frames_per_second)
        finally:
            film.discard()
    except ClientError as error:
        raise InputError(f"out: {error}", "out") from error

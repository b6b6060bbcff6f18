"""A still rendered into a file, in this process."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from pathlib import Path

from culet.errors import InputError
from culet.geometry.stone import Stone
from culet.scene import Scene

FORMAT_OF_SUFFIX = {".tga": "tga", ".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".exr": "exr", ".npy": "npy"}

BAND_ROWS = 16
"""Between two looks at the progress bar."""


def still_format(file: Path) -> str:
    """The format that a file's ending names, or InputError."""
    try:
        return FORMAT_OF_SUFFIX[file.suffix.lower()]
    except KeyError:
        raise InputError(
            f"out: expected a name that ends in {', '.join(FORMAT_OF_SUFFIX)}; got {file.name!r}", "out"
        ) from None


def render_to_file(
    scene: Scene,
    stone: Stone | None,
    file: Path,
    width: int,
    height: int,
    samples: int,
    advance: Callable[[float], None] = lambda _: None,
) -> str:
    """Render and write, all of the file or nothing; one line about it. `advance` is told the part done, 0 to 1."""
    from culet.rendering.files import encode
    from culet.rendering.renderer import Renderer

    picture_format = still_format(file)
    started = time.perf_counter()
    picture = Renderer().picture(scene, stone, width, height)
    bands = math.ceil(height / BAND_ROWS)
    for band, _ in enumerate(picture.refine_in_bands(samples, BAND_ROWS), start=1):
        advance(min(band / bands, 1.0))
    write_whole(file, encode(picture, picture_format))
    return (
        f"{file}: {width} x {height}, {samples} samples per pixel, {time.perf_counter() - started:.2f} s, "
        f"mean weight cut off {picture.cut():.2g}"
    )


def write_whole(file: Path, data: bytes) -> None:
    """Write all of it or nothing: a reader never sees half a file. InputError if it cannot be written."""
    part = file.with_name(f".{file.name}.{os.getpid()}.part")  # the same folder: rename is atomic within a file system
    try:
        with part.open("xb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(file)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise InputError(f"out: cannot write {file}: {error.strerror}", "out") from error

"""Pictures as files: 8-bit formats as a screen shows them, EXR and NPY as linear radiance."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR
import PIL.Image

from culet.errors import InputError
from culet.memory_file import path_in_memory
from culet.rendering.renderer import Picture

JPEG_QUALITY = 95


def _pillow(picture: Picture, name: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    PIL.Image.fromarray(picture.rgb()).save(buffer, name, **options)
    return buffer.getvalue()


def _tga(picture: Picture) -> bytes:
    """24 bits, uncompressed, bottom row first, with the footer of TGA 2.0."""
    return _pillow(picture, "TGA")


def _png(picture: Picture) -> bytes:
    return _pillow(picture, "PNG", compress_level=6)


def _jpeg(picture: Picture) -> bytes:
    return _pillow(picture, "JPEG", quality=JPEG_QUALITY, subsampling=0)  # 4:2:0 would blur the fire's colours


def _webp(picture: Picture) -> bytes:
    """Without loss: with it, WebP always keeps colours at half the size."""
    return _pillow(picture, "WEBP", lossless=True, quality=40)  # of the effort, not of the picture


def _exr(picture: Picture) -> bytes:
    """Linear radiance, single precision. The library writes to paths only."""
    pixels = np.ascontiguousarray(picture.linear(), np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with path_in_memory(ending="exr") as path:
        OpenEXR.File(header, {"RGB": pixels}).write(str(path))
        return path.read_bytes()


def _npy(picture: Picture) -> bytes:
    """(height, width, 3) float32, linear radiance."""
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(picture.linear(), np.float32))
    return buffer.getvalue()


ENCODERS: dict[str, Callable[[Picture], bytes]] = {
    "tga": _tga, "png": _png, "jpeg": _jpeg, "jpg": _jpeg, "webp": _webp, "exr": _exr, "npy": _npy,
}  # fmt: skip
"""By format, which is also the file's ending."""


def encode(picture: Picture, format: str) -> bytes:  # noqa: A002 - the field is called so on the wire
    """The picture as a file of that format; InputError names the formats that exist."""
    try:
        encoder = ENCODERS[format]
    except KeyError:
        raise InputError(f"expected a format of {', '.join(ENCODERS)}; got {format!r}", "format") from None
    return encoder(picture)


def write(picture: Picture, path: Path) -> None:
    """Encode by the path's ending and put the file there whole, or not at all."""
    data = encode(picture, path.suffix.lstrip(".").lower())
    descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise

"""Pictures as files: 8-bit formats as a screen shows them, EXR and NPY as linear radiance."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.errors import InputError
from culet.memory_file import path_in_memory
from culet.places import check_place, write_whole

JPEG_QUALITY = 95
NOTHING: Mapping[str, str] = MappingProxyType({})

Developed = NDArray[np.uint8]
"""(height, width, 3), as a screen shows it; of a transparent picture (height, width, 4), alpha last."""
Linear = NDArray[np.floating[Any]]
"""(height, width, 3), linear radiance; (height, width, 4), multiplied by alpha, and alpha."""


def _pillow(rgb: Developed, name: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    PIL.Image.fromarray(rgb).save(buffer, name, **options)
    return buffer.getvalue()


def _tga(rgb: Developed) -> bytes:
    """24 bits, with alpha 32, uncompressed, bottom row first, with the footer of TGA 2.0."""
    return _pillow(rgb, "TGA")


def _png(rgb: Developed) -> bytes:
    return _pillow(rgb, "PNG", compress_level=6)


def _jpeg(rgb: Developed) -> bytes:
    """On white where it is transparent."""
    if rgb.shape[-1] > 3:
        colour, alpha = rgb[..., :3].astype(np.float32), rgb[..., 3:] / np.float32(255)
        rgb = np.rint(alpha * colour + (1 - alpha) * 255).astype(np.uint8)
    return _pillow(rgb, "JPEG", quality=JPEG_QUALITY, subsampling=0)  # 4:2:0 would blur the fire's colours


def _webp(rgb: Developed) -> bytes:
    """Without loss: with it, WebP always keeps colours at half the size."""
    return _pillow(rgb, "WEBP", lossless=True, quality=40)  # of the effort, not of the picture


def _exr(linear: Linear, about: Mapping[str, str] = NOTHING) -> bytes:
    """Linear radiance, single precision, with these attributes. The library writes to paths only."""
    import OpenEXR  # most pictures are no .exr, and importing this takes 15 ms

    pixels = np.ascontiguousarray(linear, np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **about}
    with path_in_memory(ending="exr") as path:
        OpenEXR.File(header, {"RGBA"[: pixels.shape[-1]]: pixels}).write(str(path))
        return path.read_bytes()


def _npy(linear: Linear) -> bytes:
    """float32, linear radiance."""
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(linear, np.float32))
    return buffer.getvalue()


DEVELOPED_ENCODERS: Mapping[str, Callable[[Developed], bytes]] = MappingProxyType(
    {"tga": _tga, "png": _png, "jpeg": _jpeg, "jpg": _jpeg, "webp": _webp}
)
LINEAR_ENCODERS: Mapping[str, Callable[[Linear], bytes]] = MappingProxyType({"exr": _exr, "npy": _npy})
FORMATS = (*DEVELOPED_ENCODERS, *LINEAR_ENCODERS)
"""Each is also the ending of a file's name."""


def encode(format: str, rgb: Callable[[], Developed], linear: Callable[[], Linear]) -> bytes:  # noqa: A002 - so on the wire
    """A picture as a file of that format, which takes one of the two alone: making either may take time.

    InputError names the formats that exist.
    """
    if format in LINEAR_ENCODERS:
        return LINEAR_ENCODERS[format](linear())
    if format in DEVELOPED_ENCODERS:
        return DEVELOPED_ENCODERS[format](rgb())
    raise InputError(f"expected a format of {', '.join(FORMATS)}; got {format!r}", "format")


def write(
    path: Path, rgb: Callable[[], Developed], linear: Callable[[], Linear], about: Mapping[str, str] = NOTHING
) -> None:
    """Encode by the path's ending and put the file there whole, or not at all. An .exr has the attributes of `about`.

    InputError for an ending that no format has, and for a place that cannot be written to.
    """
    check_place(path, "path", FORMATS)
    ending = path.suffix.lstrip(".").lower()
    write_whole(path, _exr(linear(), about) if ending == "exr" else encode(ending, rgb, linear), "path")

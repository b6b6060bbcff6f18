"""Skies as pictures of all directions: the studio's own, made by code, and those read from files.

A panorama is (height, width, 3) float32 linear radiance, twice as wide as high: the zenith is above, -z at the left
edge, +x a quarter of the way to the right. So has it Mitsuba's `envmap`, and, turned, most files of the kind.
"""

from __future__ import annotations

import io
import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import OpenEXR
import PIL.Image
from numpy.typing import NDArray

from culet.errors import InputError, SceneError, TooLargeError
from culet.scene.model import ImageEnvironment

Panorama = NDArray[np.float32]

MOST_PIXELS = 2**25
"""Of a panorama that is read: 8192 x 4096."""
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


def aset(height: int = STUDIO_HEIGHT) -> Panorama:
    """The Angular Spectrum Evaluation Tool's colours by elevation: green to 45 degrees, red to 75, blue above, which is
    where the observer's head is in the way; nothing from below."""
    elevation = np.degrees(np.arcsin(directions(height)[..., 1]))
    bands = [(elevation > 0) & (elevation < 45), (elevation >= 45) & (elevation < 75), elevation >= 75]
    colours = np.array([(0, 1, 0), (1, 0, 0), (0, 0, 1)])
    return np.asarray(np.stack(bands, axis=-1).astype(float) @ colours, np.float32)


STUDIO: Mapping[str, Callable[[], Panorama]] = {"light-box": light_box, "ring-lights": ring_lights, "aset": aset}
"""By the name that a scene gives."""


@lru_cache(maxsize=4)
def _studio(name: str) -> Panorama:
    return STUDIO[name]()


def panorama_of(environment: ImageEnvironment, uploads: Mapping[str, SkyPicture]) -> Panorama:
    """The scene's panorama, or SceneError if there is none of that name."""
    if environment.image in STUDIO:
        return _studio(environment.image)
    if environment.image not in uploads:
        raise SceneError(
            f"environment.image: expected {', '.join(STUDIO)} or the id of an upload, got {environment.image!r}",
            "environment.image",
        )
    return uploads[environment.image].pixels


@dataclass(frozen=True, eq=False)
class SkyPicture:
    """What a file of a sky held."""

    pixels: Panorama
    findings: tuple[str, ...] = ()
    """What was found in the file and what was done about it, a sentence each."""


def read_sky(data: bytes, file_type: str) -> SkyPicture:
    """From an equirectangular .exr or .hdr (linear) or .png (sRGB) file; InputError says what is wrong with it."""
    readers = {"exr": _read_exr, "hdr": _read_hdr, "png": _read_png}
    if file_type not in readers:
        raise InputError(f"expected a sky as .exr, .hdr or .png, got {file_type!r}", "file")
    try:
        pixels = readers[file_type](data)
    except InputError:
        raise
    except Exception as error:  # three libraries, as many ways to fail
        raise InputError(f"expected a readable .{file_type} picture, got a damaged or another file", "file") from error
    if not np.isfinite(pixels).all() or (pixels < 0).any():
        raise InputError("expected a sky of finite radiance, not negative; got NaN, infinity or less than 0", "file")
    panorama = np.ascontiguousarray(pixels, np.float32)
    return SkyPicture(panorama, tuple(_findings(panorama)))


def _findings(panorama: Panorama) -> list[str]:
    height, width, _ = panorama.shape
    found = []
    if width != 2 * height:
        found.append(f"{width} x {height} pixels are stretched over all directions, which need twice the width.")
    if not np.any(panorama):
        found.append("All of it is black.")
    return found


def _check_size(width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise TooLargeError(f"expected a sky of at most {MOST_PIXELS} pixels, got {width} x {height}", "file")
    if width < 2 or height < 1:
        raise InputError(f"expected a sky of at least 2 x 1 pixels, got {width} x {height}", "file")


def _read_png(data: bytes) -> NDArray[np.floating]:
    with PIL.Image.open(io.BytesIO(data), formats=["PNG"]) as picture:
        _check_size(*picture.size)
        encoded = np.asarray(picture.convert("RGB")) / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1


def _read_exr(data: bytes) -> NDArray[np.floating]:
    """The library reads paths only."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sky.exr"
        path.write_bytes(data)
        with OpenEXR.File(str(path), header_only=True) as file:
            lower, upper = file.header()["dataWindow"]
            _check_size(int(upper[0] - lower[0]) + 1, int(upper[1] - lower[1]) + 1)
        with OpenEXR.File(str(path)) as file:
            channels = file.channels()
            name = next((name for name in ("RGB", "RGBA", "Y") if name in channels), None)
            if name is None:
                raise InputError(f"expected channels RGB, RGBA or Y, got {', '.join(channels)}", "file")
            pixels = np.asarray(channels[name].pixels, np.float32)
    return pixels[..., :3] if pixels.ndim == 3 else np.repeat(pixels[..., None], 3, axis=-1)


def _read_hdr(data: bytes) -> NDArray[np.floating]:
    """Radiance's RGBE (G. Ward, Real Pixels, Graphics Gems II, 1991), plain or with new run-length encoding."""
    head = re.match(rb"#\?\w+\n(?:[^\n]*\n)*?\n-Y (\d{1,5}) \+X (\d{1,5})\n", data[:4096])
    if head is None or b"FORMAT=32-bit_rle_rgbe" not in head[0]:
        raise InputError("expected a Radiance header of 32-bit_rle_rgbe and -Y height +X width", "file")
    height, width = int(head[1]), int(head[2])
    _check_size(width, height)
    raw = np.frombuffer(data, np.uint8, offset=head.end())
    if 8 <= width < 32768 and len(raw) >= 4 and raw[0] == raw[1] == 2:
        rgbe, position = np.empty((height, 4, width), np.uint8), 0
        for row in rgbe:
            position = _read_scanline(raw, position, row)
        rgbe = rgbe.transpose(0, 2, 1)
    else:
        if len(raw) < 4 * width * height:
            raise InputError(f"expected {4 * width * height} bytes of pixels, got {len(raw)}", "file")
        rgbe = raw[: 4 * width * height].reshape(height, width, 4)
    scale = np.ldexp(1.0, rgbe[..., 3:].astype(int) - 136)
    return np.where(rgbe[..., 3:] > 0, (rgbe[..., :3] + 0.5) * scale, 0)


def _read_scanline(raw: NDArray[np.uint8], position: int, row: NDArray[np.uint8]) -> int:
    """Four runs of components; returns where the next scanline begins."""
    width = row.shape[1]
    if bytes(raw[position : position + 4]) != bytes([2, 2, width >> 8, width & 255]):
        raise InputError(f"expected a scanline of {width} pixels at byte {position}", "file")
    position += 4
    for component in row:
        filled = 0
        while filled < width:
            if position + 1 >= len(raw):
                raise InputError("the picture ends in the middle of a scanline", "file")
            count = int(raw[position])
            run, length = count > 128, count - 128 if count > 128 else count
            if length == 0 or filled + length > width:
                raise InputError(f"a run of {length} pixels does not fit at byte {position}", "file")
            source = raw[position + 1 : position + 2] if run else raw[position + 1 : position + 1 + length]
            if not run and len(source) < length:
                raise InputError("the picture ends in the middle of a scanline", "file")
            component[filled : filled + length] = source
            filled += length
            position += 2 if run else 1 + length
    return position

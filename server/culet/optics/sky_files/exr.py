"""OpenEXR pictures: which of their parts and channels are the sky, and what their header says of the numbers.

The standard attributes are those of the OpenEXR documentation, Standard Attributes. Those that say nothing about a
panorama's radiance or directions (owner, comments, time codes, the camera's place and the like) are left unread, and so
is the size that a picture should have on a screen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.panoramas import Panorama
from culet.optics.sky_files.colour import (
    NAMES,
    REC_709,
    Chromaticity,
    Primaries,
    conversion_finding,
    converted,
    name_of,
    to_rec709,
    to_xyz,
)
from culet.optics.sky_files.decoder import Decoder, decoding
from culet.optics.sky_files.picture import Allocate, Census, check_size

INTEROP_PRIMARIES = {
    "lin_rec709_scene": REC_709,
    "lin_p3d65_scene": NAMES["Display P3"],
    "lin_rec2020_scene": NAMES["Rec. 2020"],
    "lin_adobergb_scene": NAMES["Adobe RGB"],
    "lin_ap0_scene": NAMES["ACES AP0"],
    "lin_ap1_scene": NAMES["ACES AP1"],
    "lin_ciexyzd65_scene": NAMES["CIE XYZ"],
}
"""Linear colour spaces by the names of the Color Interop Forum, for the attribute colorInteropID."""
UNSAID = ("", "unknown", "data", "raw")
MOST_PARTS = 64
"""That are looked through for a sky."""
SHOWN_NAMES = 8
"""Channels, layers or parts named in one sentence."""


@dataclass(frozen=True)
class Channels:
    """Which channels of a part are the sky, by their numbers."""

    colours: tuple[int, ...]
    """Red, green, blue; or luminance alone; or luminance and chroma: Y, RY, BY."""
    chroma: bool
    alpha: int | None
    layer: str
    """What their names begin with."""

    @property
    def used(self) -> tuple[int, ...]:
        """All of them."""
        return self.colours if self.alpha is None else (*self.colours, self.alpha)


@dataclass
class PixelsRead:
    """What is known when the pixels have been read."""

    transparent: int = 0
    outside: int = 0
    """Pixels whose colours Rec. 709 does not have."""


def read_exr(data: bytes, max_pixels: int, allocate: Allocate, census: Census) -> Panorama:
    """(height, width, 3) linear radiance; InputError."""
    with decoding(data, "exr") as decoder:
        channels, notes = _sky_part(decoder)
        spec = decoder.spec
        check_size(spec.full_width, spec.full_height, max_pixels)
        check_size(spec.width, spec.height, 2 * max_pixels)  # its data window, of which less may be seen
        _refuse_unusable(decoder, channels)
        primaries = _primaries(decoder)
        matrix = to_rec709(primaries, _neutral(decoder))
        luminance = to_xyz(primaries)[1]
        pixels = allocate((spec.full_height, spec.full_width, 3))
        window = _Window(decoder)
        first_channel = min(channels.used)
        seen = PixelsRead()
        for first, rows in decoder.rows(first_channel, max(channels.used) + 1 - first_channel):
            colours = _colours(rows, channels, first_channel, luminance)
            if channels.alpha is not None:
                seen.transparent += int((rows[..., channels.alpha - first_channel] < 1).sum())
            if matrix is not None:
                colours, outside = converted(colours, matrix)
                seen.outside += outside
            window.put(colours, first, pixels, census)
        census.findings += [*notes, *_notes(decoder), *window.findings()]
    if matrix is not None:
        census.findings.append(conversion_finding(name_of(primaries), seen.outside))
    if seen.transparent:
        census.findings.append(f"{seen.transparent} pixels are transparent; black is behind them.")
    return pixels


class _Window:
    """Where the data window's pixels are in the display window, which is the sky."""

    def __init__(self, decoder: Decoder) -> None:
        spec = decoder.spec
        self.left, self.top = spec.x - spec.full_x, spec.y - spec.full_y
        self.width, self.height = spec.full_width, spec.full_height
        self.begin, self.end = max(0, self.left), min(self.width, self.left + spec.width)
        self.given = spec.width * spec.height
        self.covered = 0

    def put(self, colours: NDArray[np.float32], first: int, pixels: Panorama, census: Census) -> None:
        """Some rows of the data window, the first of that number."""
        top = self.top + first
        low, high = max(0, top), min(self.height, top + len(colours))
        if low >= high or self.begin >= self.end:
            return
        seen = colours[low - top : high - top, self.begin - self.left : self.end - self.left]
        census.count(seen, low)
        pixels[low:high, self.begin : self.end] = seen
        self.covered += (high - low) * (self.end - self.begin)

    def findings(self) -> list[str]:
        """Unless both windows are one."""
        if self.covered < self.width * self.height:
            pixels = f"{self.covered} of the sky's {self.width * self.height} pixels"
            return [f"The file has {pixels} (its data window is not all of its display window); the others are black."]
        return ["Pixels beyond the display window were left out."] if self.given > self.covered else []


def _sky_part(decoder: Decoder) -> tuple[Channels, list[str]]:
    """Go to the first part that has a sky's channels; they, and what to say of the others."""
    seen: list[str] = []
    deep = False
    for part in range(MOST_PARTS):
        if not decoder.go_to(part):
            break
        deep = deep or bool(decoder.spec.deep)
        channels = None if decoder.spec.deep else _channels(decoder.channels)
        if channels is None:
            seen += decoder.channels
            continue
        notes = []
        parts = decoder.attribute("oiio:subimages")
        if isinstance(parts, int) and parts > 1:
            name = decoder.attribute("name") or f"number {part + 1}"
            notes.append(f"The file has {parts} parts; {name} was taken.")
        return channels, notes
    if deep:
        raise InputError("expected a flat picture, got deep data: several values at several depths for a pixel", "file")
    raise InputError(f"expected channels R, G and B, or Y; got {_listed(seen)}", "file")


def _channels(names: Sequence[str]) -> Channels | None:
    """The sky's, or None if there are none; InputError if several layers could be it."""
    layers: dict[str, dict[str, int]] = {}
    for number, name in enumerate(names):
        layer, _, last = name.rpartition(".")
        layers.setdefault(layer, {}).setdefault(last, number)
    usable = {layer: found for layer, own in layers.items() if (found := _of_layer(layer, own)) is not None}
    if "" in usable:
        return usable[""]
    if len(usable) > 1:
        raise InputError(
            f"expected one layer with channels R, G and B, or Y, or channels without a layer; got {_listed(usable)}",
            "file",
        )
    return next(iter(usable.values()), None)


def _of_layer(layer: str, own: dict[str, int]) -> Channels | None:
    for wanted, chroma in ((("R", "G", "B"), False), (("Y", "RY", "BY"), True)):
        if all(name in own for name in wanted):
            return Channels(tuple(own[name] for name in wanted), chroma, own.get("A"), layer)
    if "Y" in own and not {"X", "Z"} & own.keys():  # a normal or a place has a y too
        return Channels((own["Y"],), False, own.get("A"), layer)
    return None


def _refuse_unusable(decoder: Decoder, channels: Channels) -> None:
    formats = list(decoder.spec.channelformats) or [decoder.spec.format] * len(decoder.channels)
    whole = [decoder.channels[number] for number in channels.used if str(formats[number]) not in ("half", "float")]
    if whole:
        raise InputError(f"expected channels of half or float, got {_listed(whole)} of whole numbers (uint)", "file")
    if "cube" in str(decoder.attribute("textureformat") or "").lower():
        raise InputError("expected an environment map of latitude and longitude, got one of a cube's faces", "file")


def _primaries(decoder: Decoder) -> Primaries:
    """Those that the header gives, or Rec. 709's, as the format has it for a header that gives none."""
    given = decoder.attribute("chromaticities")
    if given is not None:
        red, green, blue, white = [(float(given[i]), float(given[i + 1])) for i in (0, 2, 4, 6)]
        return Primaries(red, green, blue, white)
    space = str(decoder.attribute("colorInteropID") or "")
    if space in UNSAID:
        return REC_709
    if space not in INTEROP_PRIMARIES:
        raise InputError(f"expected a colorInteropID of {', '.join(INTEROP_PRIMARIES)}; got {space[:60]!r}", "file")
    return INTEROP_PRIMARIES[space]


def _neutral(decoder: Decoder) -> Chromaticity | None:
    """What is to look white, if that is not the white of the primaries."""
    given = decoder.attribute("adoptedNeutral")
    return None if given is None else (float(given[0]), float(given[1]))


def _colours(
    rows: NDArray[np.float32], channels: Channels, first: int, luminance: NDArray[np.float64]
) -> NDArray[np.float32]:
    """(n, width, 3) red, green, blue. Of luminance and chroma: RY = (R - Y) / Y, BY likewise, and Y is the weighted sum
    (OpenEXR, ImfRgbaYca.h)."""
    parts = [rows[..., number - first] for number in channels.colours]
    if not channels.chroma:
        return np.stack(parts * (3 // len(parts)), axis=-1)
    y, ry, by = parts
    red, blue = (ry + 1) * y, (by + 1) * y
    green = (y - np.float32(luminance[0]) * red - np.float32(luminance[2]) * blue) / np.float32(luminance[1])
    return np.stack([red, green, blue], axis=-1)


def _notes(decoder: Decoder) -> list[str]:
    """What the header says that a sky has no use for, if it could matter to whoever made it."""
    notes = []
    white = decoder.attribute("whiteLuminance")
    if white is not None:
        notes.append(
            f"The header gives white as {float(white):g} cd/m\u00b2 (whiteLuminance); radiance was left as it is."
        )
    transforms = {name: decoder.attribute(name) for name in ("renderingTransform", "lookModTransform")}
    notes += [f"The {name} {str(value)[:60]!r} was not applied." for name, value in transforms.items() if value]
    aspect = decoder.attribute("PixelAspectRatio")
    if aspect not in (None, 1.0):
        notes.append(f"The header's pixel aspect ratio of {float(aspect):g} was not used: a sky covers all directions.")
    views = decoder.attribute("multiView")
    if views:
        views = [views] if isinstance(views, str) else list(views)
        notes.append(f"The file has views {_listed(views)}; {views[0]} was taken.")
    return notes


def _listed(names: Sequence[str] | dict[str, Channels]) -> str:
    shown = ", ".join(str(name)[:40] for name in list(names)[:SHOWN_NAMES])
    return f"{shown} and {len(names) - SHOWN_NAMES} more" if len(names) > SHOWN_NAMES else shown or "none"

"""OpenImageIO, as a decoder of bytes that need not be what they say they are."""

from __future__ import annotations

import contextlib
import io
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO
from numpy.typing import NDArray

from culet.errors import InputError
from culet.memory_file import path_in_memory

OpenImageIO.attribute("threads", 1)  # a reader has one processor's time
OpenImageIO.attribute("exr_threads", -1)

MAGIC = {"png": b"\x89PNG\r\n\x1a\n", "exr": b"\x76\x2f\x31\x01", "hdr": b"#?"}
"""How files begin: only then may the library, which knows many more formats, look at them."""

ROWS_PIXELS = 2**18
"""Pixels decoded at a time: a megabyte for each channel, beside the picture itself."""


class Decoder:
    """An open picture, its rows decoded as they are asked for."""

    def __init__(self, source: Any, name: str, path: str) -> None:  # noqa: ANN401 - the library has no types
        self._source = source
        self._name = name
        self._path = path
        self._part = 0
        self.spec = source.spec()
        """The library's description of the part that is read."""

    @property
    def channels(self) -> list[str]:
        """Names, in the order of the file."""
        return list(self.spec.channelnames)

    def attribute(self, name: str) -> Any:  # noqa: ANN401 - of any type
        """A value of the header, or None."""
        return self.spec.getattribute(name)

    def go_to(self, part: int) -> bool:
        """Read from that part of the file from now on; whether there is one."""
        if not self._source.seek_subimage(part, 0):
            self._source.geterror()
            return False
        self.spec, self._part = self._source.spec(), part
        return True

    def rows(self, first_channel: int = 0, channels: int | None = None) -> Iterator[tuple[int, NDArray[np.float32]]]:
        """From the top: number of the first row, and (n, width, channels) float32; whole numbers as 0 to 1.

        InputError with the decoder's reason if the file is cut off or damaged.
        """
        spec = self.spec
        end = spec.nchannels if channels is None else first_channel + channels
        step = max(1, ROWS_PIXELS // max(1, spec.width))
        step = max(step, spec.tile_height) // max(1, spec.tile_height) * max(1, spec.tile_height)
        for row in range(0, spec.height, step):
            last = min(row + step, spec.height)
            read = self._read(spec.y + row, spec.y + last, first_channel, end)
            if read is None:
                raise InputError(f"the .{self._name} picture is damaged or cut off: {self._complaint()}", "file")
            yield row, read.reshape(last - row, spec.width, end - first_channel)

    def _read(self, begin: int, end: int, first: int, last: int) -> Any:  # noqa: ANN401 - the library has no types
        spec, number = self.spec, OpenImageIO.FLOAT
        if spec.tile_width:
            across = spec.x, spec.x + spec.width
            return self._source.read_tiles(self._part, 0, *across, begin, end, 0, 1, first, last, number)
        return self._source.read_scanlines(self._part, 0, begin, end, 0, first, last, number)

    def _complaint(self) -> str:
        return _one_line(self._source.geterror(), self._path) or "its pixels cannot be decoded"


@contextlib.contextmanager
def decoding(data: bytes, name: str, **hints: int) -> Iterator[Decoder]:
    """Open a file of that format; InputError with the decoder's reason if it is none."""
    if not data.startswith(MAGIC[name]):
        raise InputError(f"expected a .{name} picture, which begins with {MAGIC[name]!r}; got {data[:8]!r}", "file")
    with path_in_memory(data, ending=name) as file:
        path = str(file)
        config = OpenImageIO.ImageSpec()
        for hint, value in hints.items():
            config.attribute(hint, value)
        source = _opened(path, config)
        if source is None:
            OpenImageIO.geterror()  # of the last format that it tried, whichever that was
            complaint = _reason_of_exr(data) if name == "exr" else "its header cannot be read"
            raise InputError(f"the .{name} picture is damaged, or cut off, or of an unknown kind: {complaint}", "file")
        try:
            yield Decoder(source, name, path)
        finally:
            source.close()


def _opened(path: str, config: Any) -> Any:  # noqa: ANN401 - the library has no types
    """By the newer of the library's two decoders of EXR, or by the older, which alone knows subsampled chroma."""
    for core in (1, 0):
        OpenImageIO.attribute("openexr:core", core)
        source = OpenImageIO.ImageInput.open(path, config)
        if source is not None:
            return source
    return None


def _reason_of_exr(data: bytes) -> str:
    """Why a file has no header of pixels that can be read, by OpenEXR itself."""
    try:
        with OpenEXR.File(io.BytesIO(data), header_only=True) as file:
            header = file.header()
            windows = [(high - low + 1).tolist() for low, high in (header["displayWindow"], header["dataWindow"])]
            for channel in header["channels"]:
                if (channel.xSampling, channel.ySampling) != (1, 1):
                    return f"its channel {channel.name[:40]} has fewer pixels than others (sampling)"
    except Exception as error:  # the library raises what it likes
        return _one_line(error, "")
    width, height = max(windows, key=math.prod)
    return f"it may be too large: a window of {width} x {height} pixels" if windows else "its header cannot be read"


def _one_line(complaint: object, path: str) -> str:
    return " ".join(str(complaint).replace(path or "\0", "the file").split())[:200]

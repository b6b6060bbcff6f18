"""How large a moving frame may be, and how well encoded, so that a viewer's link carries it in time.

Beside the governor, which has time in mind: both choose the best that there is room for. What frames of each size and
JPEG quality have in bytes, and what they miss, `python -m culet.study.stream.bytes_ladder` has measured on the default
scene, and `python -m culet.study.stream.video_ladder` the same of video by its rate factor.
Another scene's frames have other bytes: how many times the measured ones, the last frames tell.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

BEST_CRF = 20
"""Constant rate factor of x264 at which a moving frame is as good as a JPEG of quality 85, in half of its bytes."""
LEAST_PIXELS = 640 * 360
"""Of a frame, below which none is made smaller for a link, unless for SLOW_RATE."""
SLOW_RATE = 15.0
"""Frames per second for which a frame is made smaller than LEAST_PIXELS: with fewer the eye sees single pictures. Of a
link that does not carry as many of LEAST_PIXELS as were asked for, fewer of them are asked."""
MEMORY = 0.3
"""Weight of the latest frame in how many times the measured bytes frames have,"""
GROWN = 1.3
"""but one that has so many times the bytes that were expected counts in full: the next must not be as large."""
FINAL_TIMES = 4
"""Times the bytes of pictures at rest that the final one may have: some 3 s of a link, while the one before is seen;
some 4 s of the slowest one of use where nothing is known of it (`FIRST_BYTES` and `REST_SECONDS` of gateways)."""
WORTH = 0.96
"""A frame of another size must be expected to miss less than so many times what one of this size would: or with each
small change of the link the picture would change its size."""

Grid = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class ByteLadder:
    """Of moving frames of the default scene at 1280x720, times the scale each way."""

    scales: Grid
    """(scales,), falling."""
    qualities: tuple[int, ...]
    """Of JPEG, falling; or rate factors of video, rising: the best first."""
    bytes: Grid
    """(scales, qualities)"""
    errors: Grid
    """(scales, qualities), root mean square of what is shown, 0 to 1."""
    pixels: int
    """Of scale 1."""

    def expected(self, pixels: float) -> Grid:
        """(qualities,) bytes of a frame of so many pixels: beyond those measured, as the nearest two let expect."""
        known = 2 * np.log(self.scales[::-1]) + math.log(self.pixels)
        upper = min(max(int(np.searchsorted(known, math.log(pixels))), 1), len(known) - 1)
        weight = (math.log(pixels) - known[upper - 1]) / (known[upper] - known[upper - 1])
        rising = np.log(self.bytes[::-1])
        mixed: Grid = np.exp((1 - weight) * rising[upper - 1] + weight * rising[upper])
        return mixed

    @lru_cache(maxsize=64)  # noqa: B019 - there are two ladders
    def expected_of_scales(self, pixels: int) -> Grid:
        """(scales, qualities) bytes of a frame, for a viewer that asked for so many pixels."""
        return np.stack([self.expected(pixels * float(scale) ** 2) for scale in self.scales])


@dataclass(frozen=True)
class ByteRoom:
    """That a link has for a frame."""

    bytes: float
    """For frames as often as they can be made."""
    slow_bytes: float
    """For SLOW_RATE frames a second."""


@dataclass(frozen=True)
class ByteAllowance:
    """Bytes that a viewer's link has for each frame of a session; None: as many as one likes."""

    per_frame: int | None = None
    """Of a moving one, if frames come as often as the session's balance asks for."""
    at_rest: int | None = None
    """Of a picture at rest."""

    def resting(self, *, final: bool) -> float:
        """Bytes of a picture at rest, at most. One that is `final` is all that will come: it is worth more time."""
        return math.inf if self.at_rest is None else self.at_rest * (FINAL_TIMES if final else 1)

    def room(self, asked: float, made: float) -> ByteRoom | None:
        """For frames that are asked for, and can be made, so many times a second."""
        if self.per_frame is None:
            return None
        each_second = asked * self.per_frame
        return ByteRoom(each_second / max(min(asked, made), min(asked, SLOW_RATE)), each_second / min(asked, SLOW_RATE))


NO_LIMITS = ByteAllowance()


@dataclass(frozen=True)
class Encoding:
    """How a frame is to be encoded."""

    quality: int
    """Of JPEG, at most."""
    most_bytes: float
    """It is encoded anew if it has more."""
    thrifty: bool
    """The frame, or its quality, is less than it would be without the limits of a link."""
    crf: int = BEST_CRF
    """Constant rate factor of video."""
    reduced: bool = False
    """The frame is smaller than it would be without the limits of a link."""


class Thrift:
    """Of one session's moving frames."""

    def __init__(self, ladder: ByteLadder) -> None:
        self._ladder = ladder
        self._times = 1.0
        """Bytes of its frames over the measured ones."""
        self._row = 0
        """Of the scale chosen last."""

    def scale(self, wanted: tuple[int, int], room: ByteRoom) -> float:
        """Of width and height that the viewer asked for, for the next moving frame: the one that misses least."""
        pixels, scales = wanted[0] * wanted[1], self._ladder.scales
        expected = self._times * self._ladder.expected_of_scales(pixels)
        large = (scales == 1) | (pixels * scales**2 >= LEAST_PIXELS)
        chosen = self._best(expected <= room.bytes, large)
        if chosen is None:
            chosen = self._best(expected <= room.slow_bytes, scales > 0)
        self._row = len(scales) - 1 if chosen is None else chosen
        return float(scales[self._row])

    def encoding(self, size: tuple[int, int], room: ByteRoom) -> Encoding:
        """Of a frame of that size: of the best quality for which there is room, or the least."""
        expected = self._times * self._ladder.expected(size[0] * size[1])
        best, *_, least = self._ladder.qualities
        for most in (room.bytes, room.slow_bytes):
            for quality, count in zip(self._ladder.qualities, expected, strict=True):
                if count <= most:
                    return Encoding(quality, GROWN * most, thrifty=quality != best)
        return Encoding(least, math.inf, thrifty=True)  # what is smaller yet shows nothing: fewer come

    def encoded(self, size: tuple[int, int], quality: int, count: int) -> None:
        """A moving frame of that size and quality had so many bytes."""
        qualities = self._ladder.qualities
        nearest = min(range(len(qualities)), key=lambda place: abs(qualities[place] - quality))
        times = count / float(self._ladder.expected(size[0] * size[1])[nearest])
        weight = 1.0 if times > GROWN * self._times else MEMORY
        self._times += weight * (times - self._times)

    def _best(self, fits: NDArray[np.bool_], allowed: NDArray[np.bool_]) -> int | None:
        """Row of the scale of least error among those allowed, or of the one chosen last if that is nearly as good;
        None if nothing fits. `fits` is (scales, qualities), `allowed` (scales,)."""
        errors = np.where(fits & allowed[:, None], self._ladder.errors, math.inf).min(axis=1)
        least = float(errors.min())
        if math.isinf(least):
            return None
        return self._row if WORTH * errors[self._row] <= least else int(errors.argmin())


@cache
def read_byte_ladder() -> ByteLadder:
    """Of JPEG, as measured."""
    return _read("bytes_ladder.json")


@cache
def read_video_ladder() -> ByteLadder:
    """Of H.264, as measured; its qualities are rate factors."""
    return _read("video_ladder.json")


def _read(name: str) -> ByteLadder:
    document = json.loads(files(__package__).joinpath(name).read_text(encoding="utf-8"))
    measured = document["measured"]
    return ByteLadder(
        np.array(document["scales"]),
        tuple(document["qualities"]),
        np.array(document["bytes"], float),
        np.array(document["errors"], float),
        measured["width"] * measured["height"],
    )

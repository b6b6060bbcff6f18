"""A frame: a fixed header of little-endian fields, then the encoded picture, in one message.

The same bytes travel over ZeroMQ and WebSocket. They begin with the session's watch id, which is the ZeroMQ topic,
since topics match by prefix; a single part lets a native viewer use SUB with CONFLATE, which keeps only the latest.
Watch id, mark and version stay where they are in every version, so that a reader of another one can say so.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import NamedTuple

MAGIC = b"CULT"
HEADER_VERSION = 6

REFUSED = 0
"""In place of a codec: the payload is a sentence in UTF-8 about why there are no frames by this topic."""


class Codec(IntEnum):
    """How the payload is encoded."""

    JPEG = 1
    PNG = 2
    H264 = 3
    """One access unit in Annex B, High 4:4:4 Predictive; a key frame has its parameter sets with it."""
    VP9 = 4
    """One frame of profile 1, 4:4:4."""


class Flags(IntFlag):
    """What is special about a frame."""

    NONE = 0
    MOVING = 1
    """A stone is falling."""
    FINAL = 2
    """The picture is as good as pictures at rest become, by its error or at the limit of samples: nothing better will
    come until something changes."""
    POLARISED = 4
    """Light was followed with its polarisation."""
    FRONTIER = 8
    """The error is not of this picture: it is what the measured front of error against time says of its settings."""
    ABOVE = 16
    """No stone is seen, and the whole of the one nearest to the camera is beyond the picture's upper edge.
    Likewise those that follow."""
    BELOW = 32
    LEFT = 64
    RIGHT = 128
    BEHIND = 256
    """Behind the camera; then none of the other four is set."""
    SLOW = 512
    """Stones move slower than in real time: their steps, and those of others, take longer than there is time for."""
    KEY = 1024
    """The picture can be shown without any before it. A frame without this flag needs the one that it depends on."""
    SHADOWS_ONLY = 2048
    """Floor and walls show what stones take of the light, and not what goes through them: that would take too long
    while things move, or the scene asks for it."""
    THRIFTY = 4096
    """The picture is smaller, or encoded with more loss, than it would be without the limits of a viewer's link. It is
    not set of a final picture with no more loss than those before it, though without limits it would have none."""


class FrameError(ValueError):
    """Bytes that are not a frame; says what was expected and what came."""


class HeaderField(NamedTuple):
    """One field of the header; the generator reads this table for the other languages."""

    name: str
    format: str
    meaning: str


FIELDS = (
    HeaderField("watch", "16s", "watch id of the session, in hexadecimal digits; the ZeroMQ topic"),
    HeaderField("magic", "4s", "CULT"),
    HeaderField("version", "B", "version of this header"),
    HeaderField("codec", "B", "1 JPEG, 2 PNG, 3 H.264, 4 VP9"),
    HeaderField(
        "flags",
        "H",
        "bits: 0 moving, 1 final, 2 polarised, 3 frontier's error, 4-8 no stone seen, 9 slow, 10 key, 11 shadows only",
    ),
    HeaderField("sequence", "I", "number of the frame in its session, from 1"),
    HeaderField("depends_on", "I", "number of the frame that this one can be decoded after; 0 of a key frame"),
    HeaderField("width", "H", "pixels"),
    HeaderField("height", "H", "pixels"),
    HeaderField("samples", "I", "samples per pixel in this picture"),
    HeaderField("bands", "B", "wavelengths that were followed; 3: one for each channel"),
    HeaderField("max_bounces", "I", "reflections after which a chain of light was cut"),
    HeaderField("cutoff", "f", "weight below which a chain of light was ended, 0 to 1"),
    HeaderField("step", "Q", "number of the state shown; names the frame for frame.tga?step="),
    HeaderField("simulation_time", "d", "s since the stones were put at their start"),
    HeaderField("timestamp", "d", "s since the Unix epoch, engine's clock, when encoded"),
    HeaderField("simulate_ms", "f", "milliseconds spent on the simulation before the picture's first sample"),
    HeaderField("render_ms", "f", "milliseconds spent on rendering, all samples"),
    HeaderField("encode_ms", "f", "milliseconds spent on tone mapping and encoding"),
    HeaderField("cut", "f", "mean weight of what the cut-off dropped, 0 to 1"),
    HeaderField("error", "f", "root mean square error of radiance: estimated, or the frontier's (bit 3), or NaN"),
    HeaderField("light_cut", "f", "part of the stones' light that floor and walls miss, at most; NaN without a map"),
    HeaderField("light_error", "f", "root mean square error of the light map, estimated; NaN without a map"),
    HeaderField("shown_error", "f", "root mean square error of what is shown, 0 to 1, estimated; NaN if not known"),
    HeaderField("rest_error", "f", "that it is refined to while nothing changes; NaN of a first sample"),
    HeaderField("length", "I", "bytes of payload that follow"),
)

LAYOUT = struct.Struct("<" + "".join(field.format for field in FIELDS))
HEADER_SIZE = LAYOUT.size


@dataclass(frozen=True)
class Frame:
    """One picture of one session; see FIELDS for units."""

    watch: bytes
    codec: Codec
    flags: Flags
    sequence: int
    width: int
    height: int
    samples: int
    bands: int
    max_bounces: int
    cutoff: float
    step: int
    simulation_time: float
    timestamp: float
    simulate_ms: float
    render_ms: float
    encode_ms: float
    cut: float
    error: float
    payload: bytes
    depends_on: int = 0
    light_cut: float = math.nan
    light_error: float = math.nan
    shown_error: float = math.nan
    rest_error: float = math.nan

    def pack(self) -> bytes:
        """The message: header, then payload."""
        if len(self.watch) != 16:
            raise FrameError(f"a watch id has 16 bytes, got {len(self.watch)}")
        header = LAYOUT.pack(
            self.watch, MAGIC, HEADER_VERSION, self.codec, self.flags, self.sequence & 0xFFFFFFFF,
            self.depends_on & 0xFFFFFFFF, self.width, self.height, self.samples,
            self.bands, self.max_bounces, self.cutoff, self.step, self.simulation_time,
            self.timestamp, self.simulate_ms, self.render_ms, self.encode_ms, self.cut, self.error,
            self.light_cut, self.light_error, self.shown_error, self.rest_error, len(self.payload),
        )  # fmt: skip
        return header + self.payload

    @classmethod
    def unpack(cls, message: bytes | memoryview) -> Frame:
        """The frame in a message, or FrameError."""
        if len(message) < HEADER_SIZE:
            raise FrameError(f"a frame has at least {HEADER_SIZE} bytes, got {len(message)}")
        (
            watch, magic, version, codec, flags, sequence, depends_on, width, height, samples,
            bands, max_bounces, cutoff, step,
            simulation_time, timestamp, simulate_ms, render_ms, encode_ms, cut, error, light_cut, light_error,
            shown_error, rest_error, length,
        ) = LAYOUT.unpack_from(message)  # fmt: skip
        if magic != MAGIC:
            raise FrameError(f"a frame is marked {MAGIC!r}, got {magic!r}")
        if version != HEADER_VERSION:
            raise FrameError(f"expected header version {HEADER_VERSION}, got {version}: use the client of that server")
        payload = bytes(message[HEADER_SIZE:])
        if len(payload) != length:
            raise FrameError(f"expected {length} bytes of payload, got {len(payload)}")
        if codec == REFUSED:
            raise FrameError(payload.decode("utf-8", "replace"))
        try:
            codec = Codec(codec)
        except ValueError:
            raise FrameError(f"expected codec {', '.join(f'{c} ({c.name})' for c in Codec)}, got {codec}") from None
        return cls(
            watch, codec, Flags(flags), sequence, width, height, samples, bands, max_bounces, cutoff, step,
            simulation_time, timestamp, simulate_ms, render_ms, encode_ms, cut, error, payload,
            depends_on, light_cut, light_error, shown_error, rest_error,
        )  # fmt: skip


def refusal(topic: bytes, why: str) -> bytes:
    """The message to whoever waits for frames by a topic that brings none; readers of any version complain of it."""
    sentence = why.encode()
    numbers = [0] * (len(FIELDS) - 5)
    return LAYOUT.pack(topic, MAGIC, HEADER_VERSION, REFUSED, *numbers, len(sentence)) + sentence

"""The watch id: who knows it may look at a session, and cannot steer it.

It is the ZeroMQ topic of the session's frames, and stands in their headers. Whoever knows the session's id can derive
it; nobody can go back.
"""

from __future__ import annotations

import hashlib
import hmac
from collections.abc import Mapping
from enum import Enum
from typing import Final

from culet_protocol.frame import Codec
from culet_protocol.messages import VideoCodec

TEXT = b"culet watch"
WATCH_BYTES = 16

VIDEO_OF_NAME: Final[dict[VideoCodec, Codec]] = {"h264": Codec.H264, "vp9": Codec.VP9}
VIDEO_NAMES: Final = {codec: name for name, codec in VIDEO_OF_NAME.items()}
VIDEO: Final = tuple(VIDEO_NAMES)
"""Codecs of which a frame may need the one before it."""


class Lesser(Enum):
    """What a session's frames are besides what their codecs say."""

    PICTURES = "lesser"
    """Smaller, or encoded with more loss, for viewers whose link or window has much less room than others'."""
    H264 = "lesser h264"
    VP9 = "lesser vp9"
    """Video of such frames."""


LESSER: Final = Lesser.PICTURES
LESSER_VIDEO: Final[Mapping[Codec, Lesser]] = {Codec.H264: Lesser.H264, Codec.VP9: Lesser.VP9}
Stream = Codec | Lesser
"""What one can subscribe to of a session: pictures of their own (`Codec.JPEG`, though a final one may be a PNG), video
of a codec, and the same of lesser pictures."""
STREAMS: Final[tuple[Stream, ...]] = (Codec.JPEG, *VIDEO, *Lesser)
CODEC_OF_VIDEO: Final[Mapping[Stream, Codec]] = {codec: codec for codec in VIDEO} | {
    stream: codec for codec, stream in LESSER_VIDEO.items()
}
"""Of streams of video."""
LESSER_BIT = 0x80


def watch_key(session: str) -> bytes:
    """The 16 bytes of a session's watch id: the first of HMAC-SHA-256, the session id's bytes being the key."""
    return hmac.digest(bytes.fromhex(session), TEXT, hashlib.sha256)[:WATCH_BYTES]


def watch_id(session: str) -> str:
    """The watch id of a session, as 32 hexadecimal digits."""
    return watch_key(session).hex()


def video_topic(watch: bytes, codec: Codec) -> bytes:
    """The ZeroMQ topic of a session's frames as video, by its watch id: the last byte is another one.

    Whoever subscribes gets a key frame first, or a still while nothing moves. A subscriber that has missed a frame
    subscribes once more for the next key frame. The engine sends stills there too, and JPEG where it has no encoder.
    """
    return watch[:-1] + bytes([watch[-1] ^ codec])


def topic_of(watch: bytes, stream: Stream) -> bytes:
    """The ZeroMQ topic by which a session's frames come, by its watch id: of lesser pictures the last byte is another
    one too."""
    lesser = LESSER_BIT if isinstance(stream, Lesser) else 0
    return watch[:-1] + bytes([watch[-1] ^ CODEC_OF_VIDEO.get(stream, 0) ^ lesser])

"""The watch id: who knows it may look at a session, and cannot steer it.

It is the ZeroMQ topic of the session's frames, and stands in their headers. Whoever knows the session's id can derive
it; nobody can go back.
"""

from __future__ import annotations

import hashlib
import hmac
from enum import Enum
from typing import Final, Literal

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


LESSER: Final = Lesser.PICTURES
Stream = Codec | Literal[Lesser.PICTURES]
"""What one can subscribe to of a session: pictures of their own (`Codec.JPEG`, though a final one may be a PNG), video
of a codec, or lesser pictures."""
STREAMS: Final[tuple[Stream, ...]] = (Codec.JPEG, *VIDEO, LESSER)
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
    if stream is LESSER:
        return watch[:-1] + bytes([watch[-1] ^ LESSER_BIT])
    return video_topic(watch, stream) if stream in VIDEO else watch

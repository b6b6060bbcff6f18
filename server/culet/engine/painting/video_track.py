"""The video of one session's moving frames in one codec: who encodes it, when it waits, and when it begins anew."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.engine.painting.video import Packet, VideoEncoder, VideoError
from culet_protocol.frame import Codec

log = logging.getLogger(__name__)

KEY_SECONDS = 1.0
"""Between two key frames at least, but for those of another size: each has the bytes of two to four others."""
CHANGE_SECONDS = 2.0
"""Between two changes of size or quality: each needs a key frame, and what takes time to render, or is seen of a link,
changes oftener. Until then pictures are brought to the size of those before."""
URGENT_CRF, URGENT_SCALE = 6, 0.7
"""A frame that is to have so much less, by its rate factor or its width, must not wait for that: half of the bytes."""
ALIKE = 1.08
"""Widths that differ by no more than so many times are not worth a key frame."""
SHAPE = 0.02
"""By which the ratio of width to height differs of pictures of the same shape: sizes are rounded."""
HOLD_SECONDS = 3.0
"""For which nothing is encoded because somebody says that what was sent is still under way: who says so may be gone."""
BYTES_PER_PIXEL = {Codec.H264: 46, Codec.VP9: 98}
"""Of an encoder, measured at 1280x720 and 1920x1080."""
ROOM_SECONDS = 1.0
"""Between two times that memory is asked for once there was none: others give back what they have to make room."""
MOST_FAILURES = 2
"""An encoder that fails is replaced; after so many failures the session's frames are JPEG."""


@dataclass(frozen=True)
class TrackedPacket:
    """A packet, and how good it is."""

    data: bytes
    is_key: bool
    crf: int
    width: int
    """Pixels."""
    height: int


class VideoTrack:
    """Mutable; `encode` runs on an encoding thread, one call at a time, the rest on the engine's loop."""

    def __init__(self, codec: Codec, make: Callable[[Codec, int, int, int], VideoEncoder] = VideoEncoder) -> None:
        self.codec = codec
        self.sequence = 0
        """Number of the frame encoded last, by the session's count."""
        self.failures = 0
        self._make = make
        self._encoder: VideoEncoder | None = None
        self._key_wanted = True
        self._key_at = -float("inf")
        self._began_at = -float("inf")
        self._held_until = -float("inf")
        self._roomless_until = -float("inf")
        self._promised = 0
        """Bytes that the encoder of the next picture takes, for which room was found."""
        self.has_room = True
        """Whether there was memory for the encoder that was needed last."""

    @property
    def nbytes(self) -> int:
        """That its encoder takes, or is about to take."""
        return max(self._promised, self._taken)

    @property
    def _taken(self) -> int:
        encoder = self._encoder
        return 0 if encoder is None else BYTES_PER_PIXEL[self.codec] * encoder.width * encoder.height

    @property
    def works(self) -> bool:
        """Whether it is to be tried at all."""
        return self.failures < MOST_FAILURES

    def want_key(self) -> None:
        """Somebody cannot go on without a key frame."""
        self._key_wanted = True

    def hold(self, now: float, *, held: bool) -> None:
        """Encode nothing more for the moment, since the link of somebody who watches is full; or go on."""
        self._held_until = now + HOLD_SECONDS if held else -float("inf")

    def is_held(self, now: float) -> bool:
        """Whether the next frame is to be skipped."""
        return now < self._held_until

    def lacks(self, size: tuple[int, int], crf: int, now: float) -> int:
        """Bytes that the encoder of the next picture takes, (width, height) pixels large, besides those of the one that
        there is; 0 if it is that one."""
        width, height = size
        if self._encoder is not None and not self._is_to_change(self._encoder, width, height, crf, now):
            return 0
        return max(0, BYTES_PER_PIXEL[self.codec] * width * height - self._taken)

    def find_room(self, size: tuple[int, int], crf: int, now: float, has_room: Callable[[int], bool]) -> bool:
        """Whether the next picture can be encoded, as far as memory goes; `has_room` is asked for bytes, which count as
        taken until the picture is encoded, or not to be."""
        self._promised = 0
        lacking = self.lacks(size, crf, now)
        if lacking == 0:
            self.has_room = True
        elif now >= self._roomless_until:
            self.has_room = has_room(lacking)
            self._roomless_until = -float("inf") if self.has_room else now + ROOM_SECONDS
        else:
            self.has_room = False
        if self.has_room and lacking > 0:
            self._promised = self._taken + lacking
        return self.has_room

    def forgo(self) -> None:
        """The picture for which there is room is not encoded."""
        self._promised = 0

    def encode(self, rgb: NDArray[np.uint8], crf: int, now: float) -> TrackedPacket | None:
        """The next packet, of a (height, width, 3) picture at that second of a steady clock; None if it failed."""
        height, width, _ = rgb.shape
        try:
            encoder = self._encoder
            if encoder is None or self._is_to_change(encoder, width, height, crf, now):
                self.close()
                encoder = self._encoder = self._make(self.codec, width, height, crf)
                self._began_at = now
            key = self._key_wanted and now - self._key_at >= KEY_SECONDS
            packet: Packet = encoder.encode(rgb, now, key=key)
        except VideoError as error:
            self.failures += 1
            log.warning("%s%s", error, "" if self.works else "; this session goes on without video")
            self.close()
            return None
        finally:
            self._promised = 0
        if packet.is_key:
            self._key_at, self._key_wanted = now, False
        return TrackedPacket(packet.data, packet.is_key, encoder.crf, encoder.width, encoder.height)

    def _is_to_change(self, encoder: VideoEncoder, width: int, height: int, crf: int, now: float) -> bool:
        """Whether another encoder is needed, for another size or quality."""
        if abs(width / height - encoder.width / encoder.height) > SHAPE * width / height:
            return True
        alike = 1 / ALIKE < width / encoder.width < ALIKE and crf == encoder.crf
        urgent = width < URGENT_SCALE * encoder.width or crf >= encoder.crf + URGENT_CRF
        return not alike and now - self._began_at >= (KEY_SECONDS if urgent else CHANGE_SECONDS)

    def close(self) -> None:
        """Give back the encoder's memory; the next frame is a key frame."""
        if self._encoder is not None:
            self._encoder.close()
        self._encoder, self._key_wanted, self._key_at = None, True, -float("inf")

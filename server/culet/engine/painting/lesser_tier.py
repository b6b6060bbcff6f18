"""The second picture of a session's frames, smaller or of less quality, for viewers whose link or window has much less
room than that of the viewer who decides. It is made of the frame as it was rendered, and only while somebody asks."""

from __future__ import annotations

import math

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.engine.governing.thrift import (
    NO_LIMITS,
    ByteAllowance,
    ByteRoom,
    Thrift,
    read_byte_ladder,
    read_video_ladder,
)
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.lossy import Lossy
from culet.engine.painting.resting_picture import encode_resting
from culet.engine.painting.video_track import VideoTrack
from culet_protocol.frame import Codec

LEAST_SIDE = 16
"""Pixels."""


class LesserTier:
    """Of one session. `encoded` and `packet` run on an encoding thread, one call at a time, the rest on the engine's
    loop."""

    def __init__(self) -> None:
        """Without limits, until some are told."""
        self.allowance: ByteAllowance = NO_LIMITS
        self.size: tuple[int, int] | None = None
        """Pixels into which the picture has to fit in one direction at least; None: of any size."""
        self.room: ByteRoom | None = None
        """That the link has for a moving frame, by the rate at which they are made."""
        self.message: bytes | None = None
        """The frame sent last, by the session's watch id."""
        self.lossy: Lossy | None = None
        """The frame sent last, if a better one of it could be made."""
        self.sequence: int | None = None
        """Number of the last frame of which there was a lesser picture."""
        self.tracks: dict[Codec, VideoTrack] = {}
        """Of its video that somebody subscribes to."""
        self._thrift = Thrift(read_byte_ladder())
        self._video_thrift = Thrift(read_video_ladder())

    def forget(self) -> None:
        """Keep none of what was sent last: something else is shown, or nobody is sent lesser pictures."""
        self.message = self.lossy = None

    def encoded(self, frame: LiveFrame) -> Coded:
        """The frame within the limits. Takes milliseconds, a final one some hundredths of a second."""
        width, height = self.fitting(frame.size)
        if not frame.planned and not frame.shown.moving:
            return encode_resting(shrunk(frame.rgb, width, height), self.allowance, final=frame.final)
        if not frame.planned:
            most = self.allowance.resting(final=False)
            picture = jpeg.encode_within(shrunk(frame.rgb, width, height), jpeg.MOVING_QUALITY, most)
            return Coded.of_jpeg(picture, thrifty=picture.quality < jpeg.MOVING_QUALITY or picture.width < width)
        best = jpeg.MOVING_QUALITY if frame.encoding is None else frame.encoding.quality
        thrifty = frame.encoding is not None and frame.encoding.thrifty
        if self.room is None:
            return Coded.of_jpeg(jpeg.encode_within(shrunk(frame.rgb, width, height), best, math.inf), thrifty=thrifty)
        scale = self._thrift.scale((width, height), self.room)
        size = max(LEAST_SIDE, round(scale * width)), max(LEAST_SIDE, round(scale * height))
        how = self._thrift.encoding(size, self.room)
        quality = min(best, how.quality)
        picture = jpeg.encode_within(shrunk(frame.rgb, *size), quality, how.most_bytes)
        self._thrift.encoded((picture.width, picture.height), picture.quality, len(picture.data))
        less = picture.quality < best or picture.width < width
        return Coded.of_jpeg(picture, thrifty=thrifty or less)

    def video_of(self, frame: LiveFrame) -> tuple[tuple[int, int], int]:
        """Width and height of a moving frame as video within the limits, and its constant rate factor."""
        window = self.fitting(frame.size)
        if self.room is None:
            return window, frame.crf
        scale = self._video_thrift.scale(window, self.room)
        size = max(LEAST_SIDE, round(scale * window[0])), max(LEAST_SIDE, round(scale * window[1]))
        return size, max(frame.crf, self._video_thrift.encoding(size, self.room).quality)

    def packet(self, frame: LiveFrame, rgb: NDArray[np.uint8], track: VideoTrack, crf: int, now: float) -> Coded | None:
        """The frame as the next packet of a track, shrunk to (height, width, 3) pixels, of that rate factor; None if
        that failed. Takes milliseconds."""
        packet = track.encode(rgb, crf, now)
        if packet is None:
            return None
        coded = frame.coded(track.codec, packet, track.sequence)
        if coded.depends_on:  # key frames are few, and so do not count
            self._video_thrift.encoded((coded.width, coded.height), coded.quality, len(coded.data))
        return coded._replace(thrifty=coded.thrifty or coded.width < self.fitting(frame.size)[0])

    def fitting(self, size: tuple[int, int]) -> tuple[int, int]:
        """A frame's size, or the smaller one that fills the viewers' windows."""
        return size if self.size is None else fitting(size, self.size)


def fitting(size: tuple[int, int], window: tuple[int, int]) -> tuple[int, int]:
    """Pixels of a picture of that size, or of the smaller one that fills a window."""
    scale = min(1.0, max(window[0] / size[0], window[1] / size[1]))
    return max(LEAST_SIDE, round(scale * size[0])), max(LEAST_SIDE, round(scale * size[1]))


def shrunk(rgb: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    """A (height, width, 3) picture in that size. Takes milliseconds."""
    if rgb.shape[:2] == (height, width):
        return rgb
    picture = PIL.Image.fromarray(np.ascontiguousarray(rgb))
    return np.asarray(picture.resize((width, height), PIL.Image.Resampling.HAMMING))

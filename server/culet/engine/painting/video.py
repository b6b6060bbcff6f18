"""Moving frames as video: H.264 or VP9 with colour at full resolution, by FFmpeg, where PyAV is installed.

Halved chroma keeps less than half of the fire's colour at whatever number of bytes, so there is no 4:2:0 here. Nothing
is held back: no frame depends on one that comes after it, and every call gives the packet of its frame.
"""

from __future__ import annotations

import importlib.util
import logging
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, assert_never

import numpy as np
from numpy.typing import NDArray

from culet_protocol.frame import Codec

if TYPE_CHECKING:
    from av.video.codeccontext import VideoCodecContext

log = logging.getLogger(__name__)

KEY_INTERVAL = 300
"""Frames after which one is a key frame in any case, ten seconds: a clip of the last seconds begins at one."""
TICKS = 1000
"""A second."""

RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722
"""Of luma, by Rec. ITU-R BT.709-6, item 3.2."""
BT709 = np.array(
    [
        [RED, GREEN, BLUE],
        [-RED / (2 - 2 * BLUE), -GREEN / (2 - 2 * BLUE), 0.5],
        [0.5, -GREEN / (2 - 2 * RED), -BLUE / (2 - 2 * RED)],
    ],
    np.float32,
)
"""To luma and the two colour differences (item 3.3), from -0.5 to 0.5 of the range."""
ROUNDED = np.array([[0.5], [128.5], [128.5]], np.float32)
"""Levels: the middle of the colour differences, and half of one for rounding."""
PIXELS_AT_ONCE = 28_000

ENCODERS = {Codec.H264: "libx264", Codec.VP9: "libvpx-vp9"}
VP9_CRF_OFFSET = 5
"""VP9's rate factor for what x264 does at a given one, by bytes."""
X264 = {
    "preset": "superfast",  # half the bytes of `ultrafast`, for a quarter more time
    "tune": "zerolatency",
    "forced-idr": "1",  # a key frame that is asked for begins anew, and does not only look like one
    "x264-params": f"scenecut=0:bframes=0:repeat-headers=1:keyint={KEY_INTERVAL}",
}
LIBVPX = {
    "deadline": "realtime",
    "cpu-used": "8",
    "lag-in-frames": "0",
    "auto-alt-ref": "0",
    "row-mt": "1",
    "b": "0",  # the rate factor alone decides
    "g": str(KEY_INTERVAL),
}


class VideoError(Exception):
    """An encoder does not do what it is there for."""


class Packet(NamedTuple):
    """One encoded frame."""

    data: bytes
    is_key: bool


@cache
def video_codecs() -> tuple[Codec, ...]:
    """What can be encoded here. Takes a tenth of a second the first time, for loading FFmpeg."""
    if importlib.util.find_spec("av") is None:
        return ()
    try:
        import av.codec

        return tuple(codec for codec, name in ENCODERS.items() if name in av.codec.codecs_available)
    except Exception as error:  # libraries that do not fit each other must not end the engine
        log.warning("no video, since PyAV cannot be used: %s: %s", type(error).__name__, error)
        return ()


class VideoEncoder:
    """One run of pictures of one size, each encoded after the one before it. Of one thread at a time."""

    def __init__(self, codec: Codec, width: int, height: int, crf: int) -> None:
        """VideoError if there is no such encoder, or not for that size."""
        self.codec, self.width, self.height, self.crf = codec, width, height, crf
        self._context: VideoCodecContext | None = None
        self._began_at: float | None = None
        self._last_tick = -1
        try:
            self._context = _context(codec, width, height, crf)
        except Exception as error:  # FFmpeg has errors of many kinds
            raise VideoError(f"cannot encode {width} x {height} as {codec.name}: {error}") from error

    def encode(self, rgb: NDArray[np.uint8], now: float, *, key: bool = False) -> Packet:
        """The next (height, width, 3) picture, shown at that second of any one clock, which is brought to the size of
        the run. Takes milliseconds."""
        from av.video.frame import PictureType, VideoFrame
        from av.video.reformatter import ColorRange, Colorspace, Interpolation

        if self._context is None:
            raise VideoError("this encoder is closed")
        try:
            if rgb.shape[:2] != (self.height, self.width):
                scaled = VideoFrame.from_ndarray(np.ascontiguousarray(rgb), format="rgb24").reformat(
                    self.width, self.height, interpolation=Interpolation.BICUBIC
                )
                rgb = np.asarray(scaled.to_ndarray(), np.uint8)
            picture = VideoFrame.from_ndarray(luma_and_chroma(rgb), format="yuv444p")
            picture.colorspace, picture.color_range = Colorspace.ITU709, ColorRange.JPEG
            self._began_at = now if self._began_at is None else self._began_at
            self._last_tick = max(self._last_tick + 1, round((now - self._began_at) * TICKS))
            picture.pts, picture.time_base = self._last_tick, Fraction(1, TICKS)
            picture.pict_type = PictureType.I if key else PictureType.NONE
            packets = list(self._context.encode(picture))
        except Exception as error:  # as above
            raise VideoError(f"{self.codec.name} of {self.width} x {self.height} failed: {error}") from error
        if len(packets) != 1:
            raise VideoError(f"expected one packet of {self.codec.name} for one frame, got {len(packets)}")
        return Packet(bytes(packets[0]), packets[0].is_keyframe)

    def close(self) -> None:
        """Give back its memory, 42 MB at 1280x720."""
        self._context = None


def luma_and_chroma(rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(3, height, width) Y, Cb and Cr of BT.709 with all 256 levels, of a (height, width, 3) picture.

    Rounded, where FFmpeg's conversion is up to a level off everywhere: of dark, even surfaces that is seen, and FLIP
    doubles. Some rows at a time stay in the cache, and are too few for the linear algebra to use other cores.
    """
    height, width, _ = rgb.shape
    planes = np.empty((3, height, width), np.uint8)
    rows = max(1, PIXELS_AT_ONCE // width)
    for top in range(0, height, rows):
        part = rgb[top : top + rows]
        levels = BT709 @ part.reshape(-1, 3).T.astype(np.float32) + ROUNDED
        planes[:, top : top + rows] = np.minimum(levels, 255, out=levels).reshape(3, -1, width)
    return planes


def _context(codec: Codec, width: int, height: int, crf: int) -> VideoCodecContext:
    import av
    from av.video.codeccontext import VideoCodecContext
    from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc

    context = av.CodecContext.create(ENCODERS[codec], "w")
    assert isinstance(context, VideoCodecContext)  # noqa: S101 - of a video codec
    context.width, context.height, context.pix_fmt = width, height, "yuv444p"
    context.time_base, context.framerate = Fraction(1, TICKS), Fraction(30, 1)
    context.thread_count = 1  # the others render
    # What browsers need to know to show the colours that JPEGs have: all are sRGB.
    context.colorspace, context.color_range = Colorspace.ITU709, ColorRange.JPEG
    context.color_primaries, context.color_trc = ColorPrimaries.BT709, ColorTrc.IEC61966_2_1
    match codec:
        case Codec.H264:
            context.options = X264 | {"crf": str(crf)}
        case Codec.VP9:
            context.options = LIBVPX | {"crf": str(crf + VP9_CRF_OFFSET)}
        case Codec.JPEG | Codec.PNG:
            raise VideoError(f"expected a codec of video, got {codec.name}")
        case _:
            assert_never(codec)
    context.open()
    return context

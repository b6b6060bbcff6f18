"""Video of a session's moving frames, decoded by FFmpeg where PyAV is installed (`pip install 'culet[video]'`)."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from culet_client.errors import ClientError
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Decoders, Hello, VideoCodec
from culet_protocol.watch import VIDEO_NAMES

if TYPE_CHECKING:
    import numpy as np
    from av.video.codeccontext import VideoCodecContext
    from numpy.typing import NDArray

DECODERS = {Codec.H264: "h264", Codec.VP9: "vp9"}
"""As FFmpeg calls them."""


def decoders() -> tuple[VideoCodec, ...]:
    """What is decoded here."""
    return tuple(VIDEO_NAMES.values()) if find_spec("av") else ()


def asked_of(hello: Hello) -> Decoders | None:
    """What to say to a server that makes video, so that it sends some; None if none of it is decoded here."""
    codecs = tuple(codec for codec in decoders() if codec in hello.encodes)
    return Decoders(codecs=codecs) if codecs else None


class VideoDecoder:
    """Of one stream's frames, one after the other."""

    def __init__(self) -> None:
        self._context: VideoCodecContext | None = None
        self._decoded: int | None = None

    def decode(self, frame: Frame) -> NDArray[np.uint8] | None:
        """(height, width, 3) red, green and blue of a frame of video; None of one that needs a frame that is missing,
        until a key frame comes. ClientError for one that is damaged."""
        is_key = Flags.KEY in frame.flags
        if not is_key and (self._context is None or frame.depends_on != self._decoded):
            return None
        import av
        import numpy as np
        from av.video.codeccontext import VideoCodecContext
        from av.video.reformatter import ColorRange, Colorspace

        try:
            if is_key:
                context = av.CodecContext.create(DECODERS[frame.codec], "r")
                assert isinstance(context, VideoCodecContext)  # noqa: S101 - of a video codec
                context.thread_count = 1  # others hold frames back
                self._context = context
            assert self._context is not None  # noqa: S101 - see above
            pictures = self._context.decode(av.Packet(frame.payload))
            if len(pictures) != 1:
                raise ClientError(f"frame {frame.sequence}: expected one picture of a packet, got {len(pictures)}")
            rgb = pictures[0].reformat(
                format="rgb24", src_colorspace=Colorspace.ITU709, src_color_range=ColorRange.JPEG
            )
        except (av.FFmpegError, ClientError) as error:
            self._context = None
            raise ClientError(f"frame {frame.sequence} cannot be decoded: {error}") from error
        self._decoded = frame.sequence
        return np.asarray(rgb.to_ndarray(), np.uint8)

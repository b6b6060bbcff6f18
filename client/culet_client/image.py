"""Frames as arrays."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self, assert_never

from culet_client.errors import ClientError
from culet_protocol.frame import Codec, Frame

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Image:
    """A frame that was decoded."""

    frame: Frame
    """What its header says: size, samples, step, times, error; `payload` is the picture as it came."""
    pixels: NDArray[np.uint8]
    """(height, width, 3), red, green, blue, the top row first."""

    @classmethod
    def of(cls, frame: Frame) -> Self:
        """Decode a frame; ClientError for a picture that is damaged, or of another size than its header says."""
        return cls.checked(frame, _decoded(frame))

    @classmethod
    def checked(cls, frame: Frame, pixels: NDArray[np.uint8]) -> Self:
        """Of a frame that was decoded; ClientError if it has another size than its header says."""
        if pixels.shape != (frame.height, frame.width, 3):
            raise ClientError(
                f"frame {frame.sequence}: expected {frame.width} x {frame.height} pixels, got {pixels.shape} of array"
            )
        return cls(frame, pixels)


def _decoded(frame: Frame) -> NDArray[np.uint8]:
    """What decodes is imported here: whoever only writes frames into files needs neither."""
    import numpy as np

    match frame.codec:
        case Codec.JPEG:
            import simplejpeg

            try:
                return np.asarray(simplejpeg.decode_jpeg(frame.payload, "RGB"), np.uint8)
            except ValueError as error:
                raise ClientError(f"frame {frame.sequence} is no JPEG: {error}") from error
        case Codec.PNG:
            import PIL.Image

            try:
                with PIL.Image.open(io.BytesIO(frame.payload), formats=["PNG"]) as image:
                    return np.asarray(image.convert("RGB"))
            except (OSError, SyntaxError) as error:
                raise ClientError(f"frame {frame.sequence} is no PNG: {error}") from error
        case Codec.H264 | Codec.VP9:
            raise ClientError(f"frame {frame.sequence} is video, which is decoded frame after frame")
        case _ as unknown:
            assert_never(unknown)

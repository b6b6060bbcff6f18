"""Frames as a film: H.264 in an MP4, all of one size, each shown for as long as it was the latest. Needs PyAV."""

from __future__ import annotations

import os
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from culet_client.errors import ClientError
from culet_client.image import Image

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Chroma = Literal["444", "420"]
TICKS = 90_000
"""A second, as films count."""
CRF = "16"
"""Constant rate factor of x264: no difference is seen at rest."""
LEAST_SECONDS = 1 / 120
"""Between two pictures: of two that came closer the later one is shown."""


class Film:
    """Writes an MP4; the file is there completely or not at all. Use it in a `with`: leaving that finishes the film."""

    def __init__(self, path: Path, size: tuple[int, int], chroma: Chroma = "444") -> None:
        """Pixels of the film. With chroma 420 colours have half the resolution, as old players want it; ClientError
        without PyAV, or if the file cannot be made."""
        if find_spec("av") is None:
            raise ClientError("a film needs PyAV: pip install 'culet[video]'")
        if path.suffix.lower() != ".mp4":
            raise ClientError(f"expected a film's name to end in .mp4, got {path.name}")
        import av
        from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
        from av.video.stream import VideoStream

        even = 1 if chroma == "444" else 2
        self.path, self.size = path, (size[0] // even * even, size[1] // even * even)
        self.count = 0
        """Of pictures."""
        self._part = path.with_name(f".{path.name}.{os.getpid()}.part")
        self._last: tuple[NDArray[np.uint8], float] | None = None
        self._shown_until = 0.0
        try:
            self._file = av.open(str(self._part), "w", format="mp4", options={"movflags": "+faststart"})
        except (OSError, av.FFmpegError) as error:
            raise ClientError(f"cannot make {path}: {error.strerror or error}") from error
        try:
            stream = self._file.add_stream("libx264", rate=Fraction(30), options={"crf": CRF, "preset": "medium"})
        except (ValueError, av.FFmpegError) as error:
            self.discard()
            raise ClientError(f"cannot make {path}: this PyAV has no libx264: {error}") from error
        assert isinstance(stream, VideoStream)  # noqa: S101 - of a video codec
        stream.width, stream.height = self.size
        stream.pix_fmt = f"yuv{chroma}p"
        context = stream.codec_context
        stream.time_base = context.time_base = Fraction(1, TICKS)
        context.colorspace, context.color_range = Colorspace.ITU709, ColorRange.MPEG
        context.color_primaries, context.color_trc = ColorPrimaries.BT709, ColorTrc.IEC61966_2_1
        self._stream = stream

    def add(self, image: Image, seconds: float) -> None:
        """The next picture, shown from so many seconds after the film's beginning on."""
        self.add_pixels(image.pixels, seconds)

    def add_pixels(self, pixels: NDArray[np.uint8], seconds: float) -> None:
        """As `add`: (height, width, 3) red, green and blue, the top row first."""
        if self._last is not None and seconds - self._last[1] >= LEAST_SECONDS:
            self._write(*self._last)
        elif self._last is not None:
            seconds = self._last[1]
        self._last = fitted(pixels, self.size), seconds

    def finish(self, seconds: float) -> None:
        """So long is the film; ClientError if it cannot be written, or has no picture."""
        import av

        try:
            if self._last is None:
                raise ClientError(f"{self.path}: no picture came, so there is no film")
            pixels, shown_at = self._last
            self._write(pixels, shown_at)
            if seconds - shown_at >= 2 * LEAST_SECONDS:
                self._write(
                    pixels, seconds - LEAST_SECONDS
                )  # players show a last picture for as long as the one before
            for packet in self._stream.encode(None):
                self._file.mux(packet)
            self._file.close()
            self._part.replace(self.path)
        except (OSError, av.FFmpegError) as error:
            raise ClientError(f"cannot write {self.path}: {error.strerror or error}") from error
        finally:
            self.discard()

    def discard(self) -> None:
        """Leave nothing of a film that is not finished."""
        self._file.close()
        self._part.unlink(missing_ok=True)

    def _write(self, pixels: NDArray[np.uint8], seconds: float) -> None:
        import av
        from av.video.reformatter import ColorRange, Colorspace

        picture = av.VideoFrame.from_ndarray(pixels, format="rgb24").reformat(
            format=self._stream.pix_fmt, dst_colorspace=Colorspace.ITU709, dst_color_range=ColorRange.MPEG
        )
        picture.pts, picture.time_base = round(seconds * TICKS), Fraction(1, TICKS)
        try:
            for packet in self._stream.encode(picture):
                self._file.mux(packet)
        except (OSError, av.FFmpegError) as error:
            raise ClientError(f"cannot write {self.path}: {error.strerror or error}") from error
        self.count += 1


def fitted(pixels: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.uint8]:
    """A (height, width, 3) picture brought to width and height, with black bars if it has another shape."""
    import numpy as np
    import PIL.Image

    width, height = size
    if pixels.shape[:2] == (height, width):
        return np.ascontiguousarray(pixels)
    scale = min(width / pixels.shape[1], height / pixels.shape[0])
    inner = max(1, min(width, round(pixels.shape[1] * scale))), max(1, min(height, round(pixels.shape[0] * scale)))
    scaled = np.asarray(PIL.Image.fromarray(np.ascontiguousarray(pixels)).resize(inner, PIL.Image.Resampling.BICUBIC))
    left, top = (width - inner[0]) // 2, (height - inner[1]) // 2
    whole = np.zeros((height, width, 3), np.uint8)
    whole[top : top + inner[1], left : left + inner[0]] = scaled
    return whole

"""`culet study video`: what moving frames have in bytes, as JPEG and as video, and what each of them loses of the fire.

Frames of a fall, one sample a pixel, as they are sent, are encoded, decoded and compared with what they were before: by
PSNR, by FLIP at 67 pixels a degree, and, in the fire, by the chroma that is left. Fire is where the CIELAB chroma is 30
or more: colours that everybody calls colours. All of it is of what is shown, sRGB.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import simplejpeg
from numpy.typing import NDArray
from rich import box
from rich.table import Table

from culet.engine.governing.thrift import BEST_CRF
from culet.engine.painting import jpeg
from culet.engine.painting.video import Packet, VideoEncoder, video_codecs
from culet.errors import InputError
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene
from culet.study.likeness.image_error import chroma
from culet.study.stream.falling_frames import falling
from culet.study.stream.moving_pictures import flip, rmse
from culet.study.stream.video_frames import decoded
from culet_protocol.frame import Codec

ScreenPixels = NDArray[np.uint8]
Progress = Callable[[float], None]

FIRE = 30.0
"""CIELAB chroma."""
JPEGS = 92, jpeg.MOVING_QUALITY, 70, 50, jpeg.LEAST_QUALITY
CRFS = 14, 17, BEST_CRF, 23, 26, 29, 32
JUDGED_EVERY = 15
"""Frames: FLIP takes a second for one."""
BYTES = 35_000
"""Of a frame of 1280x720 at which the chroma that is kept is told: 30 of them a second are 8 Mbit/s."""


@dataclass(frozen=True)
class Row:
    """One codec at one quality."""

    codec: str
    quality: int
    """Of JPEG, or the rate factor."""
    bytes: float
    """Of a frame, but for key frames."""
    key_bytes: float
    """Of a key frame."""
    milliseconds: float
    """Processor time of encoding a frame, conversion included."""
    psnr: float
    """dB."""
    flip: float
    chroma_kept: float
    """In the fire, over what it was."""


@dataclass(frozen=True)
class VideoStudy:
    """Of one scene's fall."""

    width: int
    height: int
    frames: int
    fire: float
    """Part of the pixels."""
    rows: tuple[Row, ...]

    def of(self, codec: str) -> list[Row]:
        """Rows of a codec, by falling bytes."""
        return sorted((row for row in self.rows if row.codec == codec), key=lambda row: -row.bytes)

    def document(self) -> dict[str, Any]:
        """For a file."""
        return asdict(self)


def measure(
    renderer: Renderer, scene: Scene, size: tuple[int, int], frames: int, progress: Progress = lambda _: None
) -> VideoStudy:
    """So many frames of the scene's fall; InputError without PyAV."""
    if Codec.H264 not in video_codecs():
        raise InputError("this study needs PyAV: pip install 'culet[video]'")
    shown = []
    for number, stage in enumerate(falling(scene, frames)):
        picture = renderer.picture(stage, *size)
        picture.refine()
        shown.append(picture.softened())  # as it is sent
        progress(0.3 * (number + 1) / frames)
    judged = list(range(frames - 1, 0, -JUDGED_EVERY))
    ways = [*((Codec.JPEG, quality) for quality in JPEGS), *((codec, crf) for codec in video_codecs() for crf in CRFS)]
    rows = []
    for number, (codec, quality) in enumerate(ways):
        rows.append(_row(codec, quality, shown, judged))
        progress(0.3 + 0.7 * (number + 1) / len(ways))
    fire = statistics.mean(float(np.mean(chroma(shown[place]) >= FIRE)) for place in judged)
    return VideoStudy(*size, frames, fire, tuple(rows))


def _row(codec: Codec, quality: int, shown: Sequence[ScreenPixels], judged: Sequence[int]) -> Row:
    began = time.thread_time()
    packets = list(_encoded(codec, quality, shown))
    milliseconds = 1e3 * (time.thread_time() - began) / len(shown)
    if codec is Codec.JPEG:
        pictures = {place: np.asarray(simplejpeg.decode_jpeg(packets[place].data, "RGB")) for place in judged}
    else:
        pictures = dict(enumerate(decoded(codec, packets)))
    pairs = [(pictures[place], shown[place]) for place in judged]
    mean_square = statistics.mean(rmse(*pair) ** 2 for pair in pairs)
    kept = [_kept(*pair) for pair in pairs]
    others = [len(packet.data) for packet in packets[1:]]
    return Row(
        codec.name, quality, statistics.mean(others), len(packets[0].data), milliseconds,
        psnr=10 * math.log10(255**2 / mean_square),
        flip=statistics.mean(flip(*pair) for pair in pairs),
        chroma_kept=float(np.nanmean(kept)),
    )  # fmt: skip


def _encoded(codec: Codec, quality: int, shown: Sequence[ScreenPixels]) -> Iterator[Packet]:
    if codec is Codec.JPEG:
        yield from (Packet(jpeg.encode(frame, quality), is_key=True) for frame in shown)
        return
    height, width, _ = shown[0].shape
    encoder = VideoEncoder(codec, width, height, quality)
    for number, frame in enumerate(shown):
        yield encoder.encode(frame, number / 30)


def _kept(decoded: ScreenPixels, before: ScreenPixels) -> float:
    """Chroma in the fire over what it was; NaN without fire."""
    was = chroma(before)
    fire = was >= FIRE
    return float(chroma(decoded)[fire].mean() / was[fire].mean()) if fire.any() else math.nan


def table(found: VideoStudy) -> Table:
    """A row for each codec and quality."""
    rows = Table("codec", box=box.SIMPLE_HEAD)
    for name in ("quality", "kB", "key kB", "processor ms", "PSNR dB", "FLIP", "chroma kept"):
        rows.add_column(name, justify="right")
    for row in found.rows:
        rows.add_row(
            row.codec, str(row.quality), f"{row.bytes / 1e3:.1f}", f"{row.key_bytes / 1e3:.1f}",
            f"{row.milliseconds:.1f}", f"{row.psnr:.2f}", f"{row.flip:.4f}", f"{row.chroma_kept:.3f}",
        )  # fmt: skip
    return rows


def described(found: VideoStudy) -> Iterator[str]:
    """What the table comes to."""
    yield f"{found.frames} frames of {found.width}x{found.height}; {100 * found.fire:.1f} % of the pixels are fire"
    moving = next(row for row in found.rows if (row.codec, row.quality) == ("JPEG", jpeg.MOVING_QUALITY))
    for codec in dict.fromkeys(row.codec for row in found.rows if row.codec != "JPEG"):
        rows = found.of(codec)
        for measure_name, value in (("psnr", moving.psnr), ("flip", moving.flip), ("chroma_kept", moving.chroma_kept)):
            count = at(rows, measure_name, value, "bytes")
            words = {"psnr": "PSNR", "flip": "FLIP", "chroma_kept": "chroma"}[measure_name]
            share = "cannot be told" if math.isnan(count) else f"{count / moving.bytes:.2f} of its bytes"
            yield f"{codec} at the {words} of JPEG {moving.quality}: {share}"
        yield f"{codec} at {BYTES / 1e3:g} kB a frame keeps {at(rows, 'bytes', BYTES, 'chroma_kept'):.2f} of the chroma"
    yield f"JPEG at {BYTES / 1e3:g} kB keeps {at(found.of('JPEG'), 'bytes', BYTES, 'chroma_kept'):.2f}"


def at(rows: Sequence[Row], given: str, value: float, wanted: str) -> float:
    """What a codec has of `wanted` where it has that value of `given`, by straight lines between its rows, in
    logarithms of bytes; NaN beyond them."""

    def of(row: Row, name: str) -> float:
        figure = float(getattr(row, name))
        return math.log(figure) if name == "bytes" else figure

    sought = math.log(value) if given == "bytes" else value
    pairs = sorted((of(row, given), of(row, wanted)) for row in rows)
    if not pairs[0][0] <= sought <= pairs[-1][0]:
        return math.nan
    found = float(np.interp(sought, [x for x, _ in pairs], [y for _, y in pairs]))
    return math.exp(found) if wanted == "bytes" else found

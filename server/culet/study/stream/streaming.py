"""The study of the stream: what a codec and its quality cost in bytes, time and likeness."""

from __future__ import annotations

import io
import statistics
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import PIL.Image
import simplejpeg
from numpy.typing import NDArray

from culet.rendering.renderer import Renderer
from culet.simulation.staged import world_of
from culet.stage import Stage
from culet.study.findings.journal import PointJournal
from culet.study.likeness.image_error import mean_ciede2000, structural_similarity
from culet.study.report import Figure, Knob, Point

ScreenPixels = NDArray[np.uint8]

FIGURES: dict[str, Figure] = {
    "bytes": Figure(unit="B", about="Of a frame, median."),
    "encode_ms": Figure(unit="ms", about="Median, on one core."),
    "decode_ms": Figure(unit="ms", about="Median, by a decoder in Python, not by a browser."),
    "ssim": Figure(unit="", better="more", about="Mean structural similarity to the frame itself."),
    "dissimilarity": Figure(unit="", about="1 - SSIM: an error, so that it can be drawn on a logarithmic scale."),
    "delta_e": Figure(unit="CIEDE2000", about="Mean colour difference from the frame itself."),
}

JPEG_QUALITIES = (50, 70, 80, 85, 92, 97)
SUBSAMPLINGS = ("444", "420")
PNG_LEVELS = (1, 3, 6, 9)
MOVING_FRAMES, SECONDS_APART = 6, 0.1
STILL_SAMPLES = 32


class StillCodec(NamedTuple):
    """A way to write a frame and to read it again."""

    name: str
    knobs: dict[str, Knob]
    encode: Callable[[ScreenPixels], bytes]
    decode: Callable[[bytes], ScreenPixels]


def codecs(*, quick: bool) -> Iterator[StillCodec]:
    """JPEG as the server sends it and otherwise, PNG, and TGA plain and run-length encoded."""
    for subsampling in SUBSAMPLINGS:
        for quality in JPEG_QUALITIES[1::2] if quick else JPEG_QUALITIES:
            yield _jpeg(quality, subsampling)
    for level in PNG_LEVELS[:3:2] if quick else PNG_LEVELS:
        yield _by_pillow(f"PNG level {level}", {"codec": "png", "level": level}, "PNG", compress_level=level)
    yield _by_pillow("TGA", {"codec": "tga", "compression": "none"}, "TGA")
    yield _by_pillow("TGA, run lengths", {"codec": "tga", "compression": "rle"}, "TGA", compression="tga_rle")


def _jpeg(quality: int, subsampling: str) -> StillCodec:
    def encode(frame: ScreenPixels) -> bytes:
        data: bytes = simplejpeg.encode_jpeg(frame, quality=quality, colorspace="RGB", colorsubsampling=subsampling)
        return data

    def decode(data: bytes) -> ScreenPixels:
        return np.asarray(simplejpeg.decode_jpeg(data, "RGB"))

    name = f"JPEG {quality} 4:{subsampling[1]}:{subsampling[2]}"
    return StillCodec(name, {"codec": "jpeg", "quality": quality, "subsampling": subsampling}, encode, decode)


def _by_pillow(name: str, knobs: dict[str, Knob], format_: str, **options: object) -> StillCodec:
    def encode(frame: ScreenPixels) -> bytes:
        buffer = io.BytesIO()
        PIL.Image.fromarray(frame).save(buffer, format_, **options)
        return buffer.getvalue()

    def decode(data: bytes) -> ScreenPixels:
        with PIL.Image.open(io.BytesIO(data)) as picture:
            return np.asarray(picture.convert("RGB"))

    return StillCodec(name, knobs, encode, decode)


def frames(renderer: Renderer, stage: Stage, width: int, height: int) -> dict[str, list[ScreenPixels]]:
    """`moving`: one sample of the falling stones at several times; `still`: the stage as it is at rest."""
    world = world_of(stage)
    moving = []
    for number in range(MOVING_FRAMES):
        while world.state.time < number * SECONDS_APART - 1e-9:
            world.step()
        poses = [(body.position, body.orientation) for body in world.state.bodies]
        picture = renderer.picture(stage.posed(poses), width, height)
        picture.refine()
        moving.append(picture.rgb())
    picture = renderer.picture(stage, width, height)
    picture.refine(STILL_SAMPLES)
    return {"moving": moving, "still": [picture.rgb()]}


def measure_all(
    shown: dict[str, list[ScreenPixels]], journal: PointJournal, *, quick: bool, progress: Callable[[str, int], None]
) -> None:
    """Every point that the journal lacks."""
    repeats = 3 if quick else 9
    for done, (kind, codec) in enumerate(settings_of(quick=quick)):
        progress(f"{kind}, {codec.name}", done)
        if _key(kind, codec) not in journal:
            journal.add(measure(kind, codec, shown[kind], repeats))


def settings_of(*, quick: bool) -> list[tuple[str, StillCodec]]:
    """Kind of frame and codec of each point."""
    return [(kind, codec) for kind in ("moving", "still") for codec in codecs(quick=quick)]


def measure(kind: str, codec: StillCodec, shown: list[ScreenPixels], repeats: int) -> Point:
    """One codec on all frames of a kind."""
    sizes, encoding, decoding, alike, apart = [], [], [], [], []
    for frame in shown:
        for _ in range(repeats):
            start = time.perf_counter()
            data = codec.encode(frame)
            middle = time.perf_counter()
            decoded = codec.decode(data)
            decoding.append(1e3 * (time.perf_counter() - middle))
            encoding.append(1e3 * (middle - start))
        sizes.append(len(data))
        alike.append(structural_similarity(decoded, frame))
        apart.append(mean_ciede2000(decoded, frame))
    likeness = statistics.mean(alike)
    return Point(
        key=_key(kind, codec),
        group=kind,
        label=codec.name,
        knobs={"frames": kind, **codec.knobs},
        figures={
            "bytes": float(statistics.median(sizes)),
            "encode_ms": statistics.median(encoding),
            "decode_ms": statistics.median(decoding),
            "ssim": likeness,
            "dissimilarity": max(1 - likeness, 0.0),
            "delta_e": statistics.mean(apart),
        },
    )


def _key(kind: str, codec: StillCodec) -> str:
    return f"{kind} {codec.name}"

"""The presets as pictures, with the measures that they are held to: README, docs/reference/gallery.md and page."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.rendering.chains import is_spectral
from culet.rendering.features import Features
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.presets import PRESETS, Preset
from culet.scene.thumbnails import SIZE
from culet.simulation.recording.paths import record
from culet.simulation.staged import dropped
from culet.stage import Stage
from culet.study.galleries.appearance import appearance, colour_parts, stone_mask

WIDE, SQUARE = (1280, 720), (720, 720)
"""Pixels of a picture; square are those of the instruments, which look straight down."""
SAMPLES, SPECTRAL_SAMPLES = 32, 24
"""Of each pixel; of a scene with many wavelengths a sample takes five times as long."""
SHOWN_WIDTH, QUALITY = 960, 85
"""Pixels of the pictures that the gallery shows, at most, and JPEG's."""
THUMBNAIL_SAMPLES, THUMBNAIL_SCALE, THUMBNAIL_QUALITY = 16, 2, 80
"""Of each pixel of a picture that is twice as large, and WebP's."""
POSES = (0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
"""s after its toss, of a stone that is judged in flight."""
POSES_SIZE, POSES_SAMPLES = (640, 360), 8

Band = tuple[float, float]
WANTED: Mapping[str, Mapping[str, Band]] = {
    "default": {
        "lightness": (52, 64), "low": (0, 27), "high": (94, 100), "dark": (0.08, 0.25), "clipped": (0, 0.005),
        "michelson": (0.24, 1), "fire": (0.04, 0.08), "isolated": (0, 0.45),
    },
    "white": {
        "lightness": (62, 72), "low": (0, 34), "clipped": (0, 0.01), "michelson": (0.19, 1), "surround": (85, 95),
    },
    "fire": {
        "lightness": (30, 42), "hot": (0.02, 1), "isolated": (0, 0.45), "clipped": (0, 0.04), "surround": (0, 12),
    },
    "falling": {"lightness": (54, 100), "dark": (0, 0.09), "clipped": (0, 0.04), "michelson": (0.19, 1)},
    "face-up": {
        "median": (80, 100), "high": (95, 100), "dark": (0.08, 0.14), "clipped": (0, 0.005), "michelson": (0.17, 1),
    },
    "aset": {"pure_red": (0.55, 1), "green": (0.05, 0.09), "blue": (0.2, 0.26)},
    "ideal-scope": {"red": (0.9, 1)},
    "ruby": {"lightness": (38, 56), "dark": (0, 0.1), "clipped": (0, 0.005), "chroma": (23, 200)},
    "sapphire": {"lightness": (38, 56), "dark": (0, 0.1), "clipped": (0, 0.005), "chroma": (45, 200)},
    "emerald": {"lightness": (38, 56), "dark": (0, 0.1), "clipped": (0, 0.005), "chroma": (36, 200)},
}  # fmt: skip
"""By preset and measure: from where to where it may be at full size."""


@dataclass(frozen=True)
class ShownPreset:
    """A preset's picture and what it measures."""

    preset: Preset
    picture: NDArray[np.uint8]
    measures: Mapping[str, float]

    @property
    def failures(self) -> list[str]:
        """Measures that are out of their band."""
        bands = WANTED.get(self.preset.name, {})
        return [name for name, (low, high) in bands.items() if not low <= self.measures[name] <= high]


def size_of(preset: Preset) -> tuple[int, int]:
    """Pixels of a preset's picture."""
    return SQUARE if preset.group == "instruments" else WIDE


def picture_of(
    renderer: Renderer, preset: Preset, size: tuple[int, int], samples: int, features: Features | None = None
) -> DevicePicture:
    """A preset's finished picture; `features` asks for another program than its own."""
    picture = renderer.picture(Stage.of(preset.scene), *size, features=features)
    picture.refine(samples)
    return picture


def shown(
    renderer: Renderer,
    preset: Preset,
    size: tuple[int, int] | None = None,
    samples: int | None = None,
    features: Features | None = None,
) -> ShownPreset:
    """At full size, unless another is asked for."""
    size = size or size_of(preset)
    samples = samples or (SPECTRAL_SAMPLES if is_spectral(preset.scene) else SAMPLES)
    picture = picture_of(renderer, preset, size, samples, features)
    measures: dict[str, float] = {}
    if len(picture.stage.shapes) == 1 and picture.stage.shapes[0].convex:
        mask = stone_mask(picture.stage, *size)
        measures = {**vars(appearance(picture.rgb(), mask)), **vars(colour_parts(picture.linear(), mask))}
    return ShownPreset(preset, picture.rgb(), measures)


def in_flight(
    renderer: Renderer, preset: Preset, size: tuple[int, int] = POSES_SIZE, features: Features | None = None
) -> Mapping[str, float]:
    """Means of the measures over POSES of a tossed stone."""
    stage = Stage.of(preset.scene)
    path = record(dropped(stage), max(POSES) + stage.scene.simulation.time_step)
    found: list[dict[str, float]] = []
    for seconds in POSES:
        step = int(np.argmin(abs(path.time - seconds)))
        (x, y, z), (a, b, c, d) = path.position[step].tolist(), path.orientation[step].tolist()
        picture = renderer.picture(stage.posed([((x, y, z), (a, b, c, d))]), *size, features=features)
        picture.refine(POSES_SAMPLES)
        found.append(vars(appearance(picture.rgb(), stone_mask(picture.stage, *size))))
    return {name: float(np.mean([measures[name] for measures in found])) for name in found[0]}


def gallery(renderer: Renderer) -> Iterator[ShownPreset]:
    """All presets at full size; one that falls is measured in flight."""
    for preset in PRESETS.values():
        seen = shown(renderer, preset)
        yield seen if preset.name != "falling" else ShownPreset(preset, seen.picture, in_flight(renderer, preset))


def make_thumbnails(renderer: Renderer, folder: Path) -> Iterator[Path]:
    """Write each preset's small picture as WebP; yields the files."""
    width, height = (THUMBNAIL_SCALE * side for side in SIZE)
    for preset in PRESETS.values():
        picture = picture_of(renderer, preset, (width, height), THUMBNAIL_SAMPLES)
        data = io.BytesIO()
        small = PIL.Image.fromarray(picture.rgb()).resize(SIZE, PIL.Image.Resampling.LANCZOS)
        small.save(data, "WEBP", quality=THUMBNAIL_QUALITY, method=6)
        file = folder / f"{preset.name}.webp"
        file.write_bytes(data.getvalue())
        yield file

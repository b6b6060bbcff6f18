"""`culet bench`: seconds a frame of named scenes, taken in turns so that a noisy machine is noisy for all of them."""

from __future__ import annotations

import json
import platform
import statistics
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import pyopencl as cl

from culet import __version__
from culet.geometry.load import stone_of
from culet.rendering.features import features_of
from culet.rendering.program import FLAGS
from culet.rendering.renderer import Picture, Renderer
from culet.scene.model import Scene
from culet.study.cases import CASES, FEATURE_CASES
from culet.study.provenance import commit, processor

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Timing:
    """Of one sample of every pixel."""

    name: str
    seconds: float
    """Median."""
    fastest: float
    """s."""
    ratio: float
    """Median over that of the first scene."""
    segments: int
    """Inside the stone."""
    nanoseconds_per_segment: float
    cut: float
    """Mean weight dropped."""


@dataclass(frozen=True)
class FeatureCost:
    """What one feature costs: its code when the scene does not use it, and its use."""

    name: str
    without_ms: float
    idle_ms: float
    used_ms: float
    without_bytes: int
    """Size of the built program that does not contain the feature,"""
    idle_bytes: int
    """and of the one that leaves the choice to run time."""


def measure_cases(renderer: Renderer, width: int, height: int, repeats: int) -> list[Timing]:
    """Every case of CASES, in turns."""
    pictures = {name: _picture(renderer, scene, width, height) for name, scene in CASES.items()}
    seconds = _take_turns(list(pictures.values()), repeats)
    medians = [statistics.median(times) for times in seconds]
    return [
        Timing(
            name, median, min(times), median / medians[0], picture.segments(),
            1e9 * median / max(1, picture.segments()), picture.cut(),
        )
        for (name, picture), times, median in zip(pictures.items(), seconds, medians, strict=True)
    ]  # fmt: skip


def measure_features(renderer: Renderer, width: int, height: int, repeats: int) -> Iterator[FeatureCost]:
    """Every feature of FEATURE_CASES, one after the other."""
    for name, (off, on) in FEATURE_CASES.items():
        without = features_of(off, stone_of(off.stones[0], {}))
        idle = without.without(name)
        pictures = [
            _picture(renderer, off, width, height),
            _picture(renderer, off, width, height, idle),
            _picture(renderer, on, width, height),
        ]
        milliseconds = [1e3 * statistics.median(times) for times in _take_turns(pictures, repeats)]
        yield FeatureCost(
            name,
            milliseconds[0],
            milliseconds[1],
            milliseconds[2],
            _program_size(pictures[0]),
            _program_size(pictures[1]),
        )


def record(renderer: Renderer, width: int, height: int, timings: list[Timing]) -> str:
    """One JSON line: the figures and what they were measured on."""
    return json.dumps(
        {
            "version": __version__,
            "commit": commit(),
            "machine": {"processor": processor(), "system": platform.platform(), **renderer.describe()},
            "flags": FLAGS,
            "width": width,
            "height": height,
            "cases": [asdict(timing) for timing in timings],
        }
    )


def _picture(renderer: Renderer, scene: Scene, width: int, height: int, features: Any = None) -> Picture:  # noqa: ANN401
    picture = renderer.picture(scene, stone_of(scene.stones[0], {}), width, height, features=features)
    picture.refine()  # the first launch pays for pages and caches
    return picture


def _take_turns(pictures: list[Picture], repeats: int) -> list[list[float]]:
    seconds: list[list[float]] = [[] for _ in pictures]
    for _ in range(repeats):
        for picture, times in zip(pictures, seconds, strict=True):
            picture.refine()
            times.append(picture.seconds)
    return seconds


def _program_size(picture: Picture) -> int:
    return int(picture.program.get_info(cl.program_info.BINARY_SIZES)[0])

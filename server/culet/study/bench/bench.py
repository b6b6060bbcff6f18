"""`culet bench`: seconds a frame of named scenes, taken in turns so that a noisy machine is noisy for all of them, and
how exact those frames are."""

from __future__ import annotations

import datetime as dt
import json
import platform
import statistics
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import NamedTuple

import numpy as np
import pyopencl as cl

from culet.rendering.features import Features, features_of
from culet.rendering.programs.build import FLAGS
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.model import Scene
from culet.study.bench.cases import CASES, FEATURE_CASES, stage_of
from culet.study.findings.provenance import commit, processor
from culet.version import __version__

EXACT_CUTOFF, EXACT_BOUNCES = 1e-5, 65536


@dataclass(frozen=True)
class Timing:
    """Of one sample of every pixel."""

    name: str
    seconds: float
    """Median."""
    fastest: float
    """s."""
    processor_seconds: float
    """Median of all cores' time together, which other work on the machine does not lengthen much."""
    preparation_seconds: float
    """Median of the same before the first launch, of a picture of a stage that was not seen before: what a frame costs
    besides, while stones move."""
    ratio: float
    """Median over that of the first scene."""
    segments: int
    """Inside the stone."""
    nanoseconds_per_segment: float
    cut: float
    """Mean weight dropped."""
    rmse: float
    """Radiance, against the same sample in double precision with every chain followed down to EXACT_CUTOFF."""


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
    firsts = {name: first_sample(renderer, scene, width, height) for name, scene in CASES.items()}
    pictures = {name: _picture(renderer, scene, width, height) for name, scene in CASES.items()}
    turns = _take_turns(list(pictures.values()), repeats)
    preparations = _prepare_in_turns(renderer, width, height, repeats)
    medians = [_median(each) for each in turns]
    return [
        Timing(
            name, median, min(turn.seconds for turn in each), statistics.median(turn.processor for turn in each),
            statistics.median(preparation), median / medians[0], first.segments,
            1e9 * median / max(1, first.segments), first.cut, first.rmse,
        )
        for (name, first), each, preparation, median in zip(
            firsts.items(), turns, preparations, medians, strict=True
        )
    ]  # fmt: skip


class FirstSample(NamedTuple):
    """What does not depend on the machine's speed."""

    segments: int
    cut: float
    rmse: float


def first_sample(renderer: Renderer, scene: Scene, width: int, height: int) -> FirstSample:
    """Of every pixel, against double precision."""
    optics = scene.optics.model_copy(update={"cutoff": EXACT_CUTOFF, "max_bounces": EXACT_BOUNCES})
    exact = _picture(
        Renderer(renderer.device, real=np.float64), scene.model_copy(update={"optics": optics}), width, height
    )
    picture = _picture(renderer, scene, width, height)
    difference = picture.linear() - exact.linear()
    return FirstSample(picture.segments(), picture.cut(), float(np.sqrt(np.mean(difference**2))))


def measure_features(renderer: Renderer, width: int, height: int, repeats: int) -> Iterator[FeatureCost]:
    """Every feature of FEATURE_CASES, one after the other."""
    for name, (off, on) in FEATURE_CASES.items():
        without = features_of(stage_of(off))
        idle = without.without(name)
        pictures = [
            _picture(renderer, off, width, height),
            _picture(renderer, off, width, height, idle),
            _picture(renderer, on, width, height),
        ]
        milliseconds = [
            1e3 * statistics.median(turn.seconds for turn in each) for each in _take_turns(pictures, repeats)
        ]
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
            "made": dt.datetime.now(dt.UTC).isoformat(timespec="seconds"),
            "version": __version__,
            "commit": commit(),
            "machine": {"processor": processor(), "system": platform.platform(), **renderer.describe()},
            "flags": FLAGS,
            "width": width,
            "height": height,
            "cases": [asdict(timing) for timing in timings],
        }
    )


def _picture(
    renderer: Renderer, scene: Scene, width: int, height: int, features: Features | None = None
) -> DevicePicture:
    picture = renderer.picture(stage_of(scene), width, height, features=features)
    picture.refine()  # the first launch pays for pages and caches
    return picture


class _Turn(NamedTuple):
    seconds: float
    processor: float
    """s of all cores together."""


def _take_turns(pictures: list[DevicePicture], repeats: int) -> list[list[_Turn]]:
    turns: list[list[_Turn]] = [[] for _ in pictures]
    for _ in range(repeats):
        for picture, own in zip(pictures, turns, strict=True):
            before = time.process_time()
            picture.refine()
            own.append(_Turn(picture.seconds, time.process_time() - before))
    return turns


def _prepare_in_turns(renderer: Renderer, width: int, height: int, repeats: int) -> list[list[float]]:
    """s of all cores together."""
    stages = [stage_of(scene) for scene in CASES.values()]
    turns: list[list[float]] = [[] for _ in stages]
    for _ in range(repeats):
        for stage, own in zip(stages, turns, strict=True):
            moved = replace(stage)
            before = time.process_time()
            renderer.picture(moved, width, height).prepare()
            own.append(time.process_time() - before)
    return turns


def _median(turns: list[_Turn]) -> float:
    return statistics.median(turn.seconds for turn in turns)


def _program_size(picture: DevicePicture) -> int:
    return int(picture.program.get_info(cl.program_info.BINARY_SIZES)[0])

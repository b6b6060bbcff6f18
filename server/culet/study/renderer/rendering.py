"""The study of the renderer: what each knob costs and what it saves."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from culet.study.findings.journal import PointJournal
from culet.study.likeness.image_error import colour_difference
from culet.study.likeness.pictures import write_pictures
from culet.study.likeness.radiance_error import enlarged, non_finite, radiance_error
from culet.study.renderer.knobs import Knobs, KnobSetting
from culet.study.renderer.reference import Reference
from culet.study.renderer.renderers import Renderers
from culet.study.renderer.shot import Shot
from culet.study.report import Figure, Point

FIGURES: dict[str, Figure] = {
    "kernel_seconds": Figure(unit="s", about="Median time in the kernel, for all samples of a frame."),
    "frame_seconds": Figure(unit="s", about="Median time of a whole frame: scene to device, kernel, tone map, bytes."),
    "prepare_seconds": Figure(unit="s", about="First time: compiling, or reading what the drivers have kept."),
    "rmse_model": Figure(unit="radiance", about="RMSE against the model reference."),
    "max_model": Figure(unit="radiance", about="Largest error of a channel of a pixel against the model reference."),
    "bias_model": Figure(unit="radiance", better="neither", about="Mean error against the model reference."),
    "delta_e_model": Figure(unit="CIEDE2000", about="Mean colour difference from the model reference, as shown."),
    "rmse_physics": Figure(unit="radiance", about="RMSE against the physics reference."),
    "max_physics": Figure(unit="radiance", about="Largest error against the physics reference."),
    "bias_physics": Figure(unit="radiance", better="neither", about="Mean error against the physics reference."),
    "delta_e_physics": Figure(unit="CIEDE2000", about="Mean colour difference from the physics reference, as shown."),
    "rmse_paired": Figure(
        unit="radiance", about="RMSE against the model reference's picture of the same samples: the knob's own error."
    ),
    "max_paired": Figure(unit="radiance", about="Largest error against the same samples."),
    "bias_paired": Figure(unit="radiance", better="neither", about="Mean error against the same samples."),
    "cut": Figure(unit="weight", about="Mean weight of the chains that were dropped; bounds the error that it causes."),
    "segments": Figure(unit="", about="Interior segments of a frame, all samples."),
    "non_finite": Figure(unit="", about="Numbers of the picture that are NaN or infinite."),
}
"""Of each point. `model`, `physics`: see the module `reference`. Time is of this machine, noise included."""

BUDGET = 1.5
"""s. Repeats of a point end after this, whatever their number: a long one is its own average."""


@dataclass(frozen=True, eq=False)
class Judges:
    """What points are judged against."""

    model: Reference
    physics: Reference


def measure_all(
    renderers: Renderers,
    shot: Shot,
    base: Knobs,
    settings: list[KnobSetting],
    judges: Judges,
    journal: PointJournal,
    repeats: int,
    progress: Callable[[str, int], None],
    pictures: Path,
) -> None:
    """Every setting that the journal lacks; `progress` is told the next one's words and how many are done."""
    for done, setting in enumerate(settings):
        label = setting.knobs.differences(base)
        progress(label, done)
        if setting.knobs.key not in journal:
            journal.add(measure(renderers, shot, setting, label, judges, repeats, pictures))


def measure(
    renderers: Renderers, shot: Shot, setting: KnobSetting, label: str, judges: Judges, repeats: int, pictures: Path
) -> Point:
    """One setting: a first time for the compiler, then `repeats` whole frames."""
    knobs = setting.knobs
    start = time.perf_counter()
    picture = renderers.picture(knobs, shot)
    prepare = time.perf_counter() - start
    picture.refine(1)  # the first launch pays for pages and caches
    kernel: list[float] = []
    whole: list[float] = []
    while len(whole) < repeats and (not whole or sum(whole) < BUDGET):
        start = time.perf_counter()
        picture = renderers.picture(knobs, shot)
        picture.refine(knobs.samples)
        picture.rgb()
        whole.append(time.perf_counter() - start)
        kernel.append(picture.seconds)
    made = picture.linear()
    image = enlarged(made, shot.height, shot.width)
    figures: dict[str, float | None] = {
        "kernel_seconds": statistics.median(kernel),
        "frame_seconds": statistics.median(whole),
        "prepare_seconds": prepare,
        "cut": picture.cut(),
        "segments": picture.segments() * knobs.samples,
        "non_finite": non_finite(made),
    }
    for name, reference in (("model", judges.model), ("physics", judges.physics)):
        figures |= {f"{kind}_{name}": value for kind, value in radiance_error(image, reference.image).items()}
        figures[f"delta_e_{name}"] = colour_difference(image, reference.image, shot.stage.scene.film)
    same_samples = judges.model.images.get(knobs.samples) if knobs.scale == 1 else None
    paired = radiance_error(image, same_samples) if same_samples is not None else dict.fromkeys(("rmse", "max", "bias"))
    figures |= {f"{kind}_paired": value for kind, value in paired.items()}
    if setting.pictured:
        write_pictures(pictures, knobs.key, np.nan_to_num(image), judges.model.image, shot.stage.scene.film)
    return Point(
        key=knobs.key,
        group=setting.group,
        label=label,
        knobs=knobs.values(),
        figures={name: _number(figures[name]) for name in FIGURES},
    )


def _number(value: float | None) -> float | None:
    return value if value is None or np.isfinite(value) else None

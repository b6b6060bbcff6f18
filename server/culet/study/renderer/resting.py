"""How soon a picture at rest is how good: as the engine refines it, against the converged one."""

from __future__ import annotations

import io
import json
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import PIL.Image
from numpy.typing import NDArray
from rich import box
from rich.table import Table

from culet.engine.governing.thrift import NO_LIMITS
from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.engine.painting.shares import Account
from culet.engine.session.session import Session
from culet.optics.gamut import into_gamut
from culet.optics.tone import tone_map
from culet.rendering.chains import is_spectral
from culet.rendering.cut_out import CuttingRenderer
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import DevicePicture
from culet.scene.film import Film
from culet.stage import Stage
from culet.study.findings.convergence import TimeTo, time_to
from culet.study.likeness.radiance_error import Image, radiance_error

TARGETS = (0.02, 0.01, 0.007, 0.004)
"""RMSE to which seconds are told."""
CONVERGED_BANDS = 16
"""Wavelengths of each sample of the converged picture, where the scene leaves them to the renderer."""
Error = Literal["sent", "shown", "radiance"]
WORDS: dict[Error, str] = {"sent": "as sent", "shown": "as shown before it is encoded", "radiance": "of radiance"}
WARM_UP = 64, 64
"""Pixels of a picture that has machine code made."""


@dataclass(frozen=True)
class Look:
    """One of the pictures that a viewer gets."""

    seconds: float
    """Since the first one was begun: rendering, developing and encoding."""
    samples: int
    sent: float
    """RMSE of what is shown, from 0 to 1: of the picture as it is sent, decoded."""
    shown: float
    """The same before it is encoded, not rounded to bytes."""
    shown_estimate: float
    radiance: float
    """RMSE of linear radiance."""
    radiance_estimate: float


@dataclass(frozen=True)
class Resting:
    """Of one scene."""

    width: int
    height: int
    looks: Sequence[Look]
    """Those that are not amid a sample."""
    longest_gap: float
    """s between two pictures that a viewer gets."""
    met: bool
    """Whether the last picture has the error that it was to have."""
    samples: int
    """Of the reference: those after the last picture's own, so that it shares none with any of them."""

    def seconds_to(self, target: float, kind: Error) -> TimeTo:
        """Until that RMSE."""
        errors = [getattr(look, kind) for look in self.looks]
        return time_to([look.seconds for look in self.looks], errors, target)

    def document(self) -> str:
        """As JSON."""
        values = asdict(self) | {
            f"{kind}_seconds_to": {f"{target:g}": self.seconds_to(target, kind) for target in TARGETS} for kind in WORDS
        }
        text = json.dumps(values, indent=1, default=str)
        return text.replace("NaN", "null")


def as_shown(linear: Image, film: Film) -> NDArray[np.float64]:
    """0 (black) to 1 (white), not rounded to bytes."""
    exposed = film.exposure * linear.astype(np.float64)
    return np.clip(tone_map(into_gamut(exposed, film.gamut), film.tone_map), 0, 1)


def measure(
    stage: Stage, width: int, height: int, rest: Target, samples: int, progress: Callable[[float], None]
) -> Resting:
    """Refine to `rest`, then by `samples` more for the reference.

    That has CONVERGED_BANDS wavelengths, if the scene's are `auto`. The machine has nothing else to do, or the times
    are of what is left of it. Compiling does not count, the map of the light that stones throw does.
    """
    renderer = CuttingRenderer()
    renderer.make_ready(stage)
    renderer.picture(stage, *WARM_UP, effort=None).refine(2)
    picture, taken = (
        renderer.picture(stage, width, height, effort=LightEffort.RESTING),
        list[tuple[float, int, NDArray[np.uint8], Image]](),
    )
    estimates = []
    times = []
    for seconds, sent in _at_rest(renderer, stage, picture, rest):
        times.append(seconds)
        if not picture.under_way:
            taken.append((seconds, picture.samples_seen, sent, picture.linear()))
            estimates.append((picture.shown_error(), picture.error_estimate()))
        progress(min(1.0, picture.samples / (rest.samples + samples)))
    met, own = picture.meets(rest), picture.samples
    if is_spectral(stage.scene) and stage.scene.optics.bands == "auto":
        picture = renderer.picture(_with_bands(stage, CONVERGED_BANDS), width, height)
        picture.refine(own)  # so that what follows shares no sample with any of them here either
    last = own * picture.linear().astype(np.float64)
    for _ in range(samples):
        picture.refine(1)
        progress(picture.samples / (own + samples))
    reference = (picture.samples * picture.linear().astype(np.float64) - last) / samples
    film, looks = stage.scene.film, list[Look]()
    shown = as_shown(reference, film)
    for (seconds, count, sent, image), (shown_estimate, radiance_estimate) in zip(taken, estimates, strict=True):
        off_sent, off = (math.sqrt(np.mean(np.square(seen - shown))) for seen in (sent / 255, as_shown(image, film)))
        of_radiance = radiance_error(image, reference)["rmse"]
        looks.append(Look(seconds, count, off_sent, off, shown_estimate, of_radiance, radiance_estimate))
    gaps = [after - before for before, after in pairwise(times)]
    return Resting(width, height, looks, max(gaps, default=0.0), met, samples)


def _with_bands(stage: Stage, bands: int) -> Stage:
    optics = stage.scene.optics.model_copy(update={"bands": bands})
    return stage.showing(stage.scene.model_copy(update={"optics": optics}))


def _at_rest(
    renderer: CuttingRenderer, stage: Stage, picture: DevicePicture, rest: Target
) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Whenever a viewer whose link has no limits would get the picture: the seconds that it took so far, and what the
    viewer sees, (height, width, 3)."""
    shown, size, spent = Session("0" * 32, stage).shown, (picture.width, picture.height), 0.0
    final, over = False, None
    while not final:
        begun = time.perf_counter()
        first = over is None
        work = FrameWork(
            WorkKind.FULL if first else WorkKind.REFINED, shown, size, Account(None), begun, picture=picture
        )
        work.aim, work.over = None if first else rest, over
        work.start(renderer)
        for _ in work.pieces:
            pass
        assert work.frame is not None  # noqa: S101 - all pieces are done
        over = work.frame.rgb
        data = work.frame.encoded(NO_LIMITS).data
        spent += time.perf_counter() - begun
        final = work.final
        with PIL.Image.open(io.BytesIO(data)) as sent:
            yield spent, np.asarray(sent.convert("RGB"))


def table(found: Resting) -> Table:
    """A row for each picture."""
    heads = "seconds", "samples", "error as sent", "before that", "estimated", "of radiance", "estimated"
    rows = Table(*heads, box=box.SIMPLE)
    for look in found.looks:
        errors = (look.sent, look.shown, look.shown_estimate, look.radiance, look.radiance_estimate)
        rows.add_row(f"{look.seconds:.2f}", str(look.samples), *("-" if math.isnan(e) else f"{e:.4f}" for e in errors))
    return rows


def described(found: Resting) -> Iterator[str]:
    """In sentences."""
    last = found.looks[-1]
    reached = "its target" if found.met else "the limit of samples, not its target"
    yield f"final after {last.seconds:.1f} s with {last.samples} samples: {reached}"
    for kind, said in WORDS.items():
        for target in TARGETS:
            until = found.seconds_to(target, kind)
            words = "never" if until.seconds is None else f"after {until.seconds:.1f} s"
            note = " (extrapolated)" if until.extrapolated else ""
            yield f"error {said} under {target:g}: {words}{note}"
    yield f"longest time between two pictures: {found.longest_gap:.2f} s"

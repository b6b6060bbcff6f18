"""A study by its name, for the command line and for scripts. What it needs is imported when it begins: not everybody
has installed it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, assert_never

from culet.errors import InputError, SceneError

if TYPE_CHECKING:
    from culet.scene import Scene
    from culet.stage import Stage
    from culet.study.report import Report
    from culet.study.studies import Progress

Study = Literal["rendering", "simulation", "streaming", "caustics"]


def measure(
    study: Study,
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    mesh: str | os.PathLike[str] | None = None,
    sky: str | os.PathLike[str] | None = None,
    quick: bool = False,
    fresh: bool = False,
    width: int | None = None,
    height: int | None = None,
    progress: Progress | None = None,
) -> Report:
    """Measure a scene, as `culet study` does, into a folder: report.html, report.json, CSV and pictures.

    Args:
        study: `rendering` sweeps the renderer's knobs against converged references, `simulation` integrators and step
            sizes, `streaming` codecs, `caustics` the cut-off of the light that stones throw.
        scene: as `culet.load_scene` takes it; it needs a stone.
        out: folder, made if missing; by default `report/` and the study's name. What an earlier run that was stopped
            has measured there is not measured again.
        mesh: file whose mesh takes the place of the stone.
        sky: file with a panorama that becomes the sky.
        quick: fewer settings and samples, a smaller picture: a minute or two of two cores, not an hour.
        fresh: measure anew what the folder has.
        width: pixels of the picture, for `rendering` and `streaming`; by default 640, quick 320.
        height: pixels; by default 360, quick 180.
        progress: begins a part of that name and that many steps, and is told how many are done.

    Raises:
        InputError: for what cannot be used, and where scikit-image is missing: `pip install 'culet[study]'`.
    """
    from culet.stills import stage_of

    stage, _ = stage_of(scene, mesh, sky)
    with needs_of_studies():
        return measure_stage(
            study, stage, Path(out or Path("report") / study), progress or _silent,
            quick=quick, fresh=fresh, width=width, height=height,
        )  # fmt: skip


def measure_stage(
    study: Study,
    stage: Stage,
    out: Path,
    progress: Progress,
    *,
    quick: bool,
    fresh: bool,
    width: int | None = None,
    height: int | None = None,
) -> Report:
    """Measure a stage; as `measure`."""
    if not stage.shapes:
        raise SceneError("stones: a study needs a stone; the scene has none", "stones")
    from culet.study.studies import FULL, QUICK, study_caustics, study_rendering, study_simulation, study_streaming

    usual = QUICK if quick else FULL
    effort = usual._replace(width=width or usual.width, height=height or usual.height)
    match study:
        case "rendering":
            return study_rendering(stage, out, progress, effort=effort, quick=quick, fresh=fresh)
        case "simulation":
            return study_simulation(stage, out, progress, quick=quick, fresh=fresh)
        case "streaming":
            return study_streaming(stage, out, progress, size=(effort.width, effort.height), quick=quick, fresh=fresh)
        case "caustics":
            return study_caustics(stage, out, progress, quick=quick, fresh=fresh)
        case _ as unknown:
            assert_never(unknown)


@contextlib.contextmanager
def needs_of_studies() -> Iterator[None]:
    """InputError where a package is missing that studies alone need."""
    try:
        yield
    except ModuleNotFoundError as error:
        needed = {"skimage": "scikit-image", "flip_evaluator": "flip-evaluator"}
        name = (error.name or "").split(".")[0]
        if name not in needed:
            raise
        raise InputError(f"a study needs {needed[name]}: pip install 'culet[study]'") from error


@contextlib.contextmanager
def _silent(part: str, steps: int) -> Iterator[Callable[[str, int], None]]:
    """For those who do not want to know how far it is."""
    del part, steps
    yield lambda label, done: None

"""The studies from beginning to end: what to measure, into the journal, out of it into the report."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from culet.rendering.opencl.device import Device, open_device
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene
from culet.stage import Stage
from culet.study.bench.roofline import measure_roofline
from culet.study.findings.journal import PointJournal
from culet.study.findings.provenance import (
    CAUSTICS_STUDY,
    GROWTH_STUDY,
    RENDERING_STUDY,
    SIMULATION_STUDY,
    STREAMING_STUDY,
    code_digest,
    peer_versions,
    processor,
)
from culet.study.light import caustics
from culet.study.likeness.pictures import write_pictures
from culet.study.motion import simulation
from culet.study.outcome import (
    caustics_report,
    device_facts,
    growth_report,
    rendering_report,
    simulation_report,
    streaming_report,
    write,
)
from culet.study.renderer import race, rendering
from culet.study.renderer.knobs import base_knobs, settings_of
from culet.study.renderer.mitsuba import SAMPLERS, find_llvm
from culet.study.renderer.reference import Reference, make_reference, reference_knobs
from culet.study.renderer.renderers import Renderers
from culet.study.renderer.shot import Shot
from culet.study.report import Knob, Report
from culet.study.serving import growth
from culet.study.stream import streaming

JOURNAL = "journal.jsonl"

Advance = Callable[[str, int], None]
"""Told what comes next and how much is done."""
Progress = Callable[[str, int], AbstractContextManager[Advance]]
"""Begins a stage of that name and that many steps."""


class StudyEffort(NamedTuple):
    """How much a study of the renderer spends."""

    width: int
    height: int
    model_samples: int
    physics_samples: int
    repeats: int
    """Of a frame, at most: what else a machine does lasts longer than a few frames."""
    race_samples: int
    """Of the race's reference."""
    race_seconds: float
    """Of each that takes part."""
    race_pass: int
    """Samples of a pass of Mitsuba's."""


QUICK = StudyEffort(320, 180, 256, 48, 9, 512, 4.0, 16)
"""For a first look."""
FULL = StudyEffort(640, 360, 1024, 192, 25, 1024, 15.0, 16)
"""How long each takes, docs/explanation/study.md says."""


def study_rendering(
    stage: Stage,
    out: Path,
    progress: Progress,
    *,
    effort: StudyEffort,
    quick: bool,
    fresh: bool = False,
    cache: Path | None = None,
    groups: frozenset[str] | None = None,
) -> Report:
    """Sweep the renderer's knobs, all or those sweeps that `groups` names besides the base.

    What `out`'s journal holds is not measured again. `cache`: the folder of references, the user's if None.
    """
    device = open_device()
    renderers = Renderers(device)
    scene = stage.scene
    shot = Shot(stage, effort.width, effort.height)
    base = base_knobs(stage, device.lanes)
    settings = [
        setting
        for setting in settings_of(base, quick=quick)
        if groups is None or setting.group == "base" or setting.group in groups
    ]
    identity = _identity("rendering", stage, quick, code_digest(RENDERING_STUDY), device) | effort._asdict()
    with PointJournal(out / JOURNAL, identity, fresh=fresh) as journal:
        references = []
        for kind, samples in (("model", effort.model_samples), ("physics", effort.physics_samples)):
            knobs = reference_knobs(base, kind, device.lanes // 2 or 1)
            with progress(f"{kind} reference", samples) as advance:
                references.append(
                    make_reference(
                        renderers, shot, knobs, samples,
                        lambda part, advance=advance, samples=samples: advance("", round(part * samples)),  # type: ignore[misc]
                        steps=kind == "model", cache=cache,
                    )
                )  # fmt: skip
        judges = rendering.Judges(*references)
        pictures = out / "pictures"
        for kind, judge in (("model", judges.model), ("physics", judges.physics)):
            write_pictures(pictures, kind, judge.image, judges.model.image, scene.film)
        with progress("settings", len(settings)) as advance:
            rendering.measure_all(renderers, shot, base, settings, judges, journal, effort.repeats, advance, pictures)
        notes = [
            _references_note(effort, judges),
            *_run_race(renderers, effort, journal, progress, cache),
        ]
        with progress("limits of the machine", 1):
            limits = measure_roofline(device)
        report = rendering_report(
            scene.model_dump(mode="json"),
            {"width": effort.width, "height": effort.height, "quick": quick, "repeats": effort.repeats},
            device_facts(device), list(journal.points.values()), base, limits,
            sum(len(shape.planes) for shape in stage.shapes), notes,
        )  # fmt: skip
    write(report, out)
    return report


def _references_note(effort: StudyEffort, judges: rendering.Judges) -> str:
    return (
        f"The model reference ({effort.model_samples} samples a pixel) has itself an RMSE of some "
        f"{judges.model.error:.2g}, the physics reference ({effort.physics_samples}) of {judges.physics.error:.2g}: "
        "errors near that are the reference's. All pictures take their samples from one sequence, so that one of n "
        "samples shares them with its reference of N; its error looks smaller than it is by the factor sqrt(1 - n / N)."
    )


def _race_note(judge: Reference) -> str:
    return (
        f"The race's reference has itself an RMSE of some {judge.error:.2g}. It is of {judge.samples} samples, after "
        "those of the same sequence that culet may take: it shares none with anybody who takes part."
    )


def _run_race(
    renderers: Renderers, effort: StudyEffort, journal: PointJournal, progress: Progress, cache: Path | None
) -> list[str]:
    """Against others, unless it may take no time; returns what there is to say about it."""
    if effort.race_seconds == 0:
        return []
    shot = race.race_shot(effort.width, effort.height)
    lanes = renderers.device.lanes
    base = replace(base_knobs(shot.stage, lanes), cutoff=1e-6)
    with progress("reference of the race", effort.race_samples) as advance:
        reference = make_reference(
            renderers, shot, reference_knobs(base, "model", lanes // 2 or 1), effort.race_samples,
            lambda part: advance("", round(part * effort.race_samples)), steps=True, cache=cache,
        )  # fmt: skip
    most = effort.race_samples // 4
    judge = reference.after(most)
    notes = [_race_note(judge)]
    ran = {str(point.knobs["renderer"]) for point in journal.points.values() if point.group == "race"}
    with progress("race", len(race.ENTRANTS) + 1) as advance:
        for number, name in enumerate(race.ENTRANTS):
            advance(name, number)
            if name not in ran:
                journal.add(*race.run_culet(name, renderers, shot, judge.image, most, effort.race_seconds))
        if race.mitsuba_missing():
            return [*notes, "Mitsuba 3 is not installed, and does not take part in the race (pip install mitsuba)."]
        advance("Mitsuba 3", len(race.ENTRANTS))
        samplers = [sampler for sampler in SAMPLERS if race.mitsuba_name(sampler) not in ran]
        if samplers:
            runs, words = race.run_mitsuba(shot, judge.image, effort.race_pass, effort.race_seconds, samplers)
            for points in runs:
                journal.add(*points)
            notes += [words] if words else []
    return notes if find_llvm() else [*notes, race.NO_LLVM]


def study_simulation(stage: Stage, out: Path, progress: Progress, *, quick: bool, fresh: bool = False) -> Report:
    """Sweep integrators and step sizes on the scene's only stone; SceneError for several, which have but one solver."""
    scene = stage.scene
    scene.only_stone()
    (shape,) = stage.shapes
    identity = _identity("simulation", stage, quick, code_digest(SIMULATION_STUDY))
    with PointJournal(out / JOURNAL, identity, fresh=fresh) as journal:
        with progress("motions", len(simulation.points_of(shape, quick=quick))) as advance:
            simulation.measure_all(shape, journal, quick=quick, progress=advance)
        points = list(journal.points.values())
    report = simulation_report(scene.model_dump(mode="json"), {"quick": quick}, points)
    write(report, out)
    return report


def study_streaming(
    stage: Stage, out: Path, progress: Progress, *, size: tuple[int, int], quick: bool, fresh: bool = False
) -> Report:
    """Sweep codecs and qualities on the scene's frames, moving and still."""
    device = open_device()
    width, height = size
    identity = _identity("streaming", stage, quick, code_digest(STREAMING_STUDY), device)
    identity |= {"width": width, "height": height}
    with PointJournal(out / JOURNAL, identity, fresh=fresh) as journal:
        with progress("frames", 1):
            shown = streaming.frames(Renderer(device), stage, width, height)
        with progress("codecs", len(streaming.settings_of(quick=quick))) as advance:
            streaming.measure_all(shown, journal, quick=quick, progress=advance)
        points = list(journal.points.values())
    settings = {"width": width, "height": height, "quick": quick}
    report = streaming_report(stage.scene.model_dump(mode="json"), dict(settings), device_facts(device), points)
    write(report, out)
    return report


def study_caustics(stage: Stage, out: Path, progress: Progress, *, quick: bool, fresh: bool = False) -> Report:
    """Sweep the cut-off of the light that the stones throw, beside photons; SceneError for stones without beams."""
    for lamp in caustics.LAMPS:
        caustics.under(stage, lamp)
    renderer, extent = Renderer(), caustics.QUICK if quick else caustics.FULL
    identity = _identity("caustics", stage, quick, code_digest(CAUSTICS_STUDY), renderer.device)
    with PointJournal(out / JOURNAL, identity, fresh=fresh) as journal:
        with progress("maps", caustics.steps(extent)) as advance:
            caustics.measure_all(renderer, stage, extent, journal, advance)
        points = list(journal.points.values())
    notes = caustics.notes(extent)
    settings: dict[str, Knob] = {"quick": quick}
    facts = device_facts(renderer.device)
    report = caustics_report(stage.scene.model_dump(mode="json"), settings, facts, points, notes)
    write(report, out)
    return report


def study_growth(out: Path, progress: Progress, *, quick: bool, fresh: bool = False) -> Report:
    """Fit how cost grows with pixels, facets, bounces, wavelengths, stones, lights, contacts, sessions and viewers."""
    renderer, extent = Renderer(), growth.QUICK if quick else growth.FULL
    identity = _identity("growth", Stage.of(Scene()), quick, code_digest(GROWTH_STUDY), renderer.device)
    with PointJournal(out / JOURNAL, identity, fresh=fresh) as journal:
        with progress("growth", len(extent.sweeps)) as advance:
            growth.measure_all(renderer, extent, journal, advance)
        points = list(journal.points.values())
    report = growth_report({"quick": quick}, device_facts(renderer.device), points, extent)
    write(report, out)
    return report


def _identity(study: str, stage: Stage, quick: bool, code: str, device: Device | None = None) -> dict[str, object]:
    """What must be the same for points to belong together."""
    surfaces = b"".join(shape.vertices.tobytes() + shape.triangles.tobytes() for shape in stage.shapes)
    shapes = hashlib.sha256(surfaces).hexdigest()[:16]
    sky = None if stage.panorama is None else hashlib.sha256(stage.panorama.tobytes()).hexdigest()[:16]
    text = hashlib.sha256(stage.scene.model_dump_json().encode())
    return {
        "study": study, "scene": text.hexdigest()[:16], "stone": shapes, "sky": sky,
        "quick": quick, "processor": processor(), "code": code, "packages": peer_versions(),
        **({} if device is None else device_facts(device)),
    }  # fmt: skip

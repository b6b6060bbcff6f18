"""The study of the simulation: integrators and step sizes against error, on motions whose truth is known.

One integrator by itself on a free top, step by step (`tops`), its order fitted; then the models as the server runs them
on the scene's stone (`motions`).
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from culet.geometry.shape import MassProperties, Shape
from culet.simulation.one_stone.models import MODELS
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import INTEGRATORS
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.rigid_body.settings import SimulationSettings as Settings
from culet.simulation.rigid_body.state import Quaternion
from culet.study.findings.convergence import fit_order
from culet.study.findings.journal import PointJournal
from culet.study.motion.motions import End, KnownMotion, motions_of, started
from culet.study.motion.tops import TOP_MOMENTS, TOP_SECONDS, TOP_SPIN, angle_between, rotation_truth
from culet.study.report import Figure, Fit, Knob, Point

FIGURES: dict[str, Figure] = {
    "cpu_seconds": Figure(unit="s/s", about="Processor seconds a simulated second, median."),
    "position_error": Figure(unit="R", about="Distance of the centre of mass from where it should be, at the end."),
    "attitude_error": Figure(unit="rad", about="Angle between the attitude and what it should be, at the end."),
    "energy_error": Figure(unit="", about="Energy's relative error at the end; drop: what it has above its start's."),
    "momentum_error": Figure(unit="", about="Relative error of the momentum, or of the angular momentum if larger."),
    "penetration": Figure(unit="R", about="Deepest that a vertex was inside the floor, at any step."),
}
"""Null where a motion says nothing of it."""

ROTATION_STEPS = tuple(1 / n for n in (15, 30, 60, 120, 240, 480, 960))
TIME_STEPS = tuple(1 / n for n in (15, 30, 60, 120, 240))
CONTACT_STEPS = (0.1, 0.05, 0.02, 0.01, 0.005)
CONTACT_TIME_STEP = 1 / 30
"""s, where CONTACT_STEPS, in sqrt(R / g), are swept: the longest of them takes 0.032 s, and a shorter step would cut
it off."""
DEFAULTS = Settings()
"""What a scene has that says nothing of it."""


def measure_all(shape: Shape, journal: PointJournal, *, quick: bool, progress: Callable[[str, int], None]) -> None:
    """Every point that the journal lacks."""
    for done, (key, run) in enumerate(points_of(shape, quick=quick)):
        progress(key, done)
        if key not in journal:
            journal.add(run())


def points_of(shape: Shape, *, quick: bool) -> list[tuple[str, Callable[[], Point]]]:
    """Key of each point and how to measure it."""
    repeats = 2 if quick else 5
    return [*_rotations(shape, repeats, quick=quick), *_motions(shape, repeats, quick=quick)]


def fits_of(points: list[Point]) -> list[Fit]:
    """The order in time step of each integrator by itself, for attitude and energy."""
    fits = []
    for integrator in INTEGRATORS:
        own = [p for p in points if p.group == "rotation" and p.knobs["integrator"] == integrator]
        for error in ("attitude_error", "energy_error"):
            steps = [float(p.knobs["time_step"] or 0) for p in own]
            fit = fit_order(steps, [p.figures[error] or 0.0 for p in own])
            if fit is not None:
                fits.append(Fit(label=integrator, error=error, step="time_step", order=fit.order, points=fit.points))
    return fits


def _rotations(shape: Shape, repeats: int, *, quick: bool) -> Iterator[tuple[str, Callable[[], Point]]]:
    shaped = replace(shape, mass=MassProperties(shape.mass.volume, np.diag(TOP_MOMENTS)))
    body = RigidBody.of(Settings(mass=1), shaped)
    momentum = body.angular_momentum(IDENTITY, TOP_SPIN)
    truth: list[Quaternion] = []
    for integrator in INTEGRATORS:
        for step in ROTATION_STEPS[: 5 if quick else None]:
            knobs: dict[str, Knob] = {"integrator": integrator, "time_step": step}

            def run(integrator: str = integrator, step: float = step, knobs: dict[str, Knob] = knobs) -> Point:
                if not truth:
                    truth.append(rotation_truth(body, IDENTITY, momentum, TOP_SECONDS))
                seconds, q = [], IDENTITY
                for _ in range(repeats):
                    q, start = IDENTITY, time.process_time()
                    for _ in range(round(TOP_SECONDS / step)):
                        q = INTEGRATORS[integrator](body, q, momentum, step)
                    seconds.append((time.process_time() - start) / TOP_SECONDS)
                before = float(np.dot(momentum, body.angular_velocity_at(IDENTITY, momentum)))
                after = float(np.dot(momentum, body.angular_velocity_at(q, momentum)))
                return _point(
                    "rotation",
                    knobs,
                    cpu_seconds=statistics.median(seconds),
                    attitude_error=angle_between(truth[0], q),
                    energy_error=abs(after / before - 1),
                )

            yield _key("rotation", knobs), run


def _motions(shape: Shape, repeats: int, *, quick: bool) -> Iterator[tuple[str, Callable[[], Point]]]:
    for motion, truth_of in motions_of(shape):
        truth: list[End] = []
        for knobs in _variants(motion.name, quick=quick):

            def run(
                motion: KnownMotion = motion,
                truth_of: Callable[[str], End] = truth_of,
                truth: list[End] = truth,
                knobs: dict[str, Knob] = knobs,
            ) -> Point:
                if motion.name == "bounce":  # the models land on different bodies: the hull, or its sphere
                    return _run(motion, shape, knobs, truth_of(str(knobs["model"])), repeats)
                if not truth:
                    truth.append(truth_of("rigid"))
                return _run(motion, shape, knobs, truth[0], repeats)

            yield _key(motion.name, knobs), run


def _variants(name: str, *, quick: bool) -> Iterator[dict[str, Knob]]:
    """One knob of the model after the other; `classic` has the time step alone."""
    base: dict[str, Knob] = {
        "model": "rigid", "integrator": DEFAULTS.integrator, "time_step": CONTACT_TIME_STEP,
        "contact_step": DEFAULTS.contact_step,
    }  # fmt: skip
    steps = TIME_STEPS[1:4] if quick else TIME_STEPS
    yield from ({**base, "time_step": step} for step in steps)
    if name in ("flight", "drop"):
        yield from (
            {**base, "integrator": integrator, "time_step": step}
            for integrator in INTEGRATORS
            if integrator != base["integrator"]
            for step in steps
        )
    if name == "slide":  # the others do not stay in contact
        contact_steps = CONTACT_STEPS[::2] if quick else CONTACT_STEPS
        yield from ({**base, "contact_step": step} for step in contact_steps if step != base["contact_step"])
    for model in MODELS:
        if model != "rigid":
            for step in steps:
                yield {"model": model, "time_step": step}


def _run(motion: KnownMotion, shape: Shape, knobs: dict[str, Knob], truth: End, repeats: int) -> Point:
    seconds: list[float] = []
    simulation = started(motion, shape, knobs)
    for _ in range(repeats):
        simulation.reset()
        start = time.process_time()
        while simulation.state.time < motion.seconds - 1e-9:
            simulation.step()
        seconds.append((time.process_time() - start) / simulation.state.time)
    state, energy = simulation.state, simulation.energy()
    simulation.reset()
    deepest = 0.0
    while simulation.state.time < motion.seconds - 1e-9:
        simulation.step()
        deepest = max(deepest, -simulation.touch().clearance)
    figures: dict[str, float] = {"cpu_seconds": statistics.median(seconds), "penetration": deepest}
    if truth.position is not None:
        figures["position_error"] = float(np.linalg.norm(np.array(state.position) - truth.position))
    if truth.orientation is not None:
        figures["attitude_error"] = angle_between(truth.orientation, state.orientation)
    if truth.energy is not None:
        gain = energy - truth.energy
        figures["energy_error"] = (max(gain, 0.0) if motion.name == "drop" else abs(gain)) / truth.energy_scale
    if truth.momentum is not None:
        found = np.array([*state.momentum, *state.angular_momentum])
        apart = found - truth.momentum
        linear, angular = truth.momentum_scale
        figures["momentum_error"] = float(max(np.linalg.norm(apart[:3]) / linear, np.linalg.norm(apart[3:]) / angular))
    return _point(motion.name, knobs, **figures)


def _key(group: str, knobs: dict[str, Knob]) -> str:
    return " ".join([group, *(f"{k}={v:g}" if isinstance(v, float) else f"{k}={v}" for k, v in knobs.items())])


def _point(group: str, knobs: dict[str, Knob], **figures: float) -> Point:
    words = [f"{k.replace('_', ' ')} {_step(v)}" for k, v in knobs.items() if k != "model"]
    label = ", ".join([str(knobs["model"]), *words] if "model" in knobs else words)
    measured = {name: figures.get(name) for name in FIGURES}
    known = {name: value if value is not None and math.isfinite(value) else None for name, value in measured.items()}
    return Point(key=_key(group, knobs), group=group, label=label, knobs=knobs, figures=known)


def _step(value: Knob) -> str:
    """1/30 rather than 0.0333333."""
    if isinstance(value, float):
        whole = round(1 / value) if value > 0 else 0
        return f"1/{whole}" if whole > 1 and abs(whole * value - 1) < 1e-12 and whole % 5 == 0 else f"{value:g}"
    return str(value)

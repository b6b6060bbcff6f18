"""The study of the simulation: integrators and step sizes against error, on motions whose truth is known.

rotation  one integrator by itself on a free top of three unequal moments, step by step; its order is fitted.
          Truth: DOP853 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I) at 1e-13.
flight    the whole model, the scene's stone in free fall. Truth: the parabola, and DOP853.
bounce    a flat landing without friction. Truth: parabolas, each e times as fast as the one before.
slide     Coulomb friction on the floor. Truth: v^2 / (2 mu g).
drop      a tilted, spinning stone, past its first impacts. No closed form: the truth is `rigid` at REFERENCE_STEP,
          and ends where the next impact would make any small difference large.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from culet.geometry.stone import MassProperties, Stone
from culet.scene.model import Simulation as Settings
from culet.simulation.body import RigidBody
from culet.simulation.floor import FLOOR
from culet.simulation.free_rotation import INTEGRATORS
from culet.simulation.models import MODELS
from culet.simulation.rotation import product, rotate
from culet.simulation.simulation import Simulation
from culet.simulation.state import Quaternion, Triple
from culet.study.convergence import fit_order
from culet.study.journal import Journal
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

TOP_MOMENTS = (1.0, 1.4, 2.1)
"""mass R^2, all different: the general top."""
TOP_SPIN: Triple = (3.0, 4.0, 3.5)
"""rad/s."""
TOP_SECONDS = 4.0
ROTATION_STEPS = tuple(1 / n for n in (15, 30, 60, 120, 240, 480, 960))
TIME_STEPS = tuple(1 / n for n in (15, 30, 60, 120, 240))
CONTACT_STEPS = (0.1, 0.05, 0.02, 0.01, 0.005)
REFERENCE_STEP: dict[str, Knob] = {"time_step": 1 / 960, "contact_step": 0.001, "integrator": "rkmk4"}
DEFAULT_TIME_STEP = 1 / 30
TOLERANCE = 1e-13

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Motion:
    """A start, how long it lasts, and which numbers of the settings it fixes."""

    name: str
    seconds: float
    position: Triple
    orientation: Quaternion
    fixed: dict[str, object]


class End(NamedTuple):
    """Where a motion ends; None: unknown."""

    position: NDArray[np.float64] | None
    orientation: Quaternion | None
    energy: float | None
    momentum: NDArray[np.float64] | None
    """Linear, then angular."""
    energy_scale: float
    momentum_scale: tuple[float, float]


def measure_all(stone: Stone, journal: Journal, *, quick: bool, progress: Callable[[str, int], None]) -> None:
    """Every point that the journal lacks."""
    for done, (key, run) in enumerate(points_of(stone, quick=quick)):
        progress(key, done)
        if key not in journal:
            journal.add(run())


def points_of(stone: Stone, *, quick: bool) -> list[tuple[str, Callable[[], Point]]]:
    """Key of each point and how to measure it."""
    repeats = 2 if quick else 5
    return [*_rotations(stone, repeats, quick=quick), *_motions(stone, repeats, quick=quick)]


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


def rotation_truth(body: RigidBody, orientation: Quaternion, angular_momentum: Triple, seconds: float) -> Quaternion:
    """The attitude after a free rotation, to some 1e-12 rad."""

    def rate(_: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
        w, x, y, z = q / np.linalg.norm(q)
        a, b, c = body.angular_velocity_at((w, x, y, z), angular_momentum)
        return np.array(product((0.0, a / 2, b / 2, c / 2), (w, x, y, z)))

    solution = solve_ivp(rate, (0, seconds), orientation, "DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    w, x, y, z = (solution.y[:, -1] / np.linalg.norm(solution.y[:, -1])).tolist()
    return w, x, y, z


def angle_between(a: Quaternion, b: Quaternion) -> float:
    """rad of the turn that takes one attitude into the other; exact for small angles too."""
    conjugate = (a[0], -a[1], -a[2], -a[3])
    w, x, y, z = product(b, conjugate)
    return 2 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))


def _rotations(stone: Stone, repeats: int, *, quick: bool) -> Iterator[tuple[str, Callable[[], Point]]]:
    shaped = replace(stone, mass=MassProperties(stone.mass.volume, np.diag(TOP_MOMENTS)))
    body = RigidBody.of(Settings(mass=1), shaped)
    momentum = body.angular_momentum(UPRIGHT, TOP_SPIN)
    truth: list[Quaternion] = []
    for integrator in INTEGRATORS:
        for step in ROTATION_STEPS[: 5 if quick else None]:
            knobs: dict[str, Knob] = {"integrator": integrator, "time_step": step}

            def run(integrator: str = integrator, step: float = step, knobs: dict[str, Knob] = knobs) -> Point:
                if not truth:
                    truth.append(rotation_truth(body, UPRIGHT, momentum, TOP_SECONDS))
                seconds, q = [], UPRIGHT
                for _ in range(repeats):
                    q, start = UPRIGHT, time.process_time()
                    for _ in range(round(TOP_SECONDS / step)):
                        q = INTEGRATORS[integrator](body, q, momentum, step)
                    seconds.append((time.process_time() - start) / TOP_SECONDS)
                before = float(np.dot(momentum, body.angular_velocity_at(UPRIGHT, momentum)))
                after = float(np.dot(momentum, body.angular_velocity_at(q, momentum)))
                return _point(
                    "rotation",
                    knobs,
                    cpu_seconds=statistics.median(seconds),
                    attitude_error=angle_between(truth[0], q),
                    energy_error=abs(after / before - 1),
                )

            yield _key("rotation", knobs), run


def _motions(stone: Stone, repeats: int, *, quick: bool) -> Iterator[tuple[str, Callable[[], Point]]]:
    for motion, truth_of in _cases(stone):
        truth: list[End] = []
        for knobs in _variants(motion.name, quick=quick):

            def run(
                motion: Motion = motion,
                truth_of: Callable[[str], End] = truth_of,
                truth: list[End] = truth,
                knobs: dict[str, Knob] = knobs,
            ) -> Point:
                if motion.name == "bounce":  # the models land on different bodies: the hull, or its sphere
                    return _run(motion, stone, knobs, truth_of(str(knobs["model"])), repeats)
                if not truth:
                    truth.append(truth_of("rigid"))
                return _run(motion, stone, knobs, truth[0], repeats)

            yield _key(motion.name, knobs), run


def _variants(name: str, *, quick: bool) -> Iterator[dict[str, Knob]]:
    """One knob of the model after the other; `classic` has the time step alone."""
    base: dict[str, Knob] = {
        "model": "rigid", "integrator": "rkmk4", "time_step": DEFAULT_TIME_STEP, "contact_step": 0.02,
    }  # fmt: skip
    steps = TIME_STEPS[:3] if quick else TIME_STEPS
    yield from ({**base, "time_step": step} for step in steps)
    if name in ("flight", "drop"):
        yield from (
            {**base, "integrator": integrator, "time_step": step}
            for integrator in INTEGRATORS
            if integrator != base["integrator"]
            for step in steps
        )
    if name in ("slide", "drop"):
        contact_steps = CONTACT_STEPS[::2] if quick else CONTACT_STEPS
        yield from ({**base, "contact_step": step} for step in contact_steps if step != base["contact_step"])
    for model in MODELS:
        if model != "rigid":
            for step in steps:
                yield {"model": model, "time_step": step}


def _cases(stone: Stone) -> Iterator[tuple[Motion, Callable[[str], End]]]:
    flight = Motion("flight", 2.0, (0.0, 100.0, 0.0), UPRIGHT, {"spin": (0.5, 3, 1), "velocity": (1, 2, -0.5)})
    yield flight, lambda _: _flight_end(flight, stone)
    lying = flat_orientation(stone)
    half_height = float(-_heights(stone, lying).min())
    bounce = Motion(
        "bounce",
        23 / 15,
        (0.0, FLOOR + 2.5, 0.0),
        lying,
        {"spin": (0, 0, 0), "friction": 0, "restitution": 0.6, "random_torque": 0},
    )
    yield bounce, lambda model: bounce_truth(bounce, 1.0 if model == "classic" else half_height)
    slide = Motion(
        "slide", 1.0, (0.0, FLOOR + half_height, 0.0), lying,
        {"spin": (0, 0, 0), "velocity": (1, 0, 0), "friction": 0.3, "rolling_resistance": 0, "sleeping": False},
    )  # fmt: skip
    yield slide, lambda _: _slide_end(slide)
    drop = Motion(
        "drop", 1.0, (0.0, 0.5, 0.0), (0.93670, 0.33047, 0.0, 0.11566), {"spin": (0.5, 3, 0), "random_torque": 0}
    )
    yield drop, lambda _: _drop_end(drop, stone)


def flat_orientation(stone: Stone) -> Quaternion:
    """The stone turned so that the facet with the largest area is its lowest."""
    areas = np.zeros(len(stone.planes))
    corners = stone.vertices[stone.triangles]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    np.add.at(areas, stone.facet_of_triangle, doubled)
    x, y, z = stone.planes[int(areas.argmax()), :3].tolist()
    if y > 1 - 1e-12:
        return (0.0, 1.0, 0.0, 0.0)
    # the half-way quaternion from the normal n to -e_y is (1 - n.y, n x -e_y), normalised
    q = np.array([1 - y, z, 0.0, -x])
    w, a, b, c = (q / np.linalg.norm(q)).tolist()
    return w, a, b, c


def _heights(stone: Stone, orientation: Quaternion) -> NDArray[np.float64]:
    return np.array([rotate(orientation, tuple(vertex))[1] for vertex in stone.vertices.tolist()])


def _settings(motion: Motion, knobs: dict[str, Knob]) -> Settings:
    return Settings.model_validate({**motion.fixed, **{k: v for k, v in knobs.items() if v is not None}})


def _start(motion: Motion, stone: Stone, knobs: dict[str, Knob]) -> Simulation:
    return Simulation(_settings(motion, knobs), stone, motion.position, motion.orientation)


def _run(motion: Motion, stone: Stone, knobs: dict[str, Knob], truth: End, repeats: int) -> Point:
    seconds: list[float] = []
    simulation = _start(motion, stone, knobs)
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


def _flight_end(motion: Motion, stone: Stone) -> End:
    simulation = _start(motion, stone, {"model": "rigid"})
    body, state, g = simulation.body, simulation.state, simulation.settings.gravity
    t = motion.seconds
    velocity = np.array(body.velocity(state))
    fall = np.array([0.0, g, 0.0])
    momentum = body.mass * (velocity - fall * t)
    return End(
        position=np.array(state.position) + velocity * t - fall * t * t / 2,
        orientation=rotation_truth(body, state.orientation, state.angular_momentum, t),
        energy=simulation.energy(),
        momentum=np.array([*momentum, *state.angular_momentum]),
        energy_scale=body.energy(state, 0),  # the kinetic part: the height's zero is arbitrary
        momentum_scale=(float(np.linalg.norm(momentum)), float(np.linalg.norm(state.angular_momentum))),
    )


def bounce_truth(motion: Motion, radius: float) -> End:
    """Where a body of that radius is that lands flat and without friction, each bounce e times as fast as the last."""
    settings = _settings(motion, {})
    g, e, mass = settings.gravity, settings.restitution, settings.mass
    clearance = motion.position[1] - FLOOR - radius
    t, speed = motion.seconds - math.sqrt(2 * clearance / g), e * math.sqrt(2 * g * clearance)
    if t >= 2 * speed / g / (1 - e):  # infinitely many bounces are over
        t = speed = 0.0
    while t > 2 * speed / g:
        t, speed = t - 2 * speed / g, e * speed
    height, velocity = speed * t - g * t * t / 2, speed - g * t
    y = FLOOR + radius + height
    energy = mass * (velocity**2 / 2 + g * (y - FLOOR - 1))
    start = mass * g * clearance
    return End(
        position=np.array([0.0, y, 0.0]),
        orientation=motion.orientation,
        energy=energy,
        momentum=np.array([0, mass * velocity, 0, 0, 0, 0]),
        energy_scale=start,
        momentum_scale=(mass * math.sqrt(2 * g * clearance), mass),
    )


def _slide_end(motion: Motion) -> End:
    settings = _settings(motion, {})
    speed, decay = settings.velocity[0], settings.friction * settings.gravity
    x, y, z = motion.position
    stopped = np.array([x + speed**2 / (2 * decay), y, z])
    scale = settings.mass * speed
    return End(
        position=stopped,
        orientation=motion.orientation,
        energy=settings.mass * settings.gravity * (y - FLOOR - 1),
        momentum=np.zeros(6),
        energy_scale=settings.mass * speed**2 / 2,
        momentum_scale=(scale, scale),
    )


def _drop_end(motion: Motion, stone: Stone) -> End:
    simulation = _start(motion, stone, {"model": "rigid", **REFERENCE_STEP})
    start = simulation.energy()
    while simulation.state.time < motion.seconds - 1e-9:
        simulation.step()
    state = simulation.state
    linear = simulation.body.mass * math.sqrt(2 * simulation.settings.gravity * motion.position[1] + 1)
    return End(
        position=np.array(state.position),
        orientation=state.orientation,
        energy=start,
        momentum=np.array([*state.momentum, *state.angular_momentum]),
        energy_scale=simulation.body.mass * simulation.settings.gravity,
        momentum_scale=(linear, linear),
    )


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

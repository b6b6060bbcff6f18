"""The compiled solver's impulses of one stone: those of the same equations in plain Python, to the last bit."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.scene.cuts import CUTS
from culet.scene.stone import StoneSettings
from culet.simulation.one_stone import contact_step, impact, impulses
from culet.simulation.one_stone.contact import Contact, closing_speed, contacts
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, velocities
from culet.simulation.solver.build import build, compilers
from culet.simulation.solver.library import loaded
from simulation.one_stone.plain import impulses as plain
from simulation.solids import TILTED, advance, random_body, rigid

FRICTIONS = (0.0, 0.1, 0.3, 1.0, 10.0, 1e3)


def bits(motion: BodyMotion, points: list[Contact]) -> bytes:
    return np.array([*motion.momentum, *motion.angular_momentum, *(c for p in points for c in p.impulse)]).tobytes()


def check(
    motion: BodyMotion, body: RigidBody, points: list[Contact], targets: list[float], friction: float
) -> BodyMotion:
    twins = [replace(point) for point in points]
    found = impulses.solve(motion, body, points, targets, friction)
    assert bits(found, points) == bits(plain.solve(motion, body, twins, targets, friction), twins)
    return found


@pytest.fixture(params=["installed", "gcc", "clang"])
def solver(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The library that is used, and those of both compilers."""
    if request.param == "installed":
        return
    found = next((path for path in compilers() if Path(path).name.startswith(request.param)), None)
    if found is None:
        pytest.skip(f"not shown, since there is no {request.param}: {request.node.originalname}")
    made: ctypes.CDLL = loaded(build(tmp_path, found))
    monkeypatch.setattr(impulses, "library", lambda: made)


@pytest.mark.usefixtures("solver")
def test_random_contacts_get_the_impulses_of_plain_python(brilliant: Shape, box: Shape) -> None:
    """As in an impact, in a step against gravity, and with a gap that may close; friction up to what cannot settle."""
    rng = np.random.default_rng(12)
    for number in range(1200):
        body, motion = random_body((brilliant, box)[number % 2], rng)
        points, friction = contacts(motion, body), float(rng.choice(FRICTIONS))
        velocity, omega = velocities(motion, body)
        closing = [max(closing_speed(point, velocity, omega), 0.0) for point in points]
        targets = [
            [float(rng.choice([0, 0.6, 1])) * speed for speed in closing],
            [0.0] * len(points),
            [-float(rng.random()) * speed for speed in closing],
        ][number % 3]
        check(motion, body, points, targets, friction)


def test_a_stone_that_no_contact_stops_keeps_its_momenta(brilliant: Shape) -> None:
    body, motion = random_body(brilliant, np.random.default_rng(3))
    assert check(motion, body, [], [], 0.3) == motion


@pytest.mark.parametrize("cut", sorted(CUTS))
def test_a_fall_of_every_cut_asks_for_the_same_impulses(cut: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two seconds of bouncing, rolling and rocking: each question that the model asks in them is asked of both."""
    asked = 0

    def both(
        motion: BodyMotion, body: RigidBody, points: list[Contact], targets: list[float], friction: float
    ) -> BodyMotion:
        nonlocal asked
        asked += 1
        return check(motion, body, points, targets, friction)

    monkeypatch.setattr(impact, "solve", both)
    monkeypatch.setattr(contact_step, "solve", both)
    shape = shape_of(StoneSettings.model_validate({"cut": {"name": cut}}), {})
    advance(rigid(shape, (0.0, 0.5, 0.0), TILTED, spin=(2, 1, -3), rolling_resistance=0.01, restitution=0.2), 2.0)
    assert asked > 50

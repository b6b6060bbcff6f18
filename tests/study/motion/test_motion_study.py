"""The truths that the study of the simulation judges by, and what it finds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from culet.geometry.shape import MassProperties, Shape
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.rotation import rotate, rotate_back
from culet.simulation.rigid_body.settings import SimulationSettings as Settings
from culet.study.findings.journal import PointJournal
from culet.study.motion.motions import KnownMotion, bounce_truth, flat_orientation
from culet.study.motion.simulation import fits_of, measure_all, points_of
from culet.study.motion.tops import TOP_MOMENTS, TOP_SPIN, angle_between, rotation_truth
from culet.study.report import Point
from simulation.jacobi import FreeTop
from simulation.solids import UPRIGHT


@pytest.fixture(scope="module")
def points(brilliant: Shape) -> dict[str, Point]:
    """All of a quick study but the slow slide, by key."""
    chosen = [(key, run) for key, run in points_of(brilliant, quick=True) if not key.startswith("slide")]
    return {key: run() for key, run in chosen}


def figure(points: dict[str, Point], beginning: str, name: str) -> float:
    (value,) = [point.figures[name] for key, point in points.items() if key.startswith(beginning)]
    assert value is not None
    return value


def test_the_truth_of_a_free_rotation_is_jacobis(brilliant: Shape) -> None:
    shaped = replace(brilliant, mass=MassProperties(1.0, np.diag(TOP_MOMENTS)))
    body = RigidBody.of(Settings(mass=1), shaped)
    momentum = body.angular_momentum(UPRIGHT, TOP_SPIN)
    q = rotation_truth(body, UPRIGHT, momentum, 4.0)
    omega = rotate_back(q, body.angular_velocity_at(q, momentum))
    assert omega == pytest.approx(FreeTop(TOP_MOMENTS, TOP_SPIN).omega(4.0), abs=1e-10)  # measured 7e-12


@pytest.mark.parametrize("angle", [1e-9, 0.1, 3.0])
def test_the_angle_between_attitudes_is_that_of_the_turn(angle: float) -> None:
    turned = (math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0)
    assert angle_between(UPRIGHT, turned) == pytest.approx(angle, rel=1e-7)
    assert angle_between(UPRIGHT, (-turned[0], 0.0, -turned[2], 0.0)) == pytest.approx(angle, rel=1e-7)


def test_lying_flat_the_largest_facet_is_below(brilliant: Shape) -> None:
    heights = [rotate(flat_orientation(brilliant), tuple(vertex))[1] for vertex in brilliant.vertices.tolist()]
    assert sum(height < min(heights) + 1e-9 for height in heights) == 8  # the table's corners


@pytest.mark.parametrize(
    ("integrator", "order"), [("rkmk4", 4), ("rk4", 4), ("midpoint", 2), ("splitting", 2), ("symmetric_top", 2)]
)
def test_integrators_have_the_orders_that_theory_gives_them(
    points: dict[str, Point], integrator: str, order: int
) -> None:
    fits = {fit.label: fit.order for fit in fits_of(list(points.values())) if fit.error == "attitude_error"}
    assert fits[integrator] == pytest.approx(order, abs=0.4)  # measured 4.32, 4.20, 2.00, 1.98, 2.00


def test_the_rigid_model_falls_on_the_parabola_and_the_classic_beside_it(points: dict[str, Point]) -> None:
    assert (
        figure(points, "flight model=rigid integrator=rkmk4 time_step=0.0333", "position_error") < 1e-11
    )  # measured 3e-13
    # symplectic Euler is g h t / 2 too low: 9.81 x 2 / 60
    classic = figure(points, "flight model=classic time_step=0.0333", "position_error")
    assert classic == pytest.approx(9.81 * 2 / 60, rel=1e-6)


def test_a_flat_bounce_comes_back_when_restitution_says(points: dict[str, Point]) -> None:
    assert (
        figure(points, "bounce model=rigid integrator=rkmk4 time_step=0.00833", "position_error") < 2e-6
    )  # measured 3e-7
    assert figure(points, "bounce model=rigid integrator=rkmk4 time_step=0.0333", "energy_error") < 5e-7  # 1e-7


@pytest.mark.parametrize(("seconds", "height"), [(1.0, 0.0), (1.5, 4.905 / 4), (2.0, 0.0), (4.0, 0.0), (60.0, 0.0)])
def test_a_point_that_falls_a_second_bounces_until_it_rests(seconds: float, height: float) -> None:
    """From g / 2 it falls a second; with e = 1/2 its bounces last 1, 1/2, 1/4 ... s, 2 s in all. The first rises to a
    quarter of the height, half a second after the landing."""
    motion = KnownMotion("bounce", seconds, (0.0, 4.905, 0.0), UPRIGHT, {"gravity": 9.81, "restitution": 0.5})
    end = bounce_truth(motion, radius=1.0)
    assert end.position is not None
    assert end.position[1] == pytest.approx(height, abs=1e-9)


def test_a_drop_converges_to_its_finest_steps_and_gains_no_energy(points: dict[str, Point]) -> None:
    errors = [
        figure(points, f"drop model=rigid integrator=midpoint time_step={step}", "position_error")
        for step in ("0.0333", "0.0166", "0.00833")
    ]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]  # measured 3.0e-4, 7.9e-5, 2.0e-5: of second order
    assert figure(points, "drop model=rigid integrator=rkmk4 time_step=0.0166", "position_error") < 1e-6  # 4e-8
    drops = [point for key, point in points.items() if key.startswith("drop model=rigid")]
    assert {point.figures["energy_error"] for point in drops} == {0}


def test_points_that_are_in_the_journal_are_not_measured_again(brilliant: Shape, tmp_path: Path) -> None:
    told: list[int] = []
    keys = [key for key, _ in points_of(brilliant, quick=True)]
    known = Point(key="", group="g", label="", knobs={}, figures={})
    with PointJournal(tmp_path / "j", {"study": "simulation"}) as journal:
        journal.points |= {key: known.model_copy(update={"key": key}) for key in keys[1:]}
        measure_all(brilliant, journal, quick=True, progress=lambda _, done: told.append(done))
        assert journal.points[keys[0]].group == "rotation"
        assert all(journal.points[key].group == "g" for key in keys[1:])
    assert told == list(range(len(keys)))

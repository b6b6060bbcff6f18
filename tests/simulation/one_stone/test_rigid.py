"""The model `rigid` as a whole: the same bits, the same drop in other units, and its behaviour at every extreme."""

from __future__ import annotations

import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
import trimesh

from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.simulation.clock import FixedStepClock
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS, Surface
from shared.trimesh_stones import by_trimesh
from simulation.solids import TABLE_DOWN, TILTED, UPRIGHT, G, about, advance, digest, nearest, numbers, rigid

ROOM = (FLOOR, *WALLS)


def test_a_drop_is_the_same_bits_everywhere(exact_box: Shape) -> None:
    """Flight, impacts, sliding, rolling and sleep. A change of this hash is a change of the model."""
    moving = rigid(exact_box, (0.0, 2.0, 0.0), TILTED, spin=(1, 2, 3), rolling_resistance=0.01, time_step=1 / 60)
    path = advance(moving, 8)
    assert path[-1].impacts > 3
    assert path[-1].asleep
    assert digest(path) == "b9f3dc3a7dc827df3b9ce3244010a4d3dc2fa8443f415bdfd4fe407669065449"


@pytest.mark.parametrize("frames", [[1 / 60], [1 / 7], [0.001, 0.08, 0.033]])
def test_frames_and_pauses_do_not_change_the_path(box: Shape, frames: list[float]) -> None:
    settings: dict[str, Any] = {"spin": (1, 2, 3), "time_step": 1 / 60}
    path = advance(rigid(box, orientation=TILTED, **settings), 3)
    moving, clock = rigid(box, orientation=TILTED, **settings), FixedStepClock(1 / 60)
    for elapsed in itertools.cycle(frames):
        for _ in range(clock.advance(elapsed)):
            moving.step()
            assert moving.state == path[moving.state.step - 1]
        clock.restart()
        if moving.state.step >= 150:
            break


@pytest.mark.parametrize("at", [1, 110, 140, 200])
def test_a_snapshot_goes_on_to_the_same_bits_through_json(box: Shape, at: int) -> None:
    whole, other = (rigid(box, orientation=TILTED, spin=(1, 2, 3)) for _ in range(2))
    for _ in range(at):
        whole.step()
    other.restore(json.loads(json.dumps(whole.snapshot(), allow_nan=False)))
    assert digest(advance(other, 1)) == digest(advance(whole, 1))


def scaled_drop(stone: Shape, time: float, mass: float, impacts: int) -> list[tuple[float, ...]]:
    """A drop where a second is `time` of ours and the mass `mass` times as large: poses up to so many impacts."""
    moving = rigid(
        stone, (0.0, 2.0, 0.0), TILTED, ROOM, gravity=9.81 * time**2, spin=(1 * time, 2 * time, 3 * time),
        velocity=(0.5 * time, 0, 0), time_step=1 / 60 / time, mass=2 * mass,
    )  # fmt: skip
    path: list[tuple[float, ...]] = []
    while moving.state.impacts <= impacts and moving.state.step < 240:  # 4 s: until it rolls
        moving.step()
        path.append((*moving.state.position, *moving.state.orientation))
    return path


@pytest.mark.parametrize(("time", "mass"), [(0.25, 1.0), (16.0, 2.0**-20)])
def test_the_same_drop_in_units_of_powers_of_two_is_the_same_to_the_bit(
    brilliant: Shape, time: float, mass: float
) -> None:
    assert scaled_drop(brilliant, time, mass, 1000) == scaled_drop(brilliant, 1, 1, 1000)


@pytest.mark.parametrize(("time", "mass"), [(1.7, 1.0), (0.3, 1.0), (1.0, 3e5), (7.0, 1e-7)])
def test_the_same_drop_in_any_units_agrees_up_to_its_second_impact(brilliant: Shape, time: float, mass: float) -> None:
    other, ours = scaled_drop(brilliant, time, mass, 1), scaled_drop(brilliant, 1, 1, 1)
    length = min(len(other), len(ours)) - 1
    assert length > 40
    assert np.array(other[:length]) == pytest.approx(np.array(ours[:length]), abs=1e-12)  # measured 6e-15


@pytest.mark.parametrize("unit", [1e-3, 25.4])
def test_the_same_drop_of_a_stone_in_another_unit_of_length_agrees(unit: float) -> None:
    mesh = trimesh.creation.cone(radius=1, height=1.3, sections=16)
    ours = by_trimesh("cone", mesh)
    other = by_trimesh("cone", trimesh.Trimesh(mesh.vertices * unit, mesh.faces))
    paths = [np.array(scaled_drop(stone, 1, 1, 1)) for stone in (ours, other)]
    length = min(map(len, paths)) - 1
    assert paths[1][:length] == pytest.approx(paths[0][:length], abs=1e-12)  # measured 1e-15


@pytest.mark.parametrize("unit", [2.0**-10, 2.0**7])
def test_the_same_mesh_in_a_unit_of_a_power_of_two_falls_to_the_bit(brilliant: Shape, unit: float) -> None:
    def read(unit: float) -> Shape:
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (unit * brilliant.vertices).tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (brilliant.triangles + 1).tolist()]
        return shape_from_mesh("\n".join(lines).encode(), "obj")

    assert scaled_drop(read(unit), 1, 1, 1000) == scaled_drop(read(1), 1, 1, 1000)


def test_a_stone_that_is_not_convex_touches_with_its_hull(ring: Shape) -> None:
    moving = rigid(ring, orientation=TILTED, spin=(1, 2, 3), rolling_resistance=0.02)
    while not moving.state.asleep and moving.state.time < 60:
        moving.step()
        assert nearest(moving) > -1e-5
    assert moving.state.asleep


def energy_bound(moving: Simulation) -> float:
    """Rounding, and the rotation's fourth order."""
    return 1e-6 * (abs(moving.energy()) + moving.body.mass * moving.settings.gravity)


def check_extreme(moving: Simulation, steps: int) -> None:
    """Finite, in the room, and never with more energy than before."""
    last, start = moving.energy(), moving.energy()
    allowed = energy_bound(moving)
    for _ in range(steps):
        moving.step()
        state = moving.state
        assert all(math.isfinite(number) for number in numbers(state))
        assert abs(sum(c * c for c in state.orientation) - 1) < 1e-12
        assert nearest(moving) > -1e-4
        assert moving.energy() <= last + allowed
        last = moving.energy()
    assert last <= start + allowed


DENSE: dict[str, tuple[float, dict[str, Any]]] = {
    # where contact steps lift the stone out, their energy is kept by slowing it down: measured 6.4e-3 and 1.9e-4
    "resting at a gravity of 1e6": (
        0.02, {"gravity": 1e6, "time_step": 0.25, "spin": (0, 3, 0), "sleeping": False}
    ),
    "a spin of 1e6 in a long step": (
        0.02, {"spin": (1e6, 1e6, -1e6), "time_step": 0.25, "gravity": 1e6, "restitution": 0}
    ),
    # else only rounding is left: measured 6e-14, 7e-15 and 2e-15
    "bouncing at a gravity of 1e6": (1e-11, {"gravity": 1e6, "restitution": 1, "spin": (60, 90, 40)}),
    "a hundred radians a step": (1e-11, {"spin": (6000, 9000, 4000)}),
    "a thousand radians a step": (1e-11, {"spin": (6e4, 9e4, 4e4), "restitution": 1, "gravity": 1e4}),
}  # fmt: skip


@pytest.mark.parametrize("name", DENSE)
def test_steps_with_too_many_events_to_follow_take_their_time_all_the_same(brilliant: Shape, name: str) -> None:
    """Without friction nothing pushes sideways: the stone is at v t, whatever happens below it."""
    tolerance, settings = DENSE[name]
    moving = rigid(brilliant, (0.0, 0.0, 0.0), TILTED, friction=0, velocity=(3, 0, -1), **settings)
    top = moving.energy()
    for _ in range(8):
        moving.step()
        t = moving.state.time
        assert moving.state.position[0] == pytest.approx(3 * t, rel=tolerance, abs=0)
        assert moving.state.position[2] == pytest.approx(-t, rel=tolerance, abs=0)
        assert nearest(moving) > -1e-4
        assert moving.energy() <= top + energy_bound(moving)
    assert moving.state.coarse > 0


def test_without_gravity_a_stone_that_touches_stays(brilliant: Shape) -> None:
    moving = rigid(brilliant, (0.0, 0.0, 0.0), TILTED, gravity=0)
    moving = rigid(brilliant, (0.0, -nearest(moving), 0.0), TILTED, gravity=0)
    start = moving.state
    path = advance(moving, 0.1)
    assert (path[-1].position, path[-1].orientation) == (start.position, start.orientation)


def test_an_ordinary_drop_is_never_coarse(brilliant: Shape) -> None:
    moving = rigid(brilliant, orientation=TILTED, spin=(1, 2, 3), rolling_resistance=0.01, time_step=1 / 60)
    assert advance(moving, 8)[-1].coarse == 0


@pytest.mark.parametrize("depth", [0.1, 1.0, 50.0])
def test_a_start_below_the_floor_comes_up_without_speed(brilliant: Shape, depth: float) -> None:
    moving = rigid(brilliant, (0.0, -1 - depth, 0.0), TILTED)
    moving.step()
    assert nearest(moving) > -1e-9
    assert moving.state.position[1] <= 0
    assert max(map(abs, moving.body.velocity(moving.state))) < 9.81 / 120 * 1.1


@pytest.mark.parametrize("velocity", [(0, 1, 0), (0, 0.01, 0), (1, 1, 0), (1, 0, 0), (0, 0, 0)])
@pytest.mark.parametrize("height", [-3.0, -1.5, -1.2, -0.9, -0.5])
@pytest.mark.parametrize("orientation", [UPRIGHT, TILTED, TABLE_DOWN])
def test_a_stone_that_leaves_the_floor_without_turning_flies_straight(
    brilliant: Shape, orientation: Quaternion, height: float, velocity: Triple
) -> None:
    """No time is the first at which it touches: room and speed towards the floor are both 0."""
    x, y, z = velocity
    moving = rigid(brilliant, (0.0, height, 0.0), orientation, ROOM, gravity=0, velocity=velocity)
    lift = max(-nearest(moving), 0.0)
    t = advance(moving, 0.25)[-1].time
    assert moving.state.position == pytest.approx((x * t, height + lift + y * t, z * t), abs=1e-12)  # measured 9e-16


def test_a_stone_that_leaves_a_wall_without_turning_falls_on_its_parabola(brilliant: Shape) -> None:
    moving = rigid(brilliant, (0.0, 2.0, -8.5), TILTED, ROOM, velocity=(0, 0, 2))
    lift = -nearest(moving)
    assert lift > 0.1
    t = advance(moving, 0.25)[-1].time
    assert moving.state.position == pytest.approx((0, 2 - G * t * t / 2, -8.5 + lift + 2 * t), abs=1e-12)


def test_a_start_in_a_corner_of_three_planes_comes_out_and_rests(brilliant: Shape) -> None:
    corner: tuple[Surface, ...] = (FLOOR, Surface((1.0, 0.0, 0.0), -1.0), Surface((0.0, 0.0, 1.0), -1.0))
    moving = rigid(brilliant, (-1.5, -1.5, -1.5), TILTED, corner, rolling_resistance=0.01)
    moving.step()
    assert nearest(moving) > -1e-9
    top = moving.energy()
    while not moving.state.asleep and moving.state.time < 30:
        moving.step()
        assert nearest(moving) > -1e-5
        assert moving.energy() <= top + 1e-9
        top = max(moving.energy(), -1e9)
    assert moving.state.asleep


@pytest.mark.parametrize("friction", [1.0, 1.5, 3.0, 1e3])
@pytest.mark.parametrize("angle", [0.3, 0.8, 1.2])
def test_painleves_rod_gets_a_bounded_impulse(friction: float, angle: float) -> None:
    """A rod that slides on its end against the lean: with mu > 4/3 there is no answer, or two (Painlevé 1895)."""
    rod = by_trimesh("rod", trimesh.creation.box((100, 1, 1)))
    orientation = about((0.0, 0.0, 1.0), angle)
    lift = nearest(rigid(rod, orientation=orientation))
    for speed in (5.0, -5.0):
        sliding = rigid(
            rod, (0.0, 4.0 - lift, 0.0), orientation, friction=friction, velocity=(speed, 0, 0), restitution=0,
            time_step=1 / 240,
        )  # fmt: skip
        check_extreme(sliding, 60)


def test_the_integrator_can_be_chosen(box: Shape) -> None:
    ends = set()
    for integrator in ("rkmk4", "rk4", "midpoint", "splitting", "euler"):
        moving = rigid(box, (0.0, 50.0, 0.0), UPRIGHT, spin=(1, 2, 3), integrator=integrator, time_step=1 / 30)
        advance(moving, 1)
        ends.add(moving.state.orientation)
    assert len(ends) == 5

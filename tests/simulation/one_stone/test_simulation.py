"""The running simulation: reproducible, independent of frames, restorable to the bit, finite at every extreme."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import astuple
from typing import Any, get_args

import pytest

from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.scene import preset
from culet.simulation.clock import FixedStepClock
from culet.simulation.one_stone.models import MODELS
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.rotation import rotate
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, RigidState, Triple
from culet.stage import Stage
from simulation.solids import UPRIGHT, classic, digest, numbers

START: Triple = (0.0, 4.0, 0.0)


def states(moving: Simulation, count: int) -> list[RigidState]:
    path = []
    for _ in range(count):
        moving.step()
        path.append(moving.state)
    return path


def test_three_hundred_steps_are_the_same_bits_everywhere(exact_box: Shape) -> None:
    """Only IEEE 754 operations and PCG64's bits take part; a change of this hash is a change of the model."""
    moving = classic(exact_box, seed=1, spin=(0.5, 3, 0))
    path = states(moving, 300)
    assert path[-1].impacts >= 2
    assert digest(path) == "12aaf6c689f40f4e40b21c1a7b9d1ee6a73d16a478fc6c7d82f7e93d712daed7"


def test_the_same_seed_gives_the_same_states(box: Shape) -> None:
    assert states(classic(box, seed=5), 300) == states(classic(box, seed=5), 300)


def test_another_seed_gives_another_path_from_the_first_hard_impact_on(box: Shape) -> None:
    one, other = states(classic(box, seed=5), 60), states(classic(box, seed=6), 60)
    hard = next(i for i, state in enumerate(one) if state.impacts)
    assert one[:hard] == other[:hard]
    assert one[hard].position == other[hard].position
    assert one[hard].angular_momentum != other[hard].angular_momentum
    assert one[-1].orientation != other[-1].orientation


@pytest.mark.parametrize("frames", [[1 / 60], [1 / 7], [0.001, 0.08, 0.033], [1 / 144, 0.5, 0.0]])
def test_frames_do_not_change_the_path(box: Shape, frames: list[float]) -> None:
    path = states(classic(box, seed=9), 200)
    moving, clock = classic(box, seed=9), FixedStepClock(1 / 30)
    for elapsed in itertools.cycle(frames):
        for _ in range(clock.advance(elapsed)):
            moving.step()
            assert moving.state == path[moving.state.step - 1]
        moving.interpolated(clock.fraction)
        if moving.state.step >= 190:
            break


@pytest.mark.parametrize("at", [0, 1, 37, 120, 299])
def test_a_snapshot_goes_on_to_the_same_bits_through_json(box: Shape, at: int) -> None:
    whole = classic(box, seed=2)
    states(whole, at)
    text = json.dumps(whole.snapshot(), allow_nan=False)
    other = classic(box, seed=2)
    other.restore(json.loads(text))
    assert other.state == whole.state
    assert other.previous == whole.previous
    assert digest(states(other, 100)) == digest(states(whole, 100))
    assert other.interpolated(0.3) == whole.interpolated(0.3)


def test_a_bad_snapshot_changes_nothing(box: Shape) -> None:
    moving = classic(box)
    states(moving, 10)
    before = moving.state, moving.previous
    with pytest.raises(InputError):
        moving.restore({"version": 1})
    assert (moving.state, moving.previous) == before


def test_reset_goes_back_to_the_start_and_the_same_path(box: Shape) -> None:
    moving = classic(box)
    start = moving.state
    first = states(moving, 100)
    moving.reset()
    assert moving.state == moving.previous == start
    assert states(moving, 100) == first


def test_the_start_has_the_scenes_velocity_and_spin(box: Shape) -> None:
    tilted = (0.5, 0.5, 0.5, 0.5)
    settings = SimulationSettings.model_validate({"velocity": (1, 2, 3), "spin": (0.5, 3, -1), "mass": 4})
    moving = Simulation(settings, box, START, tilted)
    assert moving.body.velocity(moving.state) == (1, 2, 3)
    assert moving.body.angular_velocity(moving.state) == pytest.approx((0.5, 3, -1), rel=1e-14, abs=0)
    assert moving.state.orientation == tilted


def test_the_previous_state_is_the_one_before(box: Shape) -> None:
    moving = classic(box)
    for _ in range(5):
        current = moving.state
        moving.step()
        assert moving.previous is current
        assert moving.state.step == current.step + 1


def test_interpolation_meets_both_states_and_halves_the_way(box: Shape) -> None:
    moving = classic(box)
    states(moving, 10)
    before, after = moving.previous, moving.state
    assert moving.interpolated(0) == (before.position, before.orientation)
    assert moving.interpolated(1) == (after.position, after.orientation)
    position, orientation = moving.interpolated(0.5)
    assert position[1] == pytest.approx((before.position[1] + after.position[1]) / 2, rel=1e-15, abs=0)
    half = rotate(orientation, (0, 0, 1))
    ends = rotate(before.orientation, (0, 0, 1)), rotate(after.orientation, (0, 0, 1))
    chords = [math.dist(half, end) for end in ends]
    assert chords[0] == pytest.approx(chords[1], rel=1e-12, abs=0)
    assert chords[0] > 0.01


def test_interpolation_meets_the_current_state_to_the_bit(box: Shape) -> None:
    moving = classic(box)
    moving.step()
    near_zero = moving.snapshot()
    near_zero["previous"]["position"], near_zero["state"]["position"] = [1.0, 4.0, 0.0], [1e-17, 3.9, 0.0]
    moving.restore(near_zero)
    assert 1.0 + (1e-17 - 1.0) == 0  # what a + (b - a) gives
    assert moving.interpolated(1)[0] == (1e-17, 3.9, 0.0)


@pytest.mark.parametrize("fraction", [-0.1, 1.1, math.nan])
def test_a_fraction_outside_the_step_is_refused(box: Shape, fraction: float) -> None:
    with pytest.raises(InputError, match="between 0 and 1"):
        classic(box).interpolated(fraction)


def test_a_settled_stone_is_drawn_at_the_same_bits_for_ever(box: Shape) -> None:
    moving = classic(box)
    while not moving.settled:
        moving.step()
    assert moving.state.time < 8
    pose = moving.interpolated(0.2)
    for fraction in (0.0, 0.5, 0.9, 1.0):
        moving.step()
        assert moving.interpolated(fraction) == pose
    assert moving.settled
    assert moving.energy() == 0


def test_time_goes_on_while_the_stone_sleeps(box: Shape) -> None:
    moving = classic(box)
    path = states(moving, 400)
    assert path[-1].asleep
    assert [state.step for state in path] == list(range(1, 401))
    assert path[-1].time == pytest.approx(400 / 30, rel=1e-13, abs=0)


def test_the_classic_energy_only_falls_while_nothing_kicks(box: Shape) -> None:
    moving = classic(box, random_torque=0, spin=(0, 3, 0))
    energies = [moving.energy()]
    for _ in range(300):
        moving.step()
        energies.append(moving.energy())
    assert energies[0] == pytest.approx(2 * 9.81 * 4 + 0.5 * 2 * 40 / 147 * 9, rel=1e-14, abs=0)
    assert all(after <= before + 1e-12 for before, after in itertools.pairwise(energies))  # measured: no rise
    assert energies[-1] == 0


EXTREMES: dict[str, dict[str, Any]] = {
    "no gravity": {"gravity": 0},
    "gravity of 1e6": {"gravity": 1e6},
    "almost no mass": {"mass": 1e-9},
    "huge mass": {"mass": 1e9},
    "clay": {"restitution": 0},
    "superball": {"restitution": 1},
    "longest step": {"time_step": 0.25},
    "shortest step": {"time_step": 1e-4},
    "a thousand radians a step": {"spin": (3e4, -2e4, 1e4)},
    "fastest spin": {"spin": (1e9, 1e9, -1e9)},
    "fastest fall": {"velocity": (1e9, -1e9, 1e9)},
    "largest torque on almost no mass": {"mass": 1e-9, "random_torque": 1e6, "random_torque_speed": 0},
    "everything at once": {
        "gravity": 1e6, "mass": 1e9, "restitution": 1, "time_step": 0.25, "spin": (1e9, 1e9, 1e9),
        "velocity": (1e9, -1e9, 1e9), "tangential_damping": 1, "angular_damping": 1, "velocity_threshold": 0,
        "random_torque": 1e6,
    },
}  # fmt: skip


@pytest.mark.parametrize("inertia", ["polyhedron", "cone", "cone_apex"])
@pytest.mark.parametrize("name", EXTREMES)
def test_extremes_stay_finite_and_above_the_floor(box: Shape, name: str, inertia: str) -> None:
    moving = classic(box, inertia=inertia, **EXTREMES[name])
    for state in states(moving, 300):
        assert all(math.isfinite(number) for number in numbers(state))
        assert math.isfinite(moving.energy())
        assert state.position[1] >= 0
        assert abs(sum(c * c for c in state.orientation) - 1) < 1e-14


def test_without_gravity_a_stone_at_rest_stays_where_it_is(box: Shape) -> None:
    moving = classic(box, gravity=0, spin=(0, 0, 0))
    states(moving, 300)
    assert (moving.state.position, moving.state.orientation) == (START, UPRIGHT)


@pytest.mark.parametrize("time_step", [1 / 30, 0.25])
@pytest.mark.parametrize("gravity", [9.81, 1e6])
def test_bouncing_never_gives_more_height_than_it_began_with(box: Shape, gravity: float, time_step: float) -> None:
    moving = classic(box, gravity=gravity, time_step=time_step, restitution=1, random_torque=0)
    assert max(state.position[1] for state in states(moving, 500)) <= 4


def test_an_orientation_of_another_length_is_normalised(box: Shape) -> None:
    moving = Simulation(SimulationSettings.model_validate({}), box, START, (0.0, 3.0, 0.0, -4.0))
    assert moving.state.orientation == (0, 0.6, 0, -0.8)


@pytest.mark.parametrize(
    ("position", "orientation"),
    [
        ((0.0, math.nan, 0.0), UPRIGHT),
        ((0.0, math.inf, 0.0), UPRIGHT),
        (START, (math.nan, 0.0, 0.0, 1.0)),
        (START, (0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_a_start_that_is_no_pose_is_refused(box: Shape, position: Triple, orientation: Quaternion) -> None:
    with pytest.raises(InputError):
        Simulation(SimulationSettings.model_validate({}), box, position, orientation)


def test_every_model_that_a_scene_can_name_exists() -> None:
    assert set(get_args(SimulationSettings.model_fields["model"].annotation)) == set(MODELS)


def test_the_reports_scene_bounces_and_rests(box: Shape) -> None:
    path = states(Simulation.of(Stage(preset("classic"), (box,), None)), 300)
    assert 2 <= path[-1].impacts <= 4
    assert path[-1].asleep
    assert len(set(map(astuple, path))) == 300

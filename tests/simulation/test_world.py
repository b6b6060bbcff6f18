"""A world of stones as its users see it: reproducible, restorable to the bit, changed while it runs."""

from __future__ import annotations

import base64
import json
import math
import struct
import threading
from dataclasses import replace

import numpy as np
import pytest

from culet.errors import InputError, TooLargeError
from culet.geometry.shape import Shape
from culet.simulation import together
from culet.simulation.bodies import Body
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.body import inertia_of
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS
from culet.simulation.world import World
from culet.study.contacts.heaps import scattered
from culet.study.contacts.worlds import BOWL, advance, beside_another, corners, law, overlap, solid, standing
from simulation.solids import TILTED
from simulation.worlds import world

ROOM = (FLOOR, *WALLS)


def height_of(shape: Shape) -> float:
    return float(np.ptp(shape.vertices[:, 1]))


def one(stone: Shape, **more: object) -> Body:
    given: dict[str, object] = {"position": (0.0, 2.0, 0.0), "orientation": TILTED, "spin": (0.5, 3.0, 0.0)} | more
    return Body("one", stone, **given)  # type: ignore[arg-type]


def two(stone: Shape) -> list[Body]:
    return [one(stone), Body("two", stone, (0.3, 4.2, 0.0), IDENTITY, spin=(1.0, 0.0, 2.0))]


def test_one_stone_moves_as_its_own_simulation_to_the_bit(box: Shape) -> None:
    moving = world([one(box, mass=2.0)])
    settings = SimulationSettings(**law().model_dump(), mass=2.0, spin=(0.5, 3, 0))
    alone = Simulation(settings, box, (0.0, 2.0, 0.0), TILTED)
    for _ in range(240):
        moving.step()
        alone.step()
        state, (now,) = alone.state, moving.state.bodies
        assert (now.position, now.orientation) == (state.position, state.orientation)
        assert (now.velocity, now.spin) == (alone.body.velocity(state), alone.body.angular_velocity(state))
        assert (moving.state.step, moving.state.time) == (state.step, state.time)


def test_a_stone_of_another_scale_falls_as_the_same_stone_in_other_units(box: Shape) -> None:
    """Times 4 in length is times 2 in time; both factors are powers of two, so that the bits are the same."""
    small = world([one(box)], time_step=1 / 128)
    large = world([one(box, position=(0.0, 11.0, 0.0), scale=4.0, spin=(0.25, 1.5, 0.0))], time_step=1 / 64)
    for _ in range(300):
        small.step()
        large.step()
        (state,), (other,) = small.state.bodies, large.state.bodies
        assert other.orientation == state.orientation
        assert (other.position[1] + 1) / 4 == pytest.approx(state.position[1] + 1, abs=1e-12)
        assert other.velocity[1] == 2 * state.velocity[1]


def test_a_second_stone_takes_nothing_from_one_that_falls(box: Shape) -> None:
    moving = world([one(box)])
    advance(moving, 0.25)
    before, (state,) = moving.energy(), moving.state.bodies
    moving.add(Body("two", box, (5.0, 4.0, 0.0), IDENTITY))
    after = moving.state.bodies[0]
    assert (after.position, after.orientation, after.velocity) == (state.position, state.orientation, state.velocity)
    assert after.spin == pytest.approx(state.spin, abs=1e-14)
    assert moving.energy() - moving.bodies[1].mass * moving.law.gravity * 4.0 == pytest.approx(before, rel=1e-14)
    assert moving.state.step == 30
    assert moving.interpolated(0.0)[0].position == moving.previous.bodies[0].position


def test_the_last_stone_goes_on_when_the_others_are_removed(box: Shape) -> None:
    moving = world(two(box))
    advance(moving, 0.25)
    _, state = moving.state.bodies
    moving.remove("one")
    (left,) = moving.state.bodies
    assert (left.position, left.orientation) == (state.position, state.orientation)
    assert left.velocity == pytest.approx(state.velocity, rel=1e-15)
    assert left.spin == pytest.approx(state.spin, rel=1e-14)
    moving.step()
    assert moving.state.step == 31
    assert moving.state.time == pytest.approx(31 / 120)
    moving.remove("two")
    moving.step()
    assert moving.state.bodies == ()
    assert moving.settled


def test_the_same_start_gives_the_same_bits(box: Shape) -> None:
    first, second = (world(scattered(5, box, 3), BOWL) for _ in range(2))
    advance(first, 3)
    advance(second, 3)
    assert first.state == second.state


def test_a_snapshot_goes_through_json_and_on_to_the_same_bits(box: Shape) -> None:
    """Taken while the stones fall, while they touch, and shortly before they fall asleep."""
    first = world(scattered(5, box, 3), BOWL, rolling_resistance=0.02)
    while not first.settled:
        first.step()
    for step in (60, 240, first.state.step - 20, first.state.step):
        moving, other = (world(scattered(5, box, 3), BOWL, rolling_resistance=0.02) for _ in range(2))
        for _ in range(step):
            moving.step()
        other.restore(json.loads(json.dumps(moving.snapshot())))
        assert (other.state, other.previous) == (moving.state, moving.previous)
        for _ in range(first.state.step - step + 2):
            moving.step()
            other.step()
            assert other.state == moving.state
        assert moving.settled


def test_a_stone_that_falls_on_a_sleeper_wakes_it_and_what_leans_on_it(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world([*bodies, Body("falls", box, (0.3, 6.0, 0.0), TILTED)], restitution=0)
    moving.hold("falls", held=True)
    advance(moving, 2)
    assert [state.asleep for state in moving.state.bodies] == [True, True, False]
    moving.hold("falls", held=False)
    advance(moving, 0.5)
    assert [state.asleep for state in moving.state.bodies] == [True, True, False]
    before = moving.state.bodies[1].position
    while moving.state.bodies[1].asleep and moving.state.time < 6:
        moving.step()
    assert not moving.state.bodies[0].asleep
    advance(moving, 1)
    assert math.dist(moving.state.bodies[1].position, before) > 0.01


HEADER = 32
"""Bytes of what the solver saves before its bodies: six counts and a time."""
DAMAGED = {
    "too fast": (HEADER + 7 * 8, "d", 1e31),
    "asleep for ever": (HEADER + 13 * 8, "d", math.inf),
    "stays nowhere": (HEADER + 15 * 8, "d", math.nan),
    "in no bed": (HEADER + 22 * 8 + 8, "i", -1),
    "in a bed to come": (HEADER + 22 * 8 + 8, "i", 2**30),
    "no bed left": (12, "i", 2**31 - 1),
    "more manifolds": (16, "i", 2**31 - 1),
    "more contacts": (20, "i", 2**31 - 1),
    "after a substep of less than no time": (24, "d", -1e-3),
    "after a substep of no known time": (24, "d", math.nan),
}
"""Offset, format and value of a number."""


@pytest.mark.parametrize("damage", ["version", "stones", "saved", "short", "nan", *DAMAGED])
def test_a_damaged_snapshot_is_refused_and_changes_nothing(box: Shape, damage: str) -> None:
    moving = world(two(box))
    advance(moving, 0.5)
    snapshot, state = moving.snapshot(), moving.state
    match damage:
        case "version":
            snapshot["version"] = 1
        case "stones":
            snapshot["stones"] = ["two", "one"]
        case "saved":
            snapshot["saved"] = "not base64"
        case "short":
            snapshot["saved"] = snapshot["saved"][:-8]
        case damage if damage in DAMAGED:
            content = bytearray(base64.b64decode(snapshot["saved"]))
            offset, kind, value = DAMAGED[damage]
            struct.pack_into(kind, content, offset, value)
            snapshot["saved"] = base64.b64encode(content).decode()
        case _:
            snapshot["saved"] = snapshot["saved"][:40] + "/" * 16 + snapshot["saved"][56:]
    with pytest.raises(InputError, match="snapshot"):
        moving.restore(snapshot)
    assert moving.state == state
    moving.step()
    assert all(math.isfinite(c) for body in moving.state.bodies for c in body.position)


def test_worlds_move_in_threads_as_one_after_the_other(box: Shape) -> None:
    alone = [world(scattered(4, box, seed), BOWL) for seed in range(3)]
    together = [world(scattered(4, box, seed), BOWL) for seed in range(3)]
    for each in alone:
        advance(each, 2)
    threads = [threading.Thread(target=advance, args=(each, 2)) for each in together]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [each.state for each in together] == [each.state for each in alone]


def test_a_push_changes_momentum_by_the_impulse_and_wakes_what_leans_on_the_stone(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world(bodies, restitution=0)
    advance(moving, 2)
    assert moving.settled
    moving.push("low", (0.0, 0.0, 0.5), moving.state.bodies[0].position)
    low, high = moving.state.bodies
    assert low.velocity == pytest.approx((0, 0, 0.5))
    assert not low.asleep
    assert not high.asleep
    moving.step()
    assert moving.state.bodies[1].velocity[2] > 0  # carried along


def test_what_a_removed_stone_carried_falls(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world([*bodies, Body("far", box, (9.0, 0.0, 0.0), IDENTITY)], restitution=0)
    advance(moving, 3)
    assert moving.settled
    height = moving.state.bodies[1].position[1]
    moving.remove("low")
    advance(moving, 2)
    assert moving.state.bodies[0].position[1] == pytest.approx(height - height_of(box), abs=1e-4)


def test_what_stood_on_a_stone_that_is_moved_away_falls(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world(bodies, restitution=0)
    advance(moving, 2)
    assert moving.settled
    moving.move("low", (9.0, 0.0, 0.0), IDENTITY)
    advance(moving, 2)
    assert moving.state.bodies[1].position[1] == pytest.approx(bodies[0].position[1], abs=1e-4)


def test_sleepers_wake_when_gravity_friction_or_surfaces_change(box: Shape) -> None:
    moving = world([standing("one", box, IDENTITY), Body("two", box, (5.0, 0.0, 0.0), IDENTITY)])
    advance(moving, 4)
    assert moving.settled
    for settings, surfaces in (({"gravity": 20}, ROOM[:1]), ({"gravity": 20, "friction": 0.1}, ROOM[:1]), ({}, ROOM)):
        moving.adjust(law(**settings))
        moving.surround(surfaces)
        assert not moving.state.asleep
        advance(moving, 3)
        assert moving.settled


def test_less_friction_lets_a_stone_slide_that_stuck(box: Shape) -> None:
    slope = (FLOOR._replace(normal=(math.sin(0.2), math.cos(0.2), 0.0), offset=-math.cos(0.2)),)
    leaning = (math.cos(0.1), 0.0, 0.0, -math.sin(0.1))
    half = height_of(box) / 2
    at = (half * math.sin(0.2), half * math.cos(0.2) - 1, 0.0)
    moving = world([Body("one", box, at, leaning), Body("two", box, (90.0, 90.0, 0.0), IDENTITY)], slope, friction=0.5)
    moving.hold("two", held=True)
    advance(moving, 2)
    assert math.dist(moving.state.bodies[0].position, at) < 1e-4
    moving.adjust(law(friction=0.1))
    advance(moving, 1)
    along = 9.81 * (math.sin(0.2) - 0.1 * math.cos(0.2)) / 2
    assert math.dist(moving.state.bodies[0].position, at) == pytest.approx(along, rel=0.01)  # measured 3e-3


def test_a_held_stone_stops_another_and_does_not_move(box: Shape) -> None:
    moving = world([Body("low", box, (0.0, 3.0, 0.0), IDENTITY), Body("high", box, (0.0, 5.0, 0.0), IDENTITY)])
    moving.hold("low", held=True)
    advance(moving, 4)
    low, high = moving.state.bodies
    assert low.position == (0.0, 3.0, 0.0)
    assert high.position[1] == pytest.approx(3 + height_of(box), abs=1e-4)
    assert high.asleep
    moving.hold("low", held=False)
    advance(moving, 4)
    low, high = moving.state.bodies
    assert low.position[1] < 0
    assert high.position[1] < 1


def test_a_push_moves_no_stone_that_is_held_nor_what_lies_on_it(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world(bodies, friction=0.5)
    moving.hold("low", held=True)
    moving.push("low", (5.0, 0.0, 0.0), moving.state.bodies[0].position)
    advance(moving, 0.5)
    low, high = moving.state.bodies
    assert low.velocity == (0.0, 0.0, 0.0)
    assert math.hypot(high.position[0], high.position[2]) < 1e-3


def test_a_stone_sleeps_on_a_base_of_many_corners() -> None:
    rim = [(math.cos(a), 0.0, math.sin(a)) for a in np.linspace(0, 2 * math.pi, 701)[:-1].tolist()]
    cone = solid("cone", [(x, y - 0.3, z) for x, y, z in (*rim, (0.0, 1.2, 0.0))])
    moving = beside_another(standing("cone", cone, IDENTITY), law())
    advance(moving, 1)
    assert moving.state.bodies[0].asleep


def test_a_law_that_one_of_the_stones_cannot_have_changes_nothing(box: Shape, monkeypatch: pytest.MonkeyPatch) -> None:
    def refusing(kind: str, shape: Shape, factor: float) -> object:
        if factor == 2.0 and kind == "cone":
            raise InputError("no such inertia")
        return inertia_of(kind, shape, factor)  # type: ignore[arg-type]

    monkeypatch.setattr(together, "inertia_of", refusing)
    moving, other = (world([one(box), Body("two", box, (0.3, 4.2, 0.0), IDENTITY, mass=2.0)]) for _ in range(2))
    with pytest.raises(InputError):
        moving.adjust(law(inertia="cone", gravity=1.0))
    advance(moving, 0.5)
    advance(other, 0.5)
    assert moving.state == other.state


def test_a_moved_stone_is_there_and_jumps_in_no_picture(box: Shape) -> None:
    moving = world(two(box))
    advance(moving, 0.5)
    velocity = moving.state.bodies[1].velocity
    moving.move("two", (4.0, 6.0, 1.0), TILTED)
    assert moving.state.bodies[1].velocity == velocity
    assert moving.interpolated(0.5)[1].position == (4.0, 6.0, 1.0)
    moving.reset("two")
    assert moving.state.bodies[1].position == moving.bodies[1].position
    assert moving.state.step == 60
    moving.reset()
    assert moving.state.step == 0
    assert moving.at_start


def test_a_heavier_stone_keeps_its_velocity_and_its_spin(box: Shape) -> None:
    moving = world(two(box))
    advance(moving, 0.5)
    state = moving.state.bodies[0]
    moving.change(replace(moving.bodies[0], mass=7.0))
    assert moving.state.bodies[0].velocity == state.velocity
    assert moving.state.bodies[0].spin == pytest.approx(state.spin, rel=1e-14)


def test_stones_that_stand_on_each_other_are_lifted_together(box: Shape) -> None:
    bodies = [standing("low", box, IDENTITY), standing("high", box, IDENTITY, gap=height_of(box))]
    moving = world(bodies)
    moving.drop()
    low, high = moving.state.bodies
    assert low.position[1] == pytest.approx(1.5)
    assert high.position[1] - low.position[1] == pytest.approx(height_of(box))
    assert moving.state.step == 0


def test_what_cannot_be_is_refused(box: Shape) -> None:
    with pytest.raises(InputError, match="'one' more than once"):
        world([one(box), one(box)])
    with pytest.raises(InputError, match="classic moves one stone"):
        world(two(box), model="classic")
    with pytest.raises(TooLargeError, match="at most 64 stones"):
        world([replace(one(box), name=str(i), position=(0.0, 3.0 * i, 0.0)) for i in range(65)])
    with pytest.raises(InputError, match="a start is finite"):
        one(box, position=(0.0, math.nan, 0.0))
    moving = world(two(box))
    with pytest.raises(InputError, match=r"the id of a stone \('one', 'two'\); got 'three'"):
        moving.push("three", (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="10000 R/s at most"):
        moving.push("one", (0.0, 0.0, 1e6), (0.0, 2.0, 0.0))
    with pytest.raises(InputError, match="classic"):
        moving.adjust(law(model="classic"))
    assert moving.state == World(two(box), (FLOOR,), law()).state


def test_a_stone_that_is_not_convex_touches_by_its_hull(ring: Shape) -> None:
    lying = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    moving = world([standing("low", ring, lying), standing("high", ring, lying, gap=1.0)], restitution=0)
    advance(moving, 3)
    height = float(np.ptp(ring.vertices[:, 2]))
    low, high = moving.state.bodies
    assert high.position[1] - low.position[1] == pytest.approx(height, abs=1e-4)
    assert overlap(moving) < 1e-4
    assert corners(moving.bodies[0], low)[:, 1].min() == pytest.approx(-1, abs=1e-4)


def test_states_are_plain_values(box: Shape) -> None:
    moving = world(two(box))
    moving.step()
    assert not isinstance(moving.state, RigidState)
    for body in moving.state.bodies:
        numbers = (*body.position, *body.orientation, *body.velocity, *body.spin)
        assert {type(number) for number in numbers} == {float}
        assert {type(body.asleep), type(body.held)} == {bool}


def test_of_two_stones_that_meet_restitution_is_the_mean(box: Shape) -> None:
    """Face to face, without gravity or spin: 3 R/s of approach become 3 times the mean of separation."""
    wide = float(np.ptp(box.vertices[:, 0]))
    kind = {"spin": (0.0, 0.0, 0.0), "friction": 0.0}
    bodies = [
        Body("one", box, (-wide, 0.0, 0.0), IDENTITY, (2.0, 0.0, 0.0), restitution=0.9, **kind),  # type: ignore[arg-type]
        Body("two", box, (wide, 0.0, 0.0), IDENTITY, (-1.0, 0.0, 0.0), restitution=0.4, **kind),  # type: ignore[arg-type]
    ]
    moving = world(bodies, (), gravity=0)
    advance(moving, 1)
    one, two = moving.state.bodies
    assert two.velocity[0] - one.velocity[0] == pytest.approx(3 * (0.9 + 0.4) / 2, rel=1e-4)


def test_of_two_stones_that_rub_friction_is_the_geometric_mean(box: Shape) -> None:
    """A stone slides on a held one: it slows by mu g."""
    ground = Body("low", box, (0.0, 3.0, 0.0), IDENTITY, spin=(0.0, 0.0, 0.0), scale=8.0, friction=0.1)
    height = 3 + (8 + 1) * height_of(box) / 2
    slider = Body("high", box, (0.0, height, 0.0), IDENTITY, (2.0, 0.0, 0.0), (0.0, 0.0, 0.0), friction=0.4)
    moving = world([ground, slider], (), restitution=0)
    moving.hold("low", held=True)
    advance(moving, 0.25)
    assert moving.state.bodies[1].velocity[0] == pytest.approx(2 - math.sqrt(0.1 * 0.4) * 9.81 * 0.25, rel=1e-3)

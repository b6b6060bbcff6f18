"""Stones of one session: each comes, goes and is moved by itself, and the others move on as they did."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import pytest

from culet.engine.session import events
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.errors import CuletError, InputError
from culet.scene import Scene
from culet.simulation.bodies import BodyState
from culet.stage import NOTHING, Stage
from culet_protocol.messages import PatchScene

NAME = "0123456789abcdef" * 2
FIRST_MOMENTUM = 24 + 10 * 8
"""Bytes of a saved world before the first stone's angular momentum: the header, position, orientation and velocity."""


def stone(number: int, **settings: object) -> dict[str, object]:
    """One of a row of stones that do not touch, high above the floor."""
    return {"id": f"s{number}", "position": [2.5 * number, 20, 0], "spin": [0.5, 3, 0.1 * number], **settings}


def session_of(*stones: dict[str, object], **scene: object) -> Session:
    return Session(NAME, Stage.of(Scene.read({"version": 2, "stones": list(stones), **scene})))


def falling(count: int, seconds: float = 0.25) -> Session:
    session = session_of(*(stone(number) for number in range(count)))
    session.set_falling(True)
    advance(session, 0, seconds)
    return session


def advance(session: Session, begin: float, end: float) -> None:
    for frame in range(11):
        session.advance(begin + (end - begin) * frame / 10)


def patch(session: Session, **changes: Any) -> None:  # noqa: ANN401
    events.apply(session, PatchScene(patch=changes), NOTHING)


def is_as(one: BodyState, other: BodyState) -> bool:
    """To rounding: the solver of several stones keeps momenta, the one of one stone too, from which spins follow."""
    return (one.position, one.orientation, one.velocity) == (other.position, other.orientation, other.velocity) and (
        one.spin == pytest.approx(other.spin, rel=1e-12)  # measured 3e-15
    )


def shown(session: Session) -> dict[str, tuple[float, float, float]]:
    return {each.id: each.position for each in session.shown.scene.stones}


def test_a_second_stone_takes_over_pose_and_motion_of_a_falling_one_without_a_jump() -> None:
    session = falling(1)
    before, seen = session.motion.states()["s0"], shown(session)["s0"]
    patch(session, stones={"s1": {"cut": "brilliant", "position": [2.5, 20, 0]}})
    assert is_as(session.motion.states()["s0"], before)
    assert shown(session)["s0"] == seen
    assert session.motion.motions() == {"s0": "falling", "s1": "falling"}
    advance(session, 0.25, 0.35)
    alone = falling(1)
    advance(alone, 0.25, 0.35)
    assert shown(session)["s0"] == pytest.approx(shown(alone)["s0"], abs=1e-9)  # measured 4e-15
    assert shown(session)["s1"][1] < 20


def test_the_others_move_on_as_they_did_when_one_goes() -> None:
    session = falling(3)
    before = session.motion.states()
    patch(session, stones={"s1": None})
    assert list(shown(session)) == ["s0", "s2"]
    after = session.motion.states()
    assert all(is_as(after[name], before[name]) for name in ("s0", "s2"))
    patch(session, stones={"s0": None})
    assert is_as(session.motion.states()["s2"], before["s2"])
    advance(session, 0.25, 0.35)
    assert shown(session)["s2"][1] < before["s2"].position[1]


def test_a_stone_that_is_put_elsewhere_begins_there_alone() -> None:
    session = falling(3)
    before = session.motion.states()
    patch(session, stones={"s1": {"position": [2.5, 30, 0]}})
    after = session.motion.states()
    assert (after["s1"].position, after["s1"].velocity) == ((2.5, 30, 0), (0, 0, 0))
    assert all(is_as(after[name], before[name]) for name in ("s0", "s2"))
    assert shown(session)["s1"] == (2.5, 30, 0)


@pytest.mark.parametrize("change", [{"friction": 0.9}, {"restitution": 0.1}, {"mass": 7.0}, {"material": "ruby"}])
def test_a_stones_own_settings_act_at_once_and_leave_all_where_they_are(change: dict[str, object]) -> None:
    session = falling(3)
    before, bodies = session.motion.states(), session.motion.world.bodies
    patch(session, stones={"s1": change})
    after = session.motion.states()
    assert all(is_as(after[name], before[name]) for name in before)
    assert [old.like(new) for old, new in zip(bodies, session.motion.world.bodies, strict=True)] == [True, False, True]


def test_another_order_of_the_stones_moves_none() -> None:
    session = falling(3)
    before, seen = session.motion.states(), shown(session)
    scene = session.scene.model_dump(mode="json")
    patch(session, stones=scene["stones"][::-1])
    assert list(shown(session)) == ["s2", "s1", "s0"]
    assert shown(session) == seen
    assert session.motion.states() == before


def test_what_the_stones_cannot_have_is_refused_and_nothing_changes() -> None:
    session = falling(2)
    before, scene = session.motion.states(), session.scene
    with pytest.raises(InputError, match="classic"):
        patch(session, simulation={"model": "classic"})
    assert session.scene == scene
    assert session.motion.states() == before
    advance(session, 0.25, 0.35)
    assert shown(session)["s0"][1] < before["s0"].position[1]


def test_a_stone_that_comes_back_moves_on_as_it_did() -> None:
    session = falling(3)
    before, stage = session.motion.states(), session.stage
    patch(session, stones={"s1": None})
    session.motion.follow(stage, before)
    assert is_as(session.motion.states()["s1"], before["s1"])


def test_the_last_stone_comes_back_where_it_was() -> None:
    session = falling(1)
    before, stage = session.motion.states(), session.stage
    patch(session, stones={"s0": None})
    assert session.motion.states() == {}
    session.motion.follow(stage, before)
    assert is_as(session.motion.states()["s0"], before["s0"])


def test_several_stones_go_on_in_another_engine_to_the_same_bits() -> None:
    session = falling(3)
    patch(session, stones={"s0": None})
    patch(session, stones=[stone(5), *(each.model_dump(mode="json") for each in session.scene.stones)])
    report = json.loads(json.dumps(session.described()))
    other = Session.restored(NAME, Stage.of(Scene.read(report["scene"])), SessionSnapshot.read(report["snapshot"]))
    assert shown(other) == shown(session)
    for one in (session, other):
        one.set_falling(True)
        advance(one, 0, 3)  # on the floor, and against each other
    assert other.motion.states() == session.motion.states()


def test_one_stone_falls_alone_is_held_and_let_go() -> None:
    session = session_of(*(stone(number) for number in range(3)))
    session.toggle_fall("s1")
    assert session.motion.motions() == {"s0": "paused", "s1": "falling", "s2": "paused"}
    advance(session, 0, 0.25)
    assert [y < 20 for _, y, _ in shown(session).values()] == [False, True, False]
    session.toggle_fall("s0")
    session.toggle_fall("s1")
    assert session.motion.motions() == {"s0": "falling", "s1": "paused", "s2": "paused"}
    held = shown(session)["s1"]
    advance(session, 0.25, 0.45)
    assert shown(session)["s1"] == pytest.approx(held, abs=0.05)  # it was shown up to a step behind
    session.toggle_fall()
    assert set(session.motion.motions().values()) == {"paused"}
    session.toggle_fall()
    assert set(session.motion.motions().values()) == {"falling"}


def test_one_stone_is_put_back_and_the_others_fall_on() -> None:
    session = falling(3)
    session.reset_stone("s1")
    assert session.motion.motions() == {"s0": "falling", "s1": "paused", "s2": "falling"}
    assert shown(session)["s1"] == (2.5, 20, 0)
    session.reset_stone()
    assert not session.motion.moving
    assert [y for _, y, _ in shown(session).values()] == [20, 20, 20]


def test_a_stone_that_is_not_there_is_named() -> None:
    session = falling(2)
    for act in (session.toggle_fall, session.reset_stone):
        with pytest.raises(InputError, match="'s7'"):
            act("s7")


def test_a_push_moves_the_stone_that_is_seen_there_alone() -> None:
    camera = {"position": [2.5, 20, 10], "target": [2.5, 20, 0], "fov_degrees": 40}
    session = session_of(
        *(stone(number, spin=[0, 0, 0]) for number in range(3)), camera=camera, simulation={"gravity": 0}
    )
    session.push(0, 0, 0, 1)
    speeds = {name: state.velocity for name, state in session.motion.states().items()}
    assert speeds["s1"] == pytest.approx((0, 1, 0), abs=1e-9)
    assert speeds["s0"] == speeds["s2"] == (0, 0, 0)


def test_stones_that_come_to_be_where_no_number_is_stop_at_their_starts() -> None:
    """Which neither a scene nor a snapshot can ask for."""
    session = falling(2)
    first, _ = session.motion.world.state.bodies
    session.motion.world.move("s0", first.position, first.orientation, spin=(1e300, 0.0, 0.0))
    with pytest.raises(CuletError, match="faster than numbers"):
        advance(session, 0, 0.25)
    assert not session.motion.moving
    assert shown(session) == shown(session_of(stone(0), stone(1)))


def test_a_session_takes_no_snapshot_of_stones_too_fast_for_numbers() -> None:
    """What it takes, moves on to where numbers still are."""
    session = falling(2)
    snapshot = session.snapshot().model_dump(mode="json")

    def restored(momentum: float) -> Session:
        saved = bytearray(base64.b64decode(snapshot["simulation"]["saved"]))
        struct.pack_into("d", saved, FIRST_MOMENTUM, momentum)
        changed = snapshot["simulation"] | {"saved": base64.b64encode(bytes(saved)).decode()}
        return Session.restored(NAME, session.stage, SessionSnapshot.read(snapshot | {"simulation": changed}))

    with pytest.raises(InputError, match="simulation snapshot"):
        restored(1e300)
    advance(restored(1e30), 0, 2)

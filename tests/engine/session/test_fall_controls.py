"""The settings of the fall, changed while the stone falls: it goes on from where it is; only its start puts it back."""

from __future__ import annotations

import json
from typing import Any

import pytest

from culet.engine.session import events
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.scene import Scene
from culet.scene.motion import MotionLaws
from culet.stage import NOTHING, Stage
from culet_protocol.messages import PatchScene
from engine.peer import EngineProcess, connected

STEP = Scene().simulation.time_step
DROP: dict[str, Any] = {"stones": [{"position": [0, 1, 0]}]}


def falling(scene: dict[str, Any] | None = None) -> Session:
    session = Session("0" * 32, Stage.of(Scene.read(DROP | (scene or {}))))
    session.set_falling(True)
    session.advance(0)
    return session


def patch(session: Session, **settings: object) -> None:
    """Laws of motion, and what is the stone's own."""
    own = {name: value for name, value in settings.items() if name not in MotionLaws.model_fields}
    laws = {name: value for name, value in settings.items() if name not in own}
    events.apply(session, PatchScene(patch={"simulation": laws, "stones": {"stone": own}}), NOTHING)


def motion(session: Session) -> Any:  # noqa: ANN401
    """The simulation's state, to the bit."""
    simulation = session.snapshot().simulation
    assert simulation is not None
    return simulation["saved"]


def velocities(session: Session) -> list[float]:
    """Linear, R/s, and angular, rad/s."""
    (stone,) = session.motion.world.state.bodies
    return [*stone.velocity, *stone.spin]


CHANGES: list[dict[str, object]] = [
    {"gravity": 2},
    {"restitution": 0.1},
    {"friction": 1.5},
    {"rolling_resistance": 0.5},
    {"integrator": "midpoint"},
    {"model": "classic"},
    {"mass": 5},
    {"inertia": "cone"},
    {"time_step": 1 / 90},
]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
def test_a_setting_acts_at_once_and_leaves_the_stone_where_it_is(change: dict[str, object]) -> None:
    changed, unchanged = falling(), falling()
    for session in (changed, unchanged):
        session.advance(0.2)  # still in the air
    patch(changed, **change)
    assert changed.pose() == unchanged.pose()
    assert changed.shown.simulation_time == unchanged.shown.simulation_time > 0.15
    assert velocities(changed) == pytest.approx(velocities(unchanged), rel=1e-12)  # measured 2e-16
    assert changed.motion.falling
    for frame in range(1, 101):
        for session in (changed, unchanged):
            session.advance(0.2 + frame / 50)
    assert changed.pose() != unchanged.pose()


def test_a_pause_is_kept_and_the_same_settings_are_no_change() -> None:
    session = falling()
    session.advance(0.2)
    session.set_falling(False)
    patch(session, gravity=2)
    assert not session.motion.falling
    shown = session.shown
    patch(session, gravity=2)
    assert session.shown is shown


@pytest.mark.parametrize("change", CHANGES[:6], ids=lambda change: next(iter(change)))
def test_the_same_change_at_the_same_step_gives_the_same_path_at_any_frame_rate(change: dict[str, object]) -> None:
    paths = []
    for frames in (1, 3, 40):
        session = falling({"stones": [{"position": [0, 1, 0], "velocity": [1, -4, 0]}]})  # it bounces after the change
        for frame in range(1, frames + 1):
            session.advance(24.5 * STEP * frame / frames)
        patch(session, **change)
        session.set_falling(True)  # the clock is read anew
        session.advance(0)
        for frame in range(1, frames + 1):
            session.advance(24.25 * STEP * frame / frames)
        paths.append(motion(session))
    assert paths[0] == paths[1] == paths[2]
    assert paths[0]["state"]["step"] == 48
    assert paths[0]["state"]["impacts"] > 0


def at_rest(**scene: Any) -> tuple[Session, float]:  # noqa: ANN401
    session, now = falling(scene), 0.0
    while session.motion.moving and now < 60:
        now += 0.2
        session.advance(now)
    assert not session.motion.moving
    return session, now


def test_a_stone_at_rest_wakes_just_if_the_change_moves_it() -> None:
    session, now = at_rest()
    resting = session.pose()
    patch(session, gravity=4, friction=0.05, restitution=1)
    assert not session.motion.moving  # a floor that is level holds it without friction, at any weight
    patch(session, model="classic")  # whose sphere must rise out of the floor
    assert session.shown.moving
    session.advance(now + 1000)  # the time that it rested is not made up for
    assert session.pose() == resting
    session.advance(now + 1000.1)
    assert session.pose() != resting


@pytest.mark.parametrize("start", [{"stones": {"stone": {"spin": [0, 8, 0]}}}, {"stones": [{"position": [0, 2, 0]}]}])
def test_a_stone_that_has_come_to_rest_is_dropped_again_from_another_start(start: dict[str, Any]) -> None:
    session, now = at_rest()
    events.apply(session, PatchScene(patch=start), NOTHING)
    assert session.motion.moving
    session.advance(now + 1000)
    assert session.shown.simulation_time == 0
    session.advance(now + 1000.1)
    pose = session.pose()
    assert pose is not None
    assert pose["position"][1] < session.scene.stones[0].position[1]


def test_another_engine_goes_on_with_the_settings_of_before() -> None:
    session = falling()
    session.advance(0.21)
    patch(session, gravity=3, time_step=1 / 90, model="classic")
    report = json.loads(json.dumps(session.described()))
    other = Session.restored(
        session.name, Stage.of(Scene.read(report["scene"])), SessionSnapshot.read(report["snapshot"])
    )
    assert other.shown.scene == session.shown.scene
    for one in (session, other):
        one.set_falling(True)
        one.advance(0)
        one.advance(0.2)
    assert motion(other) == motion(session)


async def test_a_falling_stone_hovers_when_gravity_is_turned_off_and_everybody_hears_of_it(
    engine: EngineProcess,
) -> None:
    async with connected(engine) as (peer, watch):
        session = await peer.open({"stones": [{"position": [0, 1, 0], "velocity": [0, -0.5, 0]}]})
        await peer.demand()
        watcher = watch(session)
        await peer.control("toggle_fall")
        await watcher.until(lambda frame: frame.simulation_time > 0.05)
        assert (await peer.control("patch_scene", patch={"simulation": {"gravity": 0}}))["status"] == 200
        state = await peer.told(
            lambda told: told["type"] == "session_change" and told["edited"] and is_weightless(told)
        )
        assert state["falling"]
        before = saved_state(await peer.result(type="get_session", session=session))
        await watcher.until(lambda frame: frame.simulation_time > before["time"] + 0.1)
        described = await peer.result(type="get_session", session=session)
        after = saved_state(described)
        assert described["scene"]["simulation"]["gravity"] == 0
        assert after["step"] > before["step"] > 0  # it was not put back
        assert after["momentum"] == before["momentum"]  # it goes on as fast as it was, no faster


def saved_state(described: dict[str, Any]) -> dict[str, Any]:
    """The simulation's latest state, of what a session is described by."""
    state: dict[str, Any] = described["snapshot"]["simulation"]["saved"]["state"]
    return state


def is_weightless(told: dict[str, Any]) -> bool:
    return bool(told["edited"] and told["parts"].get("simulation", {}).get("gravity") == 0)


@pytest.mark.parametrize(
    ("simulation", "field"),
    [
        ({"gravity": -1}, "gravity"),
        ({"restitution": 1.5}, "restitution"),
        ({"friction": "rough"}, "friction"),
        ({"rolling_resistance": 2}, "rolling_resistance"),
        ({"integrator": "leapfrog"}, "integrator"),
        ({"model": "soft"}, "model"),
        ({"bounciness": 1}, "bounciness"),
    ],
)
async def test_a_setting_that_cannot_be_is_refused_by_name_and_the_stone_falls_on(
    engine: EngineProcess, simulation: dict[str, Any], field: str
) -> None:
    async with connected(engine) as (peer, _):
        session = await peer.open()
        await peer.control("toggle_fall")
        before = await peer.result(type="get_session", session=session)
        reply = await peer.control("patch_scene", patch={"simulation": simulation})
        assert reply["status"] == 422, reply
        assert reply["field"].startswith(f"simulation.{field}")
        assert await peer.result(type="get_session", session=session) == before

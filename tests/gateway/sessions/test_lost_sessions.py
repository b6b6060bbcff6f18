"""Sessions that the server has lost are made again from what their viewers know, which may be anything."""

from __future__ import annotations

import base64
from typing import Any

import pytest

from culet_protocol.frame import Flags
from culet_protocol.messages import Orbit, ToggleFall
from gateway.running import TETRAHEDRON, Gateway

UNKNOWN = "c0" * 16
LIVELY: dict[str, Any] = {
    "floor": {"kind": "matte"},
    "simulation": {"restitution": 1, "tangential_damping": 1, "angular_damping": 1, "random_torque": 0},
}


async def test_a_lost_session_is_made_again_as_a_viewer_saw_it_last(gateway: Gateway) -> None:
    session = await gateway.session(LIVELY)
    async with gateway.viewer(session) as viewer:
        await viewer.say(Orbit(yaw=0.3, pitch=0.1))
        await viewer.say(ToggleFall())
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].simulation_time > 0.2)
        await viewer.say(ToggleFall())
        await viewer.until(
            lambda: any(notice["type"] == "state" and not notice["falling"] for notice in viewer.notices[-3:])
        )
        await viewer.until(lambda: Flags.MOVING not in viewer.frames[-1].flags)  # the picture of that state
        viewer.notices = [notice for notice in viewer.notices if notice["type"] == "state"]
        state, snapshot = viewer.notices[-1], (await viewer.notice("snapshot"))["snapshot"]
        last = viewer.frames[-1]
    # As after the loss of both processes: nobody knows the session any more.
    await gateway.parts.sessions.close(gateway.parts.sessions.get(session), "lost")
    assert (await gateway.http.get(f"/api/sessions/{session}")).status_code == 404

    lost = {"id": session, "scene": state["scene"], "snapshot": snapshot}
    made = await gateway.http.post("/api/sessions", json=lost)
    assert made.status_code == 201, made.text
    assert made.json()["id"] == session
    assert made.json()["scene"] == state["scene"]
    async with gateway.viewer(session) as viewer:
        frame = await viewer.frame()
    assert frame.simulation_time == last.simulation_time
    assert frame.sequence > last.sequence, "no number is used again"
    assert frame.step > last.step

    for second in (
        await gateway.http.post("/api/sessions", json=lost | {"scene": {}}),
        await gateway.http.put(f"/api/sessions/{session}", json={"scene": {}}),
    ):
        assert second.json()["scene"] == state["scene"], "of several viewers the first one makes it"
    assert second.status_code == 200, "it was there"
    await gateway.http.delete(f"/api/sessions/{session}")


async def test_a_lost_session_is_made_again_where_its_path_leads_with_the_files_that_were_given_there_before(
    gateway: Gateway,
) -> None:
    """Of several servers behind a proxy those who ask by the session's path come to the same one."""
    path = f"/api/sessions/{UNKNOWN}"
    mesh = await gateway.http.post(f"{path}/meshes", files={"file": ("stone.obj", TETRAHEDRON)})
    assert mesh.status_code == 201, mesh.text
    made = await gateway.http.put(path, json={"scene": {"stones": [{"mesh": mesh.json()["id"]}]}})
    assert made.status_code == 201, made.text
    assert made.url.join(made.headers["Location"]).path == path
    assert made.headers["Culet-Watch"] == made.json()["watch"]
    assert (await gateway.http.post(f"{path}/skies", files={"file": ("sky.txt", b"")})).status_code == 422
    watched = await gateway.http.post(f"/api/sessions/{made.json()['watch']}/meshes", files={"file": ("a.obj", b"")})
    assert watched.status_code == 403, "a watch id lets watch"
    await gateway.http.delete(path)
    gone = await gateway.http.post(f"{path}/meshes", files={"file": ("stone.obj", TETRAHEDRON)})
    assert gone.status_code == 404, "a session that was deleted is not about to be made again"
    assert (await gateway.http.put(path, json={"scene": {}})).status_code == 404
    assert (await gateway.http.put("/api/sessions/x", json={"scene": {}})).status_code == 422
    assert (await gateway.http.post("/api/sessions/x/meshes", files={"file": ("a.obj", b"")})).status_code == 404


async def test_a_session_that_was_deleted_stays_so(gateway: Gateway) -> None:
    session = await gateway.session()
    await gateway.http.delete(f"/api/sessions/{session}")
    refused = await gateway.http.post("/api/sessions", json={"id": session, "scene": {}})
    assert (refused.status_code, refused.json()["detail"]) == (404, "that session was deleted")


async def snapshot_of(gateway: Gateway, scene: dict[str, Any]) -> dict[str, Any]:
    """The snapshot of a new session."""
    session = await gateway.session(scene)
    found = gateway.parts.sessions.get(session).snapshot
    await gateway.http.delete(f"/api/sessions/{session}")
    assert found
    return found


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"step": -1}, "snapshot.step"),
        ({"step": 2**63}, "snapshot.step"),
        ({"sequence": "many"}, "snapshot.sequence"),
        ({"fraction": 1}, "snapshot.fraction"),
        ({"home": {"position": [0, 0, 0]}}, None),
        ({"simulation": {"version": 3}}, "version"),
        ({"simulation": []}, "snapshot.simulation"),
        ({"environment": {"kind": "lava"}}, "snapshot.environment.kind"),
        ({"more": 1}, "snapshot.more"),
    ],
)
async def test_what_is_no_snapshot_is_refused_by_its_field(
    gateway: Gateway, wrong: dict[str, Any], field: str | None
) -> None:
    snapshot = await snapshot_of(gateway, LIVELY) | wrong
    refused = await gateway.http.post("/api/sessions", json={"id": UNKNOWN, "scene": LIVELY, "snapshot": snapshot})
    assert refused.status_code == 422, refused.text
    if field:
        assert refused.json()["field"].startswith(field)
    assert (await gateway.http.get(f"/api/sessions/{UNKNOWN}")).status_code == 404


async def test_a_snapshot_of_another_solver_s_version_is_refused_by_that_reason(gateway: Gateway) -> None:
    """Of several stones the page then has the session made again without it."""
    scene = {"stones": [{"id": "a"}, {"id": "b", "position": [3, 1, 0]}]}
    snapshot = await snapshot_of(gateway, scene)
    content = bytearray(base64.b64decode(snapshot["simulation"]["saved"]))
    content[0] -= 1  # the version's lowest byte
    older = snapshot["simulation"] | {"saved": base64.b64encode(content).decode()}
    asked = {"id": UNKNOWN, "scene": scene, "snapshot": snapshot | {"simulation": older}}
    refused = await gateway.http.post("/api/sessions", json=asked)
    assert refused.status_code == 422, refused.text
    assert "solver version" in refused.json()["detail"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"position": [1e30, 1e30, 1e30]},
        {"momentum": [1e30, -1e30, 1e30]},
        {"angular_momentum": [1e30, 1e30, 1e30]},
        {"position": [0, -0.9, 0], "momentum": [0, -1e9, 0]},
        {"time": 1e30},
    ],
)
async def test_a_snapshot_of_a_motion_that_no_stone_has_ends_nobody_elses(
    gateway: Gateway, wrong: dict[str, Any]
) -> None:
    snapshot = await snapshot_of(gateway, LIVELY)
    saved = snapshot["simulation"]["saved"]
    state = saved["state"] | wrong
    hostile = snapshot | {
        "falling": True,
        "step": 2**63 - 1,
        "sequence": 2**63 - 1,
        "simulation": snapshot["simulation"] | {"saved": saved | {"state": state, "previous": state}},
    }
    made = await gateway.http.post("/api/sessions", json={"id": UNKNOWN, "scene": LIVELY, "snapshot": hostile})
    assert made.status_code in (201, 422), made.text
    other = await gateway.session()
    if made.status_code == 201:
        async with gateway.viewer(UNKNOWN) as viewer:
            await viewer.until(lambda: bool(viewer.frames) or any(n["type"] == "problem" for n in viewer.notices))
        await gateway.http.delete(f"/api/sessions/{UNKNOWN}")
        gateway.parts.sessions._deleted.clear()
    async with gateway.viewer(other) as viewer:
        await viewer.final()
    await gateway.http.delete(f"/api/sessions/{other}")


@pytest.mark.parametrize(
    ("request_", "field"),
    [
        ({"id": UNKNOWN}, None),
        ({"snapshot": {}}, None),
        ({"id": "../etc", "scene": {}}, "id"),
        ({"id": UNKNOWN.upper(), "scene": {}}, "id"),
        ({"id": UNKNOWN, "scene": {"camera": {"fov_degrees": 500}}}, "scene.camera.fov_degrees"),
        ({"id": UNKNOWN, "scene": {"stones": [{"mesh": "ab" * 16}]}}, "stones.0.mesh"),
    ],
)
async def test_a_request_for_a_lost_session_says_what_it_lacks(
    gateway: Gateway, request_: dict[str, Any], field: str | None
) -> None:
    refused = await gateway.http.post("/api/sessions", json=request_)
    assert refused.status_code == 422, refused.text
    assert refused.json().get("field") == field

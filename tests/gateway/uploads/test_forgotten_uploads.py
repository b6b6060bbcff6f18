"""An engine that forgets uploads soon: neither sessions nor stills notice, since the gateway gives them again."""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest

from gateway.running import TETRAHEDRON, Endpoints, Gateway, engine_process, gateway_before, png

FORGETFUL = """
import sys
from culet.engine.capacity.limits import Limits
from culet.engine.process.serve import run
run(sys.argv[1], [sys.argv[2]], Limits(max_uploads=1))
"""
SIZE = {"width": 16, "height": 9, "samples": 1}
COMMENT = 3
"""Bytes that make a file another one."""
ROOM = 2 * (len(TETRAHEDRON) + COMMENT)
"""Bytes of the two meshes that a gateway here may keep."""


@pytest.fixture(scope="module")
def forgetful() -> Iterator[Endpoints]:
    """An engine that keeps one mesh and one sky besides those that sessions show."""
    with engine_process(lambda control, frames: [sys.executable, "-c", FORGETFUL, control, frames]) as endpoints:
        yield endpoints


@pytest.fixture
async def gateway(forgetful: Endpoints, tmp_path: Path) -> AsyncIterator[Gateway]:
    """Before that engine."""
    async with gateway_before(forgetful, web=tmp_path) as running:
        yield running


async def uploaded(gateway: Gateway, number: int) -> str:
    """A mesh; the one before is forgotten, unless a session shows it."""
    file = {"file": ("stone.obj", b"#%d\n" % number + TETRAHEDRON)}
    answer = await gateway.http.post("/api/meshes", files=file)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


async def uploaded_sky(gateway: Gateway, red: int) -> str:
    answer = await gateway.http.post("/api/skies", files={"file": ("sky.png", png(8, 4, (red, 0, 0)))})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


async def patched(gateway: Gateway, session: str, patch: dict[str, Any]) -> dict[str, Any]:
    answer = await gateway.http.patch(f"/api/sessions/{session}", json=patch)
    assert answer.status_code == 200, answer.text
    scene: dict[str, Any] = answer.json()["scene"]
    return scene


async def test_a_session_goes_to_another_mesh_and_back(gateway: Gateway) -> None:
    first = await uploaded(gateway, 1)
    session = await gateway.session({"stones": [{"mesh": first}]})
    second = await uploaded(gateway, 2)
    for mesh in (second, first, second):
        await uploaded(gateway, 3)  # the engine forgets the one that the session does not show
        assert (await patched(gateway, session, {"stones": [{"mesh": mesh}]}))["stones"][0]["mesh"] == mesh


async def test_a_session_turns_a_sky_that_the_engine_has_forgotten(gateway: Gateway) -> None:
    first = await uploaded_sky(gateway, 200)
    session = await gateway.session({"environment": {"kind": "image", "image": first}})
    await patched(gateway, session, {"environment": {"kind": "dark"}})
    for red in (100, 50):
        await uploaded_sky(gateway, red)
    scene = await patched(gateway, session, {"environment": {"kind": "image", "image": first, "turn_degrees": 90}})
    assert scene["environment"]["image"] == first


async def test_new_sessions_and_stills_are_of_forgotten_uploads_too(gateway: Gateway) -> None:
    meshes = [await uploaded(gateway, number) for number in (1, 2)]
    skies = [await uploaded_sky(gateway, red) for red in (200, 100)]
    for mesh, sky in zip(meshes, skies, strict=True):
        scene = {"stones": [{"mesh": mesh}], "environment": {"kind": "image", "image": sky}}
        await gateway.session(scene)
        still = await gateway.http.post("/api/render", json={"scene": scene, **SIZE})
        assert still.status_code == 200, still.text


async def test_what_nobody_uploaded_is_refused_as_ever(gateway: Gateway) -> None:
    await uploaded(gateway, 1)
    answer = await gateway.http.post("/api/render", json={"scene": {"stones": [{"mesh": "nowhere"}]}, **SIZE})
    assert (answer.status_code, answer.json()["field"]) == (422, "stones.0.mesh")


async def test_what_sessions_use_is_kept_and_others_go_first(forgetful: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(forgetful, web=tmp_path, max_kept_upload_bytes=ROOM) as gateway:
        first = await uploaded(gateway, 1)
        await gateway.session({"stones": [{"mesh": first}]})
        second, third = await uploaded(gateway, 2), await uploaded(gateway, 3)
        kept = {}
        for mesh in (first, second, third):
            answer = await gateway.http.post("/api/render", json={"scene": {"stones": [{"mesh": mesh}]}, **SIZE})
            kept[mesh] = answer.status_code
        assert kept == {first: 200, second: 422, third: 200}
        assert gateway.parts.uploads.kept_bytes == ROOM
        session = await gateway.session({"stones": [{"mesh": third}]})
        full = await gateway.http.post("/api/meshes", files={"file": ("stone.obj", TETRAHEDRON)})
        assert full.status_code == 429, full.text
        assert f"over the limit of {ROOM}" in full.json()["detail"]
        assert (await gateway.http.delete(f"/api/sessions/{session}")).status_code == 204
        await uploaded(gateway, 4)

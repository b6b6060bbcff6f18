"""Uploads of meshes and skies: what is accepted can be rendered, what is not is named, nothing is left on disk."""

from __future__ import annotations

import asyncio
import io
import tempfile
import threading
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from culet.gateway.uploads.upload_folder import UploadFolder
from culet.optics.panoramas import STUDIO
from culet_protocol.messages import Outline
from gateway.running import PATIENCE, TETRAHEDRON, Endpoints, Gateway, gateway_before, png


def form(name: str, data: bytes) -> dict[str, tuple[str, bytes]]:
    return {"file": (name, data)}


async def test_an_uploaded_mesh_is_described_and_can_be_rendered(gateway: Gateway) -> None:
    answer = await gateway.http.post("/api/meshes", files=form("stone.obj", TETRAHEDRON))
    assert answer.status_code == 201, answer.text
    mesh = answer.json()
    assert mesh["description"]["convex"] is True
    assert mesh["description"]["facets"] == 4
    again = await gateway.http.post("/api/meshes", files=form("same.obj", TETRAHEDRON))
    assert again.json()["id"] == mesh["id"], "the same file has the same id"
    scene = {"stones": [{"mesh": mesh["id"]}]}
    picture = await gateway.http.post("/api/render", json={"scene": scene, "width": 32, "height": 18, "samples": 1})
    assert picture.status_code == 200, picture.text


async def test_each_stone_of_a_scene_is_of_an_upload_of_its_own(gateway: Gateway) -> None:
    """Tetrahedra, each higher than the one before, seen from far in front."""

    async def uploaded(number: int) -> str:
        data = TETRAHEDRON.replace(b"v 1 1 1\n", b"v 1 %d 1\n" % (1 + number))
        answer = await gateway.http.post("/api/meshes", files=form("stone.obj", data))
        assert answer.status_code == 201, answer.text
        return str(answer.json()["id"])

    camera = {"kind": "orthographic", "position": [0, 0, 20], "target": [0, 0, 0], "height": 12}
    stones = [
        {"id": f"s{number}", "mesh": await uploaded(number), "orientation": [1, 0, 0, 0], "position": [0, y, 0]}
        for number, y in enumerate((-4, 0, 4))
    ]
    corners = []
    async with gateway.viewer(await gateway.session({"camera": camera, "stones": stones})) as viewer:
        frame = await viewer.frame()
        for stone in stones:
            await viewer.say(Outline(stone=stone["id"], step=frame.step))
            outlined = await viewer.notice("outlined")
            assert outlined["stone"] == stone["id"]
            corners.append(np.reshape(outlined["points"], (-1, 2)) * 6 - (0, stone["position"][1]))
    for each in corners:
        assert np.linalg.norm(each, axis=1).max() == pytest.approx(1, abs=0.3)
    proportions = [float(np.divide(*np.ptp(each, axis=0))) for each in corners]
    assert proportions == sorted(proportions, reverse=True)
    assert proportions[0] > 1.2 * proportions[1] > 1.2**2 * proportions[2]


def mean_colour(picture: bytes) -> list[float]:
    return [float(c) for c in np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), float).mean((0, 1))]


async def test_an_uploaded_sky_is_described_and_seen_in_stills_and_sessions(gateway: Gateway) -> None:
    answer = await gateway.http.post("/api/skies", files=form("dusk.png", png(16, 8, (200, 100, 50))))
    assert answer.status_code == 201, answer.text
    sky = answer.json()
    assert (sky["description"]["width"], sky["description"]["height"]) == (16, 8)
    environment = {"kind": "image", "image": sky["id"]}
    bare = {"stones": [], "floor": {"kind": "none"}, "backdrop": {"kind": "none"}}
    nothing_but_sky = {**bare, "environment": environment}
    still = await gateway.http.post(
        "/api/render", json={"scene": nothing_but_sky, "width": 32, "height": 18, "samples": 1, "format": "png"}
    )
    assert still.status_code == 200, still.text
    assert mean_colour(still.content) == pytest.approx([200, 100, 50], abs=1)  # measured 0
    session = await gateway.session({**bare, "environment": {"kind": "dark"}})
    patched = await gateway.http.patch(f"/api/sessions/{session}", json={"environment": environment})
    assert patched.status_code == 200, patched.text
    async with gateway.viewer(session) as viewer:
        assert mean_colour((await viewer.final()).payload) == pytest.approx([200, 100, 50], abs=3)  # measured 1


@pytest.mark.parametrize(
    ("name", "data", "defect"),
    [
        ("empty.png", b"", "expected a .png picture, which begins with"),
        ("text.hdr", b"sunny", "expected a Radiance picture, which begins with"),
        ("stone.obj", TETRAHEDRON, ".exr, .hdr, .png"),
    ],
)
async def test_what_is_not_a_sky_is_refused_by_its_defect(
    gateway: Gateway, name: str, data: bytes, defect: str
) -> None:
    answer = await gateway.http.post("/api/skies", files=form(name, data))
    assert (answer.status_code, answer.json()["field"]) == (422, "file"), answer.text
    assert defect in answer.json()["detail"]


async def test_the_studios_skies_are_listed_and_all_can_be_rendered(gateway: Gateway) -> None:
    skies = (await gateway.http.get("/api/skies")).json()["skies"]
    assert {sky["name"] for sky in skies} == set(STUDIO)
    for sky in skies:
        scene = {"environment": {"kind": "image", "image": sky["name"]}}
        answer = await gateway.http.post("/api/render", json={"scene": scene, "width": 16, "height": 9, "samples": 1})
        assert answer.status_code == 200, answer.text


@pytest.mark.parametrize("image", ["nowhere", "../../etc/sky.png"])
async def test_a_sky_that_nobody_uploaded_is_refused_by_field(gateway: Gateway, image: str) -> None:
    scene = {"environment": {"kind": "image", "image": image}}
    session = await gateway.session()
    for answer in (
        await gateway.http.post("/api/render", json={"scene": scene}),
        await gateway.http.post("/api/sessions", json={"scene": scene}),
        await gateway.http.patch(f"/api/sessions/{session}", json=scene),
    ):
        assert answer.status_code == 422, answer.text
        assert answer.json()["field"].removeprefix("scene.") == "environment.image"


@pytest.mark.parametrize(
    ("name", "data", "defect"),
    [
        ("empty.obj", b"", "empty"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "boundary edges"),
        ("open.obj", TETRAHEDRON.rsplit(b"f ", 1)[0], "open"),
        ("text.stl", b"this is no mesh", "expected"),
        ("stone.exe", TETRAHEDRON, "stone.exe"),
        ("stone", TETRAHEDRON, ".obj, .off, .stl, .ply, .glb"),
        ("../../stone.obj/..", TETRAHEDRON, "expected a name that ends with"),
    ],
)
async def test_what_is_not_a_stone_is_refused_by_its_defect(
    gateway: Gateway, name: str, data: bytes, defect: str
) -> None:
    answer = await gateway.http.post("/api/meshes", files=form(name, data))
    assert answer.status_code == 422, answer.text
    assert defect in answer.json()["detail"]


async def test_an_upload_needs_the_field_file(gateway: Gateway) -> None:
    for answer in (
        await gateway.http.post("/api/meshes", files={"mesh": ("stone.obj", TETRAHEDRON)}),
        await gateway.http.post("/api/meshes", json={}),
        await gateway.http.post("/api/meshes"),
    ):
        assert (answer.status_code, answer.json()["field"]) == (422, "file"), answer.text


async def test_a_mesh_over_the_limit_is_refused_and_nothing_stays_on_disk(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))

    async def without_length() -> AsyncIterator[bytes]:
        yield b'--b\r\nContent-Disposition: form-data; name="file"; filename="x.obj"\r\n\r\n'
        for _ in range(64):
            yield b"v 0 0 0\n" * (1 << 13)
        yield b"\r\n--b--\r\n"

    async with gateway_before(engine, web=tmp_path, max_upload_bytes=1 << 21) as gateway:
        over = await gateway.http.post("/api/meshes", files=form("big.obj", b"#" * (1 << 21) + TETRAHEDRON))
        assert (over.status_code, over.json()["field"]) == (413, "file")
        headers = {"Content-Type": "multipart/form-data; boundary=b"}
        undeclared = await gateway.http.post("/api/meshes", content=without_length(), headers=headers)
        assert (undeclared.status_code, undeclared.json()["field"]) == (413, "file")
        kept = await gateway.http.post("/api/meshes", files=form("ok.obj", b"#" * (1 << 20) + b"\n" + TETRAHEDRON))
        assert kept.status_code == 201, kept.text
    assert list(scratch.iterdir()) == []


async def test_of_uploads_kept_for_a_new_engine_the_oldest_go_first(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, max_kept_upload_bytes=2 * len(TETRAHEDRON) + 10) as gateway:
        for comment in (b"#1\n", b"#2\n", b"#3\n"):
            answer = await gateway.http.post("/api/meshes", files=form("stone.obj", comment + TETRAHEDRON))
            assert answer.status_code == 201, answer.text
        assert gateway.parts.uploads.kept_bytes == 2 * (len(TETRAHEDRON) + 3)


async def test_an_upload_that_is_forgotten_while_its_file_is_written_leaves_no_file(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, go_on = asyncio.Event(), threading.Event()
    loop, write = asyncio.get_running_loop(), UploadFolder.write

    def slow(folder: UploadFolder, name: str, kind: str, file_type: str, data: bytes) -> None:
        if not begun.is_set():
            loop.call_soon_threadsafe(begun.set)
            assert go_on.wait(PATIENCE)
        write(folder, name, kind, file_type, data)

    monkeypatch.setattr(UploadFolder, "write", slow)
    limits = {"max_kept_upload_bytes": len(TETRAHEDRON) + 10, "uploads_folder": tmp_path / "uploads"}
    async with gateway_before(engine, web=tmp_path, **limits) as gateway:
        first = asyncio.create_task(gateway.http.post("/api/meshes", files=form("stone.obj", b"#1\n" + TETRAHEDRON)))
        async with asyncio.timeout(PATIENCE):
            await begun.wait()
        second = await gateway.http.post("/api/meshes", files=form("stone.obj", b"#2\n" + TETRAHEDRON))
        go_on.set()
        assert (await first).status_code == second.status_code == 201
        assert [path.name for path in (tmp_path / "uploads").iterdir()] == [f"{second.json()['id']}.mesh.obj"]

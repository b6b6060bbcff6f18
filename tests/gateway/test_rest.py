"""REST over a real server and engine: answers, and a clear problem document for everything that cannot be done."""

from __future__ import annotations

import asyncio
import io
from pathlib import Path
from typing import Any, get_args

import httpx
import numpy as np
import pytest
from PIL import Image

from culet.gateway.uploads.uploads import Uploads
from culet.scene import PRESETS
from culet.scene.cuts import CUTS
from culet.scene.motion import MotionLaws
from culet.scene.stone import MaterialName
from culet_client import FrameSubscription
from culet_protocol.engine import Grade
from culet_protocol.messages import Message
from culet_protocol.watch import watch_id
from gateway.running import FOREIGN, PATIENCE, Endpoints, Gateway, eventually, gateway_before

SMALL = {"width": 64, "height": 36}
TINY: dict[str, Any] = {"width": 16, "height": 9, "samples": 1}
JSON = {"Content-Type": "application/json"}


def assert_problem(answer: httpx.Response, status: int, field: str | None = None) -> None:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    body = answer.json()
    assert body["status"] == status
    assert body["title"]
    assert body["detail"]
    assert body.get("field") == field, body


async def test_a_preset_renders_as_a_tga_with_a_footer(gateway: Gateway) -> None:
    answer = await gateway.http.get("/api/render.tga", params={**SMALL, "preset": "matte", "samples": 1})
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "image/x-tga"
    assert answer.content.endswith(b"TRUEVISION-XFILE.\0")
    picture = Image.open(io.BytesIO(answer.content))
    assert (picture.format, picture.size, picture.mode) == ("TGA", (64, 36), "RGB")


async def test_an_address_that_leads_nowhere_is_told_where_all_are_listed(gateway: Gateway) -> None:
    answer = await gateway.http.get("/api/render.gif", params=SMALL)
    assert_problem(answer, 404)
    assert answer.json()["detail"] == "there is nothing at '/api/render.gif'; /docs has all addresses"


async def test_without_parameters_the_picture_is_640_by_360(gateway: Gateway) -> None:
    answer = await gateway.http.get("/api/render.tga")
    assert Image.open(io.BytesIO(answer.content)).size == (640, 360)


async def test_a_still_looks_right_if_nobody_says_how_good_it_is_to_be(gateway: Gateway) -> None:
    """Edges of 16 samples, and what is shown off by 0.01; no more is promised than what is asked for."""
    for answer in (
        await gateway.http.get("/api/render.png", params=SMALL),
        await gateway.http.post("/api/render", json=SMALL),
    ):
        assert 16 <= int(answer.headers["culet-samples"]) < 100  # measured 39
        assert 0 < float(answer.headers["culet-error"]) <= 0.01
        assert "culet-target" not in answer.headers


@pytest.mark.parametrize(
    ("file_format", "media_type", "magic"),
    [
        ("tga", "image/x-tga", b"\0\0\2"),
        ("png", "image/png", b"\x89PNG"),
        ("jpeg", "image/jpeg", b"\xff\xd8"),
        ("webp", "image/webp", b"RIFF"),
        ("exr", "image/x-exr", b"\x76\x2f\x31\x01"),
    ],
)
async def test_a_scene_renders_in_every_format(
    gateway: Gateway, file_format: str, media_type: str, magic: bytes
) -> None:
    answer = await gateway.http.post("/api/render", json={"scene": {}, **SMALL, "samples": 1, "format": file_format})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == media_type
    assert answer.content.startswith(magic)


@pytest.mark.parametrize(
    ("ending", "media_type", "name"),
    [
        ("png", "image/png", "PNG"),
        ("jpg", "image/jpeg", "JPEG"),
        ("webp", "image/webp", "WEBP"),
        ("tga", "image/x-tga", "TGA"),
    ],
)
async def test_an_address_ends_as_the_picture_that_it_answers_with(
    gateway: Gateway, ending: str, media_type: str, name: str
) -> None:
    """What `<img src>` of a page can show; without loss but for JPEG, so the same picture."""
    query: dict[str, str | int] = {**SMALL, "preset": "matte", "samples": 1}
    answer = await gateway.http.get(f"/api/render.{ending}", params=query)
    assert (answer.status_code, answer.headers["content-type"]) == (200, media_type)
    picture = Image.open(io.BytesIO(answer.content))
    assert (picture.format, picture.size) == (name, (64, 36))
    reference = Image.open(io.BytesIO((await gateway.http.get("/api/render.png", params=query)).content))
    difference = np.abs(np.asarray(picture, np.int16) - np.asarray(reference, np.int16))
    assert difference.max() <= (60 if ending == "jpg" else 0)  # measured 22 of JPEG at a checker's edge
    session = await gateway.session()
    frame = await gateway.http.get(f"/api/sessions/{session}/frame.{ending}", params=SMALL)
    assert (frame.status_code, frame.headers["content-type"]) == (200, media_type)
    kind = "attachment" if ending == "tga" else "inline"
    assert frame.headers["content-disposition"] == f'{kind}; filename="culet-1.{ending}"'  # a new session is at step 1


async def test_a_legend_is_drawn_into_stills_that_have_one(gateway: Gateway) -> None:
    """In the lower left corner, of a preset, a scene and a session alike."""
    size = {"width": 240, "height": 180, "samples": 1}
    asked: dict[str, str | int] = {**size, "preset": "aset"}
    plain, told = [
        await gateway.http.get("/api/render.png", params=asked | {"legend": legend}) for legend in ("false", "true")
    ]
    pixels = [np.asarray(Image.open(io.BytesIO(each.content))) for each in (plain, told)]
    changed = (pixels[0] != pixels[1]).any(axis=-1)
    assert changed[-20:, :20].all()
    assert not changed[:60].any()
    assert not changed[:, -40:].any()
    assert plain.headers["etag"] != told.headers["etag"]
    scene = PRESETS["aset"].scene.model_dump(mode="json")
    of_scene = await gateway.http.post("/api/render", json={"scene": scene, **size, "legend": True, "format": "png"})
    assert of_scene.content == told.content
    session = (await gateway.http.post("/api/sessions", json={"preset": "aset"})).json()["id"]
    of_session = await gateway.http.get(f"/api/sessions/{session}/frame.png", params=size | {"legend": "true"})
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(of_session.content)))[-20:, :20], pixels[1][-20:, :20])


@pytest.mark.parametrize(
    ("path", "query"),
    [
        ("/api/render.png", {"preset": "white"}),
        ("/api/render.png", {"preset": "aset", "width": 64}),
        ("/api/render.exr", {"preset": "aset"}),
    ],
)
async def test_a_legend_that_cannot_be_is_refused(gateway: Gateway, path: str, query: dict[str, str]) -> None:
    asked = {"width": "240", "height": "180", "samples": "1", "legend": "true"} | query
    assert_problem(await gateway.http.get(path, params=asked), 422, "legend")


async def test_another_sky_of_a_preset_is_seen(gateway: Gateway) -> None:
    """Behind the atelier's backdrop it would not be: with it the corners are nearly black."""
    query: dict[str, str | int] = {**SMALL, "environment": "light", "samples": 1}
    picture = Image.open(io.BytesIO((await gateway.http.get("/api/render.png", params=query)).content))
    assert np.asarray(picture)[0, 0].min() > 150  # measured 198


async def test_a_picture_that_the_asker_has_is_not_sent_again(gateway: Gateway) -> None:
    query: dict[str, str | int] = {**SMALL, "preset": "matte", "samples": 1}
    answer = await gateway.http.get("/api/render.png", params=query)
    tag = answer.headers["etag"]
    assert answer.headers["cache-control"] == "max-age=3600"
    for known in (tag, f'"another", {tag}', tag.removeprefix("W/"), "*"):
        again = await gateway.http.get("/api/render.png", params=query, headers={"If-None-Match": known})
        assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag), known
    others: list[dict[str, str | int]] = [
        {"width": 65}, {"preset": "mirror"}, {"samples": 2}, {"material": "ruby"}, {"floor": "none"}
    ]  # fmt: skip
    for other in others:
        changed = await gateway.http.get("/api/render.png", params=query | other, headers={"If-None-Match": tag})
        assert (changed.status_code, changed.headers["content-type"]) == (200, "image/png"), other
        assert changed.headers["etag"] != tag, other
    assert (await gateway.http.get("/api/render.webp", params=query)).headers["etag"] != tag
    refused = await gateway.http.get("/api/render.png", params=query | {"width": 0}, headers={"If-None-Match": "*"})
    assert_problem(refused, 422, "width")


async def test_an_address_of_another_ending_is_not_found(gateway: Gateway) -> None:
    assert_problem(await gateway.http.get("/api/render.bmp"), 404)


async def test_every_preset_is_a_scene_that_renders(gateway: Gateway) -> None:
    presets = (await gateway.http.get("/api/presets")).json()["presets"]
    assert {"default", "classic"} <= {preset["name"] for preset in presets}
    for preset in presets:
        answer = await gateway.http.post(
            "/api/render", json={"scene": preset["scene"], "width": 16, "height": 9, "samples": 1}
        )
        assert answer.status_code == 200, (preset["name"], answer.text)


async def test_materials_and_cuts_can_be_named_in_a_scene(gateway: Gateway) -> None:
    materials = (await gateway.http.get("/api/materials")).json()["materials"]
    cuts = (await gateway.http.get("/api/cuts")).json()["cuts"]
    # Diamond at 656.3, 546.1 and 435.8 nm by Peter's Sellmeier fit (1923).
    assert materials[0]["indices"] == pytest.approx([2.4097, 2.4236, 2.4514], abs=2e-3)
    assert "table_percent" in cuts[0]["proportions"]
    assert {material["name"] for material in materials} == set(get_args(MaterialName))
    for material in materials:
        stone = {"cut": {"name": cuts[0]["name"], "table_percent": 57}, "material": material["name"]}
        answer = await gateway.http.post(
            "/api/render", json={"scene": {"stones": [stone]}, "width": 16, "height": 9, "samples": 1}
        )
        assert answer.status_code == 200, (material["name"], answer.text)
    assert {cut["name"] for cut in cuts} == set(CUTS)
    for cut in cuts:
        sliders = [name for name, schema in cut["proportions"].items() if "usual" in schema]
        own = {name: cut["proportions"][name]["default"] for name in sliders[-1:]}
        scene = {"stones": [{"cut": {"name": cut["name"], **own}}]}
        answer = await gateway.http.post("/api/render", json={"scene": scene, **TINY})
        assert answer.status_code == 200, (cut["name"], answer.text)
    refused = {"stones": [{"cut": {"name": "trillion", "table_percent": 88}}]}
    assert_problem(await gateway.http.post("/api/render", json={"scene": refused}), 422, "stones.0.cut.table_percent")


async def test_the_integrators_listed_are_those_of_the_scene(gateway: Gateway) -> None:
    integrators = (await gateway.http.get("/api/integrators")).json()["integrators"]
    named = MotionLaws.model_json_schema()["properties"]["integrator"]["enum"]
    assert [integrator["name"] for integrator in integrators] == named
    assert all(integrator["summary"].endswith(".") for integrator in integrators)


async def test_a_material_says_where_its_numbers_come_from(gateway: Gateway) -> None:
    listed = (await gateway.http.get("/api/materials")).json()["materials"]
    materials = {material.pop("name"): material for material in listed}
    ruby, classic = materials["ruby"], materials["classic"]
    assert "Malitson" in ruby["source"]
    assert (ruby["confidence"], ruby["ray"], ruby["coloured"]) == ("measured", "ordinary ray", True)
    assert (classic["confidence"], classic["ray"], classic["coloured"]) == ("as set", None, False)
    assert classic["indices"] == [1.7, 1.8, 1.9]
    assert materials["emerald"]["confidence"] == "weak source"
    assert ruby["span_nm"] == [200, 5000]
    still = await gateway.http.get("/api/render.tga", params={**SMALL, "material": "ruby", "samples": 1})
    assert still.status_code == 200


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ('{"scene": {"camera": {"fov_degrees": NaN}}}', "scene.camera.fov_degrees"),
        ('{"scene": {"camera": {"fov_degrees": Infinity}}}', "scene.camera.fov_degrees"),
        ('{"scene": {"camera": {"fov_degrees": 1e999}}}', "scene.camera.fov_degrees"),
        ('{"scene": {"camera": {"fov_degrees": 1000}}}', "scene.camera.fov_degrees"),
        ('{"scene": {"camera": {"zoom": 2}}}', "scene.camera.zoom"),
        ('{"scene": {"stones": [{"mesh": "/etc/passwd"}]}}', "scene.stones.0.mesh"),
        ('{"scene": {"stones": [{"cut": {"table_percent": 500}}]}}', "scene.stones.0.cut.table_percent"),
        ('{"scene": {"environment": {"kind": "gradient", "top": 7}}}', "scene.environment.top"),
        ('{"scene": {}, "width": 0}', "width"),
        ('{"scene": {}, "height": 100000}', "height"),
        ('{"scene": {}, "width": 8192, "height": 8192}', "width"),
        ('{"scene": {}, "format": "gif"}', "format"),
        ('{"scene": {}', None),
        ("[]", None),
    ],
)
async def test_a_scene_that_cannot_be_used_is_refused_by_field(gateway: Gateway, body: str, field: str | None) -> None:
    assert_problem(await gateway.http.post("/api/render", content=body, headers=JSON), 422, field)


@pytest.mark.parametrize(
    ("query", "status", "field"),
    [
        ("width=0", 422, "width"),
        ("height=100000", 422, "height"),
        ("width=nan", 422, "width"),
        ("widht=640", 422, "widht"),
        ("preset=coal", 404, None),
    ],
)
async def test_a_query_that_cannot_be_used_is_refused_by_field(
    gateway: Gateway, query: str, status: int, field: str | None
) -> None:
    assert_problem(await gateway.http.get(f"/api/render.tga?{query}"), status, field)


async def test_a_session_is_made_asked_changed_and_forgotten(gateway: Gateway) -> None:
    made = await gateway.http.post("/api/sessions", json={"preset": "matte"})
    assert made.status_code == 201
    assert made.headers["Location"] == f"sessions/{made.json()['id']}", "relative: a proxy may have all in a folder"
    path = made.url.join(made.headers["Location"]).path
    assert path == f"/api/sessions/{made.json()['id']}"
    assert made.json()["scene"]["floor"]["kind"] == "matte"

    changed = await gateway.http.patch(path, json={"floor": {"kind": "none"}, "emitters": []})
    assert changed.status_code == 200
    scene: dict[str, Any] = (await gateway.http.get(path)).json()["scene"]
    assert (scene["floor"]["kind"], scene["emitters"]) == ("none", [])
    for environment in (
        {"kind": "light"},
        {"kind": "constant", "radiance": [1, 2, 3]},
    ):  # from a studio
        changed = await gateway.http.patch(path, json={"environment": environment})
        assert changed.json()["scene"]["environment"] == environment

    assert (await gateway.http.delete(path)).status_code == 204
    assert_problem(await gateway.http.post(f"{path}/events", json={"type": "toggle_fall"}), 404)
    for method, body in (("GET", None), ("PATCH", {}), ("DELETE", None)):
        assert_problem(await gateway.http.request(method, path, json=body), 404)
    for name in ("frame.tga", "frame.png"):
        assert_problem(await gateway.http.get(f"{path}/{name}"), 404)


async def test_a_session_without_a_body_shows_the_preset_default(gateway: Gateway) -> None:
    made = await gateway.http.post("/api/sessions")
    assert made.status_code == 201
    assert made.json()["scene"] == PRESETS["default"].scene.model_dump(mode="json")


@pytest.mark.parametrize(
    ("body", "status", "field"),
    [
        ({"preset": "coal"}, 404, None),
        ({"preset": "matte", "scene": {}}, 422, None),
        ({"scene": {"emitters": 7}}, 422, "scene.emitters"),
    ],
)
async def test_a_session_that_cannot_be_made_is_refused(
    gateway: Gateway, body: dict[str, Any], status: int, field: str | None
) -> None:
    assert_problem(await gateway.http.post("/api/sessions", json=body), status, field)


@pytest.mark.parametrize(
    ("patch", "field"),
    [
        ('{"camera": {"fov_degrees": NaN}}', "camera.fov_degrees"),
        ('{"camera": {"fov_degrees": -1}}', "camera.fov_degrees"),
        ('{"flor": {"kind": "matte"}}', "flor"),
        ('{"camera": ' + "[" * 900 + "]" * 900 + "}", ".".join(["camera", *["0"] * 32])),
    ],
)
async def test_a_patch_that_cannot_be_used_leaves_the_session_as_it_was(
    gateway: Gateway, patch: str, field: str
) -> None:
    path = f"/api/sessions/{await gateway.session()}"
    before = (await gateway.http.get(path)).json()
    assert_problem(await gateway.http.patch(path, content=patch, headers=JSON), 422, field)
    assert (await gateway.http.get(path)).json() == before


async def test_an_event_by_rest_does_what_it_does_by_the_stream(gateway: Gateway) -> None:
    path = f"/api/sessions/{await gateway.session()}"
    before = (await gateway.http.get(path)).json()
    assert not before["falling"]
    answer = await gateway.http.post(f"{path}/events", json={"type": "toggle_fall"})
    assert answer.status_code == 200
    assert answer.json()["falling"]
    answer = await gateway.http.post(f"{path}/events", json={"type": "dolly", "target": "camera", "forward": 0.5})
    assert answer.json()["scene"]["camera"] != before["scene"]["camera"]


@pytest.mark.parametrize(
    ("event", "field"),
    [
        ('{"type": "explode"}', "type"),
        ('{"yaw": 1, "pitch": 0}', "type"),
        ('{"type": "dolly", "target": "camera", "forward": "far"}', "dolly.forward"),
        ('{"type": "patch_scene", "patch": {"camera": {"fov_degrees": NaN}}}', "camera.fov_degrees"),
        ('{"type": "ack", "sequence": 1}', "type"),
    ],
)
async def test_an_event_that_cannot_be_used_leaves_the_session_as_it_was(
    gateway: Gateway, event: str, field: str | None
) -> None:
    path = f"/api/sessions/{await gateway.session()}"
    before = (await gateway.http.get(path)).json()
    assert_problem(await gateway.http.post(f"{path}/events", content=event, headers=JSON), 422, field)
    assert (await gateway.http.get(path)).json() == before


async def test_the_frame_of_a_step_is_the_picture_that_was_shown_then(gateway: Gateway) -> None:
    session = await gateway.session({"sampling": {"samples_per_pixel": 1}})
    path = f"/api/sessions/{session}/frame.tga"
    async with gateway.viewer(session) as viewer:
        shown = await viewer.final()
        assert (await gateway.http.get(path)).status_code == 200
        before = (await gateway.http.get(path, params={"step": shown.step})).content
        await gateway.http.patch(f"/api/sessions/{session}", json={"camera": {"position": [3, 2, 3]}})
        await viewer.until(lambda: viewer.frames[-1].step > shown.step)
        again = await gateway.http.get(path, params={"step": shown.step})
        now = await gateway.http.get(path)
    assert again.content == before
    assert now.content != before
    assert again.headers["content-disposition"] == f'attachment; filename="culet-{shown.step}.tga"'
    assert Image.open(io.BytesIO(before)).size == (64, 36), "the size that the viewers see"
    assert_problem(await gateway.http.get(path, params={"step": 10**9}), 404)


async def test_the_scene_of_a_step_makes_another_session_that_shows_the_same_picture(gateway: Gateway) -> None:
    scene = {"sampling": {"samples_per_pixel": 1}, "simulation": {"gravity": 0}, "stones": [{"velocity": [2, 0, 0]}]}
    session = await gateway.session(scene)
    path = f"/api/sessions/{session}"
    async with gateway.viewer(session) as viewer:
        start = (await gateway.http.get(f"{path}/scene")).json()
        assert start == (await gateway.http.get(path)).json()["scene"]
        await gateway.http.post(f"{path}/events", json={"type": "toggle_fall"})
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].simulation_time > 0.1)
        step = viewer.frames[-1].step
        await gateway.http.patch(path, json={"camera": {"position": [3, 2, 3]}})
    shown = (await gateway.http.get(f"{path}/scene", params={"step": step})).json()
    assert shown["camera"] == start["camera"]
    assert shown["stones"][0]["position"][0] > start["stones"][0]["position"][0] + 0.15
    seen = await gateway.http.get(f"{path}/frame.tga", params=SMALL | {"step": step})
    another = await gateway.http.get(f"/api/sessions/{await gateway.session(shown)}/frame.tga", params=SMALL)
    assert another.content == seen.content
    assert_problem(await gateway.http.get(f"{path}/scene", params={"step": 10**9}), 404)
    assert_problem(await gateway.http.get(f"{path}/scene", params={"step": -1}), 422, "step")


async def test_the_frame_of_a_session_is_the_same_picture_as_png_and_as_tga(gateway: Gateway) -> None:
    path = f"/api/sessions/{await gateway.session({'sampling': {'samples_per_pixel': 1}})}/frame"
    targa, png = [await gateway.http.get(f"{path}.{ending}", params=SMALL) for ending in ("tga", "png")]
    assert png.headers["content-type"] == "image/png"
    assert png.headers["content-disposition"] == 'inline; filename="culet-1.png"'
    one, other = (Image.open(io.BytesIO(answer.content)) for answer in (targa, png))
    assert (one.format, other.format, other.size) == ("TGA", "PNG", (64, 36))
    assert one.tobytes() == other.tobytes()
    assert_problem(await gateway.http.get(f"{path}.png", params={"width": 0}), 422, "width")
    assert_problem(await gateway.http.get(f"{path}.png", params={"step": 10**9}), 404)


async def test_the_description_says_of_what_kind_every_picture_is(gateway: Gateway) -> None:
    paths = (await gateway.http.get("/openapi.json")).json()["paths"]
    session = "/api/sessions/{session_id}/frame"
    for operation, kinds in (
        (paths["/api/render.tga"]["get"], {"image/x-tga"}),
        (paths["/api/render.webp"]["get"], {"image/webp"}),
        (paths["/api/render"]["post"], {"image/x-tga", "image/png", "image/jpeg", "image/webp", "image/x-exr"}),
        (paths[f"{session}.tga"]["get"], {"image/x-tga"}),
        (paths[f"{session}.png"]["get"], {"image/png"}),
    ):
        content = operation["responses"]["200"]["content"]
        assert set(content) == kinds
        assert all(answer["schema"] == {"type": "string", "format": "binary"} for answer in content.values())


async def test_a_transparent_picture_has_alpha(gateway: Gateway) -> None:
    query: dict[str, str | int] = {**SMALL, "preset": "ruby", "background": "transparent", "samples": 1}
    alphas = []
    for ending, mode in (("png", "RGBA"), ("webp", "RGBA"), ("jpg", "RGB")):
        answer = await gateway.http.get(f"/api/render.{ending}", params=query)
        assert answer.status_code == 200, answer.text
        image = Image.open(io.BytesIO(answer.content))
        assert (image.mode, image.size) == (mode, (64, 36))
        alphas.append(image.getextrema()[-1])
    assert alphas[0] == alphas[1] == (0, 255)
    brand = await gateway.http.get("/api/render.png", params=query | {"background": "f4f1ea"})
    assert Image.open(io.BytesIO(brand.content)).convert("RGB").getpixel((0, 0)) == (0xF4, 0xF1, 0xEA)
    assert_problem(await gateway.http.get("/api/render.png", params=query | {"background": "blue"}), 422, "background")
    session = await gateway.session({"film": {"background": "transparent"}})
    frame = await gateway.http.get(f"/api/sessions/{session}/frame.png", params=SMALL | {"samples": 1})
    assert Image.open(io.BytesIO(frame.content)).mode == "RGBA"


async def test_generated_clients_get_names_that_can_be_read(gateway: Gateway) -> None:
    paths = (await gateway.http.get("/openapi.json")).json()["paths"]
    names = [operation["operationId"] for operations in paths.values() for operation in operations.values()]
    assert len(set(names)) == len(names)
    assert {"render_png", "frame_exr", "create_session", "post_event", "upload_mesh"} <= set(names)
    assert [name for name in names if "api" in name] == []


async def test_sessions_are_capped(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, max_sessions=2) as gateway:
        sessions = [await gateway.session() for _ in range(2)]
        refused = await gateway.http.post("/api/sessions")
        assert_problem(refused, 429)
        assert refused.headers["retry-after"]
        await gateway.http.delete(f"/api/sessions/{sessions[0]}")
        await gateway.session()


async def test_sessions_that_nobody_uses_expire(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, session_idle_seconds=2) as gateway:
        idle, watched = await gateway.session(), await gateway.session()
        async with gateway.viewer(watched) as viewer:  # long before it would expire
            await viewer.frame()

            async def one_left() -> bool:
                return len(gateway.parts.sessions) == 1

            await eventually(one_left)
            assert_problem(await gateway.http.get(f"/api/sessions/{idle}"), 404)
            assert (await gateway.http.get(f"/api/sessions/{watched}")).status_code == 200


async def test_a_session_about_which_somebody_waits_for_an_answer_does_not_expire(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Grades and their tilt curves may take longer than a session that nobody watches is kept."""
    request, answered = Uploads.request, asyncio.Event()

    async def late(uploads: Uploads, message: Message, *arguments: Any, **options: Any) -> Any:  # noqa: ANN401
        if isinstance(message, Grade):
            await answered.wait()
        return await request(uploads, message, *arguments, **options)

    monkeypatch.setattr(Uploads, "request", late)
    async with gateway_before(engine, web=tmp_path, unwatched_session_seconds=2) as gateway:
        asked = await gateway.session()
        answer = asyncio.create_task(gateway.http.get(f"/api/sessions/{asked}/grade", params={"stone": "nobody's"}))
        await gateway.session()

        async def one_left() -> bool:
            return len(gateway.parts.sessions) == 1

        async def none_left() -> bool:
            return len(gateway.parts.sessions) == 0

        await eventually(one_left)
        assert asked in gateway.parts.sessions
        answered.set()
        assert_problem(await answer, 422, "stone")
        await eventually(none_left)


async def test_a_session_that_only_a_native_viewer_watches_does_not_expire(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, session_idle_seconds=10) as gateway:
        idle, watched = await gateway.session(), await gateway.session()
        with FrameSubscription(engine.frames, watch_id(watched)) as subscription:
            await asyncio.to_thread(subscription.receive, PATIENCE)

            async def one_left() -> bool:
                return len(gateway.parts.sessions) == 1

            await eventually(one_left)
            shown = await asyncio.to_thread(subscription.receive, PATIENCE)
            assert shown.watch.hex() == watch_id(watched)
            assert (await gateway.http.get(f"/api/sessions/{watched}")).status_code == 200
            assert_problem(await gateway.http.get(f"/api/sessions/{idle}"), 404)

        async def none_left() -> bool:
            return len(gateway.parts.sessions) == 0

        await eventually(none_left)


async def test_a_still_whose_client_left_is_not_rendered(gateway: Gateway) -> None:
    large = {"scene": {"sampling": {"samples_per_pixel": 4096}}, "width": 1920, "height": 1080}  # minutes
    with pytest.raises(httpx.ReadTimeout):
        await gateway.http.post("/api/render", json=large, timeout=httpx.Timeout(PATIENCE, read=0.5))

    async def none_waits() -> bool:
        return (await gateway.engine_status())["stills_waiting"] == 0

    await eventually(none_waits)
    small = await gateway.http.post("/api/render", json=TINY)
    assert small.status_code == 200

    async def given_up() -> bool:
        return 'culet_http_answers_total{status="499"} 1' in (await gateway.http.get("/metrics")).text

    await eventually(given_up)


async def test_too_many_stills_at_once_are_refused(gateway: Gateway) -> None:
    body = {"scene": {"sampling": {"samples_per_pixel": 12}}, "width": 320, "height": 180}
    answers = await asyncio.gather(*(gateway.http.post("/api/render", json=body) for _ in range(24)))
    statuses = [answer.status_code for answer in answers]
    assert set(statuses) == {200, 429}
    assert_problem(answers[statuses.index(429)], 429)


async def test_a_body_over_the_limit_is_refused_whether_it_says_its_length_or_not(
    engine: Endpoints, tmp_path: Path
) -> None:
    async def chunks() -> Any:  # noqa: ANN401
        for _ in range(4):
            yield b" " * 1000

    async with gateway_before(engine, web=tmp_path, max_body_bytes=2000) as gateway:
        assert_problem(await gateway.http.post("/api/render", content=b" " * 4000, headers=JSON), 413)
        assert_problem(await gateway.http.post("/api/render", content=chunks(), headers=JSON), 413)


async def test_other_pages_may_read_but_not_change(gateway: Gateway) -> None:
    headers = {"Origin": FOREIGN}
    assert (await gateway.http.get("/api/cuts", headers=headers)).status_code == 200
    assert_problem(await gateway.http.post("/api/sessions", headers=headers), 403)


async def test_an_unknown_path_is_a_problem_too(gateway: Gateway) -> None:
    assert_problem(await gateway.http.get("/api/nothing"), 404)


async def test_a_picture_is_refined_to_the_error_asked_for_and_says_so(gateway: Gateway) -> None:
    path = f"/api/sessions/{await gateway.session()}/frame.png"
    query: dict[str, str | int | float] = {**SMALL, "error": 0.02}
    answers = [
        await gateway.http.get("/api/render.png", params=query),
        await gateway.http.post("/api/render", json=query),
        await gateway.http.get(path, params=query),
    ]
    for answer in answers:
        assert answer.headers["culet-target"] == "met"
        assert 0.01 < float(answer.headers["culet-error"]) <= 0.02
        assert 2 < int(answer.headers["culet-samples"]) < 100  # measured 11
    limited = await gateway.http.get("/api/render.png", params=query | {"samples": 2})
    assert (limited.headers["culet-samples"], limited.headers["culet-target"]) == ("2", "missed")
    assert "etag" not in limited.headers, "with more time it might be another"
    plain = await gateway.http.get("/api/render.png", params=SMALL | {"samples": 1})
    assert plain.headers["culet-samples"] == "1"
    assert {"culet-error", "culet-target"}.isdisjoint(plain.headers)
    for error in (0, -1, 1.5, "much"):
        assert_problem(await gateway.http.get("/api/render.png", params={"error": error}), 422, "error")

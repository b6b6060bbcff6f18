"""Health, metrics, the documentation and the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from culet.gateway.settings import GatewaySettings, look_for_page
from culet_protocol.messages import Orbit
from gateway.running import Endpoints, Gateway, eventually, gateway_before


async def test_with_an_engine_the_gateway_is_healthy_and_ready(gateway: Gateway) -> None:
    assert (await gateway.http.get("/healthz")).json() == {"status": "ok"}
    assert (await gateway.http.get("/readyz")).json() == {"status": "ready"}


async def test_metrics_are_prometheus_text_without_a_label_that_grows(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.frame()
        await viewer.say(Orbit(yaw=0.3, pitch=0))  # no frame was due before the first, which counts no wait

        async def waited() -> bool:
            return (await gateway.engine_status()).get("frame_wait_seconds_count", 0) >= 1

        await eventually(waited)
        answer = await gateway.http.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
    line = re.compile(r'(# (HELP|TYPE) \w+ .+|\w+(\{(status|code|le)="[\w.+-]+"\})? -?[0-9.e+-]+)')
    assert [text for text in answer.text.splitlines() if not line.fullmatch(text)] == []
    assert session not in answer.text
    for expected in ("culet_engine_up 1.0", "culet_sessions 1.0", "culet_viewers 1.0"):
        assert f"\n{expected}\n" in answer.text
    assert (await gateway.engine_status())["frames_rendered"] >= 1
    for name in ("culet_engine_frame_seconds", "culet_engine_frame_wait_seconds", "culet_http_answer_seconds"):
        assert f"# TYPE {name} histogram\n" in answer.text
        assert re.search(rf'^{name}_bucket{{le="\+Inf"}} [1-9]', answer.text, re.MULTILINE)


async def test_the_documentation_lists_every_route(gateway: Gateway) -> None:
    paths = (await gateway.http.get("/openapi.json")).json()["paths"]
    session = "/api/sessions/{session_id}"
    for path in ("/api/render.tga", "/api/render", "/api/presets", "/api/materials", "/api/cuts"):
        assert path in paths
    for path in ("/api/meshes", "/api/skies"):
        assert "post" in paths[path]
    for path in ("/api/sessions", session, f"{session}/frame.tga", f"{session}/frame.png"):
        assert path in paths
    for path in ("/healthz", "/readyz", "/metrics"):
        assert path in paths


async def test_the_documentation_requires_the_field_that_tells_forms_apart(gateway: Gateway) -> None:
    schemas = (await gateway.http.get("/openapi.json")).json()["components"]["schemas"]
    for name, field in (("Orbit", "type"), ("ToggleFall", "type"), ("StudioEnvironment", "kind")):
        assert field in schemas[name]["required"]
    session = await gateway.session()
    without = await gateway.http.post(f"/api/sessions/{session}/events", json={"yaw": 1, "pitch": 0})
    assert without.status_code == 422


async def test_every_example_in_the_documentation_runs(gateway: Gateway) -> None:
    document = (await gateway.http.get("/openapi.json")).json()
    session, ran = await gateway.session(), 0
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            content = operation.get("requestBody", {}).get("content", {}).get("application/json")
            if content is None:
                continue
            schema = content["schema"]
            reference = schema.get("$ref") or next((s["$ref"] for s in schema.get("anyOf", []) if "$ref" in s), None)
            if reference:
                schema = document["components"]["schemas"][reference.rpartition("/")[2]]
            for example in schema["examples"]:
                answer = await gateway.http.request(method, path.replace("{session_id}", session), json=example)
                assert answer.status_code in (200, 201, 202), (path, answer.text)
                ran += 1
    assert ran == 13


def test_a_server_without_a_page_says_so_when_it_starts(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    found = GatewaySettings.model_construct(_fields_set=set(), web=tmp_path)  # where a page is looked for by itself
    look_for_page(found)
    (said,) = caplog.messages
    assert said.startswith(f"there is no page to serve, only the REST interface: expected {tmp_path}/index.html")
    assert "make wheel" in said
    caplog.clear()
    (tmp_path / "index.html").touch()
    look_for_page(found)
    assert caplog.messages == []


async def test_the_page_is_served_or_its_absence_explained(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path) as gateway:
        answer = await gateway.http.get("/")
        assert (answer.status_code, "without its page" in answer.text) == (404, True)
    (tmp_path / "index.html").write_text("<h1>the page</h1>")
    async with gateway_before(engine, web=tmp_path) as gateway:
        assert (await gateway.http.get("/")).text == "<h1>the page</h1>"
        assert (await gateway.http.get("/healthz")).status_code == 200
        assert (await gateway.http.get("/../../etc/passwd")).status_code == 404

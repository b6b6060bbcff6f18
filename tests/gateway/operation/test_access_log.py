"""What the gateway says of its requests and streams: who, what, how it ended, and no session's id."""

from __future__ import annotations

import asyncio
import json
import logging

import httpx
import pytest
from websockets.asyncio.client import connect

from culet import logs
from culet.gateway.operation.metrics import EngineStatus
from gateway.running import FOREIGN, Gateway, eventually, gateway_alone


def lines(caplog: pytest.LogCaptureFixture) -> list[str]:
    """Of the access log."""
    return [record.getMessage() for record in caplog.records if record.name == "culet.access"]


async def logged(caplog: pytest.LogCaptureFixture, *words: str) -> str:
    """The first line with these words, once there is one."""

    async def found() -> list[str]:
        return [line for line in lines(caplog) if all(word in line for word in words)]

    await eventually(found)
    return (await found())[0]


async def test_each_answer_and_stream_is_a_line_without_the_sessions_id(
    gateway: Gateway, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    session = await gateway.session()
    await gateway.http.get(f"/api/sessions/{session}")
    assert await logged(caplog, "127.0.0.1 POST /api/sessions 201, ")
    assert await logged(caplog, f"127.0.0.1 GET /api/sessions/{session[:6]}... 200, ")
    async with gateway.viewer(session) as viewer:
        await viewer.frame()
    assert await logged(caplog, f"WS /api/sessions/{session[:6]}.../stream opened")
    assert await logged(caplog, f"WS /api/sessions/{session[:6]}.../stream closed after", "1000 by the viewer")
    assert not any(session in line for line in lines(caplog))


async def test_refused_viewers_appear_with_the_reason(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    async with gateway_alone() as gateway:
        url = gateway.url.replace("http", "ws", 1) + "api/sessions/x/stream"
        async with connect(url, origin=FOREIGN):
            assert await logged(caplog, "closed", "4403 pages of http://elsewhere.example may not open streams here")
        async with connect(url):
            assert await logged(caplog, "closed", "4404 no such session")
        text = (await gateway.http.get("/metrics")).text
        assert 'culet_streams_closed_total{code="4403"} 1.0\n' in text


async def test_an_upload_that_its_sender_breaks_off_is_one_line(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    async with gateway_alone() as gateway:
        url = httpx.URL(gateway.url)
        fields = "Host: localhost\r\nContent-Type: multipart/form-data; boundary=a\r\nContent-Length: 1000"
        for path in ("/api/meshes", "/api/sessions"):
            _, writer = await asyncio.open_connection(url.host, url.port)
            writer.write(f"POST {path} HTTP/1.1\r\n{fields}\r\n\r\n--a\r\n".encode())
            await writer.drain()
            await asyncio.sleep(0)
            writer.close()
        assert await logged(caplog, "POST /api/meshes 499")
        assert await logged(caplog, "POST /api/sessions")
        assert "Traceback" not in caplog.text


async def test_what_comes_in_a_request_cannot_make_a_line_of_its_own(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    async with gateway_alone() as gateway:
        await gateway.http.get("/a%0ab?c=%0d%0a")
        assert "GET /a%0ab?c=%0d%0a 404" in await logged(caplog, "/a")


def test_a_line_of_json_has_the_fields_that_the_text_has(capsys: pytest.CaptureFixture[str]) -> None:
    before = logging.getLogger().handlers[:], logging.getLogger().level
    try:
        logs.configure("info", "json")
        logging.getLogger("culet.access").info("%(status)d", {"status": 404}, extra={logs.FIELDS: {"status": 404}})
        logging.getLogger("culet.access").debug("not told")
        try:
            raise ValueError("a\nb")
        except ValueError:
            logging.getLogger("culet").exception("failed")
        first, second = map(json.loads, capsys.readouterr().err.splitlines())
        assert first.pop("time").endswith("Z")
        assert first == {"level": "info", "logger": "culet.access", "message": "404", "status": 404}
        assert "ValueError: a\nb" in second["exception"]
        logs.configure("warning", "text")
        logging.getLogger("culet").warning("told")
        logging.getLogger("culet").info("not told")
        (line,) = capsys.readouterr().err.splitlines()
        assert line.endswith("Z WARNING culet: told")
    finally:
        logging.getLogger().handlers[:], level = before
        logging.getLogger().setLevel(level)


def test_a_histogram_of_the_engine_is_one_of_prometheus() -> None:
    seconds = {"bounds": [0.1, 1], "counts": [2, 3, 1], "sum": 4.5}
    status = {"frames": 3, "frame_seconds": seconds, "device": {"name": "x"}}
    gauge_of = {family.name: family for family in EngineStatus(status).collect()}
    assert set(gauge_of) == {"culet_engine_frames", "culet_engine_frame_seconds"}
    samples = {(s.name, s.labels.get("le")): s.value for s in gauge_of["culet_engine_frame_seconds"].samples}
    name = "culet_engine_frame_seconds"
    assert samples[f"{name}_bucket", "0.1"] == 2
    assert samples[f"{name}_bucket", "1"] == 5
    assert samples[f"{name}_bucket", "+Inf"] == 6
    assert (samples[f"{name}_count", None], samples[f"{name}_sum", None]) == (6, 4.5)

"""Whatever comes as body, header, query, path or method, no answer is 500, and each refusal says why."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from gateway.running import Gateway, gateway_alone

JSON = {"content-type": "application/json"}
BODIES = [
    b"", b"{", b"{}", b"[]", b"null", b"\xff\xfe", b"\0", b"\xef\xbb\xbf{}",
    '{"preset": "\N{SNOWFLAKE}"}'.encode("utf-16"),
    b'"\\ud800"', b'{"\\ud800": 1}', b'{"scene": {"\\ud800": 1}}', b'{"preset": "\\ud800"}',
    b'{"floor": {"kind": "\\ud800"}}',
    b'{"scene": {"stones": [{"mesh": "\\ud800"}]}}', b'{"floor": "\\ud800"}',
    b'{"type": "patch_scene", "patch": {"a": "\\udfff"}}', b'{"type": "set_scene", "scene": {"\\ud800": 1e999}}',
    b'{"scene": {"camera": {"fov_degrees": NaN}}}', b'{"type": "patch_scene", "patch": 1e400}',
    b"[" * 100_000, b'{"a": ' * 50_000,
    b'{"scene": {"camera": {"fov_degrees": ' + b"9" * 400 + b"}}}", b'{"width": ' + b"9" * 400 + b"}",
    b'{"scene": {"camera": {"fov_degrees": ' + b"9" * 5000 + b"}}}",
    b'{"scene": {"simulation": {"seed": ' + b"9" * 300 + b"}}}",
    b'--a\r\nContent-Disposition: form-data; name="file"; filename="\xff\xfe.\xed\xa0\x80obj"\r\n\r\nx\r\n--a--',
]  # fmt: skip
TAKING = [("POST", "/api/render"), ("POST", "/api/sessions"), ("PATCH", "/api/sessions/x"),
          ("POST", "/api/sessions/x/events"), ("POST", "/api/meshes"), ("POST", "/api/skies")]  # fmt: skip
HEADERS: list[dict[str, Any]] = [
    {"content-type": "text/plain"}, {"content-type": b"application/json; charset=\xff"},
    {"content-type": b"multipart/form-data; boundary=\xff"},
    {"content-type": "multipart/form-data; boundary*=utf-8''%ff"},
    {"origin": "http://["}, {"origin": b"\xff"}, {"origin": "null", "access-control-request-method": "\x7f"},
    {"range": "bytes=5-1"}, {"range": "bytes=,,-"}, {"range": "bytes=-9" + "9" * 30},
    {"range": "bytes=" + "0-1," * 2000},
    {"if-modified-since": "Mon, 99 Foo 99999 99:99:99 GMT"}, {"if-none-match": "*"}, {"accept-encoding": b"\xff"},
    {"x-forwarded-for": "\x7f,,"}, {"sec-fetch-site": "cross-site"}, {"host": "localhost:99999999"}, {"host": "["},
    {"host": "x" * 5000},
    {"connection": "upgrade", "upgrade": "websocket"}, {"connection": "upgrade", "upgrade": "h2c"},
]  # fmt: skip
PATHS = ["/", "/page.js", "/docs", "/docs/..%2f..", "/%00", "/%ff", "//evil", "/..", "/page.js/b",
         "/" + "c" * 5000,
         "/api/presets", "/api/sessions/%ed%a0%80", "/api/sessions/x/frame.png", "/api/render.tga"]  # fmt: skip
QUERIES = ["width=%ff", "width=nan", "width=" + "9" * 5000, "preset=%ed%a0%80", "samples=%00", "&&&==",
           "step=9" + "9" * 20,
           "width=1&width=2"]  # fmt: skip


def requests() -> Iterator[tuple[str, str, dict[str, Any], bytes]]:
    """Method, target, headers, body."""
    for (method, path), body in itertools.product(TAKING, BODIES):
        yield method, path, JSON, body
    for headers, path in itertools.product(HEADERS, ("/page.js", "/docs", "/api/sessions")):
        yield "GET", path, headers, b""
        yield "POST", path, headers, b"{}"
    for path in PATHS:
        for method in ("GET", "HEAD", "OPTIONS", "BREW"):
            yield method, path, {}, b""
    for path, query in itertools.product(("/api/render.tga", "/api/sessions/x/frame.png", "/"), QUERIES):
        yield "GET", f"{path}?{query}", {}, b""


async def test_no_answer_is_500_and_each_refusal_is_a_problem_document(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "index.html").write_text("<!doctype html>")
    (tmp_path / "page.js").write_text("0;" * 50)
    async with gateway_alone(web=tmp_path, client_messages_per_second=1e9) as gateway:
        for method, target, headers, body in requests():
            answer = await gateway.http.request(method, target, headers=headers, content=body)
            asked = f"{method} {target[:60]} {headers} {body[:60]!r}: {answer.status_code} {answer.text[:100]}"
            assert answer.status_code not in (500, 501), asked
            if answer.status_code >= 400 and method != "HEAD" and "range" not in headers:
                assert answer.headers["content-type"] == "application/problem+json", asked
                assert answer.json()["detail"], asked
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize(
    ("headers", "body", "status", "said"),
    [
        ({}, b"{}", 415, "expected Content-Type: application/json, got none"),
        ({"content-type": "text/plain"}, b"{}", 415, "expected Content-Type: application/json, got text/plain"),
        (JSON, b"{", 422, "the body is not JSON"),
        (JSON, b"\xff{}", 422, "the body is not JSON: byte 0 is not UTF-8"),
        (JSON, b"[" * 100_000, 422, "the body is not JSON: expected at most 32 levels of nesting"),
        (JSON, b'{"floor": "\\ud800"}', 422, "floor: expected text, got half a surrogate pair"),
        (JSON, b'{"floor": {"\\ud800": 1}}', 422, "floor: expected text, got half a surrogate pair"),
    ],
)
async def test_a_body_that_cannot_be_read_is_told_why(
    gateway: Gateway, headers: dict[str, str], body: bytes, status: int, said: str
) -> None:
    session = await gateway.session()
    answer = await gateway.http.patch(f"/api/sessions/{session}", content=body, headers=headers)
    assert answer.status_code == status
    assert said in answer.json()["detail"]

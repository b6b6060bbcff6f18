"""What may come in, on a real server: by host, by page, by method, by size; and what each answer tells browsers."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from culet.gateway.admission.admission import BodyBytes
from gateway.running import FOREIGN, Gateway, gateway_alone
from shared.patience import PATIENCE

SHOP = "https://shop.example"


@pytest.fixture
async def alone() -> AsyncIterator[Gateway]:
    """A web server without an engine: what is let in gets 404, 422 or 503."""
    async with gateway_alone() as gateway:
        yield gateway


async def test_a_page_of_another_name_that_leads_here_gets_nothing(alone: Gateway) -> None:
    """DNS rebinding: for the browser, Origin and Host are one."""
    name = "rebind.evil.example"
    headers = {"Host": name, "Origin": f"http://{name}"}
    answer = await alone.http.get("/api/presets", headers=headers)
    assert (answer.status_code, name in answer.json()["detail"]) == (421, True)
    assert (await alone.http.post("/api/sessions", headers=headers, json={})).status_code == 421
    url = httpx.URL(alone.url)
    with pytest.raises(InvalidStatus) as refused:
        async with connect(f"ws://{name}/api/sessions/x/stream", host=url.host, port=url.port):
            pass
    assert refused.value.response.status_code == 421
    async with gateway_alone(allow_host=(name,)) as known:
        assert (await known.http.get("/api/presets", headers=headers)).status_code == 200


@pytest.mark.parametrize("path", ["/api/render.tga", "/api/sessions/x/frame.tga", "/api/sessions/x/frame.png"])
async def test_pages_of_other_sites_cannot_make_their_visitors_render(alone: Gateway, path: str) -> None:
    cross_site = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "image"}
    for method in ("GET", "HEAD"):
        assert (await alone.http.request(method, path, headers=cross_site)).status_code == 403
    for site in ("same-origin", "none"):
        assert (await alone.http.get(path, headers={"Sec-Fetch-Site": site})).status_code in (404, 503)
    assert (await alone.http.get("/", headers=cross_site)).status_code != 403, "a link to the page itself is followed"
    async with gateway_alone(allow_embedding=True) as shown:
        answer = await shown.http.get(path, headers=cross_site)
        assert answer.status_code in (404, 503)
        assert answer.headers["Cross-Origin-Resource-Policy"] == "cross-origin"


async def test_caches_that_many_share_are_told_what_a_picture_depends_on() -> None:
    """Or a page would be shown what is refused to that page, or refused what another was shown."""
    origin = "https://shop.example"
    for settings, varies in (
        ({}, "Sec-Fetch-Site"),
        ({"allow_origin": (origin,)}, "Sec-Fetch-Site, Origin"),
        ({"allow_embedding": True}, None),
    ):
        async with gateway_alone(**settings) as asked:
            for headers in ({}, {"Sec-Fetch-Site": "cross-site"}):
                answer = await asked.http.get("/api/render.png", headers=headers)
                assert answer.headers.get("Vary") == varies, settings
            assert "Sec-Fetch-Site" not in (await asked.http.get("/api/presets")).headers.get("Vary", "")


async def test_every_answer_tells_browsers_to_be_careful(alone: Gateway) -> None:
    for path in ("/healthz", "/docs", "/docs/", "/api/presets", "/nowhere", "/", "/metrics"):
        check_careful((await alone.http.get(path)).headers)


def check_careful(headers: httpx.Headers) -> None:
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["X-Frame-Options"] == "SAMEORIGIN"
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'self'" in policy
    assert "unsafe" not in policy
    assert "Server" not in headers


async def test_a_shop_may_show_the_page_in_a_frame_if_it_is_told_so() -> None:
    async with gateway_alone(frame_ancestor=(SHOP,)) as gateway:
        headers = (await gateway.http.get("/docs")).headers
        assert f"frame-ancestors 'self' {SHOP}" in headers["Content-Security-Policy"]
        assert "X-Frame-Options" not in headers


async def test_the_documentation_has_no_code_within_it_and_all_beside_it(alone: Gateway) -> None:
    page = (await alone.http.get("/docs/")).text
    assert "<style" not in page
    assert "</script>" not in page.replace("></script>", "")
    parts = re.findall(r'(?:src|href)="((?!data:)[^"]+)"', page)
    assert {part.rpartition(".")[2] for part in parts} == {"js", "css"}
    for part in parts:
        assert part.startswith("../assets/"), "relative: a proxy may have the server in a folder"
        assert (await alone.http.get(part.removeprefix(".."))).status_code == 200


async def test_the_documentation_is_found_without_a_slash_too_wherever_a_proxy_has_it(alone: Gateway) -> None:
    answer = await alone.http.get("/docs")
    assert (answer.status_code, answer.headers["location"]) == (308, "docs/")


async def test_an_allowed_page_uses_the_rest_interface_and_others_do_not() -> None:
    async with gateway_alone(allow_origin=(SHOP,)) as gateway:
        asked = {
            "Access-Control-Request-Method": "PATCH",
            "Access-Control-Request-Headers": "authorization,content-type",
        }
        preflight = await gateway.http.options("/api/sessions/x", headers={"Origin": SHOP, **asked})
        assert preflight.status_code == 200
        assert preflight.headers["Access-Control-Allow-Origin"] == SHOP
        assert "PATCH" in preflight.headers["Access-Control-Allow-Methods"]
        assert "Authorization" in preflight.headers["Access-Control-Allow-Headers"]
        made = await gateway.http.post("/api/sessions", json={}, headers={"Origin": SHOP})
        assert made.status_code == 503, "there is no engine"
        assert made.headers["Access-Control-Allow-Origin"] == SHOP
        assert "Retry-After" in made.headers["Access-Control-Expose-Headers"]
        picture = await gateway.http.get("/api/render.tga", headers={"Origin": SHOP, "Sec-Fetch-Site": "cross-site"})
        assert picture.status_code == 503
        other = await gateway.http.options("/api/sessions/x", headers={"Origin": FOREIGN, **asked})
        assert other.status_code == 400
        assert "Access-Control-Allow-Origin" not in other.headers
        assert (await gateway.http.post("/api/sessions", json={}, headers={"Origin": FOREIGN})).status_code == 403


TAKEN = {
    "/healthz": "GET, HEAD, OPTIONS",
    "/docs": "GET, HEAD, OPTIONS",
    "/docs/": "GET, HEAD, OPTIONS",
    "/openapi.json": "GET, HEAD, OPTIONS",
    "/api/render": "OPTIONS, POST",
    "/api/sessions": "GET, HEAD, OPTIONS, POST",
    "/api/sessions/x": "DELETE, GET, HEAD, OPTIONS, PATCH, PUT",
    "/api/sessions/x/events": "OPTIONS, POST",
    "/api/meshes": "OPTIONS, POST",
    "/api/sessions/x/skies": "OPTIONS, POST",
    "/nowhere": "GET, HEAD, OPTIONS",
}


async def test_each_path_says_what_it_takes(tmp_path: Path) -> None:
    """Also where a page is served at `/`, which answers for whatever nobody else does."""
    (tmp_path / "index.html").write_text("<!doctype html>")
    async with gateway_alone(web=tmp_path) as gateway:
        for path, allowed in TAKEN.items():
            answer = await gateway.http.options(path)
            assert (answer.status_code, answer.headers["Allow"]) == (204, allowed)
            for method in {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "TRACE", "BREW"} - set(allowed.split(", ")):
                answer = await gateway.http.request(method, path)
                assert (answer.status_code, answer.headers["Allow"]) == (405, allowed)


async def test_head_is_get_without_the_body(alone: Gateway) -> None:
    for path in ("/", "/healthz", "/docs", "/api/presets", "/api/sessions/x", "/nowhere"):
        get, head = await alone.http.get(path), await alone.http.head(path)
        assert head.status_code == get.status_code
        assert head.content == b""
        for name in ("content-type", "content-length", "content-security-policy"):
            assert head.headers.get(name) == get.headers.get(name)


@pytest.mark.parametrize("path", ["/api/sessions", "/api/meshes"])
async def test_an_announced_length_over_the_limit_is_refused_before_anything_is_read(path: str) -> None:
    async with gateway_alone(max_upload_bytes=100_000) as gateway:
        url = httpx.URL(gateway.url)
        reader, writer = await asyncio.open_connection(url.host, url.port)
        writer.write(f"POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999999999\r\n\r\n".encode())
        async with asyncio.timeout(PATIENCE):
            assert b" 413 " in await reader.readline()
        writer.close()


async def test_a_body_of_two_lengths_is_refused(alone: Gateway) -> None:
    """Two servers in a row that believe different ones take a part of a body for a request."""
    headers = {"Content-Length": "2", "Transfer-Encoding": "chunked"}
    assert (await alone.http.post("/api/sessions", content=b"{}", headers=headers)).status_code == 400


async def test_bodies_under_way_are_bounded_for_each_client_and_in_all() -> None:
    bodies = BodyBytes(100, 60)
    assert bodies.room_for("a", 60)
    bodies.take("a", 50)
    assert not bodies.room_for("a", 11)
    assert bodies.room_for("b", 50)
    assert not bodies.room_for("b", 51)
    bodies.give_back("a", 50)
    assert bodies.room_for("a", 60)
    async with gateway_alone(max_client_bodies_bytes=1000) as gateway:
        answer = await gateway.http.post("/api/sessions", content=b"x" * 2000)
        assert (answer.status_code, "Retry-After" in answer.headers) == (429, True)

        async def pieces() -> AsyncIterator[bytes]:
            for _ in range(4):
                yield b"x" * 500

        assert (await gateway.http.post("/api/sessions", content=pieces())).status_code == 429
        padded = b"{}" + b" " * 600
        for _ in range(3):  # each gives back what it took
            made = await gateway.http.post(
                "/api/sessions", content=padded, headers={"Content-Type": "application/json"}
            )
            assert made.status_code == 503, "there is no engine"

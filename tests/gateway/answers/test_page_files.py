"""What the built page's files are served with."""

from __future__ import annotations

import gzip
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from gateway.running import Gateway, gateway_alone

SCRIPT = "export const facets = 57;\n" * 100


@pytest.fixture
async def page(tmp_path: Path) -> AsyncIterator[Gateway]:
    for name in ("assets/index-1a2b3c.js", "element/culet-viewer.js", "index.html"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(SCRIPT)
    (tmp_path / "assets" / "small-1a2b3c.js").write_text("1;")
    async with gateway_alone(web=tmp_path) as gateway:
        yield gateway


async def test_a_script_is_compressed_for_whoever_takes_that(page: Gateway) -> None:
    path = "/assets/index-1a2b3c.js"
    async with page.http.stream("GET", path, headers={"Accept-Encoding": "br, gzip;q=0.8"}) as answer:
        raw = b"".join([part async for part in answer.aiter_raw()])
    assert answer.headers["Content-Encoding"] == "gzip"
    assert gzip.decompress(raw).decode() == SCRIPT
    assert int(answer.headers["Content-Length"]) == len(raw) < len(SCRIPT) / 10
    assert answer.headers["Content-Type"].startswith("text/javascript")
    for takes in ("identity", "gzip;q=0", "br"):
        plain = await page.http.get(path, headers={"Accept-Encoding": takes})
        assert "Content-Encoding" not in plain.headers
        assert plain.text == SCRIPT
        assert plain.headers["Vary"] == "Accept-Encoding"
    part = await page.http.get(path, headers={"Range": "bytes=0-5"})
    assert (part.status_code, part.text) == (206, SCRIPT[:6])
    head = await page.http.head(path)
    assert (head.status_code, head.content) == (200, b"")
    assert "Content-Encoding" not in (await page.http.get("/assets/small-1a2b3c.js")).headers


async def test_files_named_by_their_content_are_kept_and_others_are_asked_for_again(page: Gateway) -> None:
    assert "immutable" in (await page.http.get("/assets/index-1a2b3c.js")).headers["Cache-Control"]
    for path in ("/", "/element/culet-viewer.js"):
        first = await page.http.get(path)
        assert first.headers["Cache-Control"] == "no-cache"
        again = await page.http.get(path, headers={"If-None-Match": first.headers["ETag"]})
        assert (again.status_code, again.content) == (304, b"")
        assert "Content-Security-Policy" not in again.headers, "which would take the place of the page's own"


async def test_the_element_alone_may_be_loaded_by_pages_of_other_sites(page: Gateway) -> None:
    element = (await page.http.get("/element/culet-viewer.js", headers={"Origin": "https://shop.example"})).headers
    assert element["Access-Control-Allow-Origin"] == "*"
    assert element["Cross-Origin-Resource-Policy"] == "cross-origin"
    for path in ("/", "/assets/index-1a2b3c.js"):
        headers = (await page.http.get(path, headers={"Origin": "https://shop.example"})).headers
        assert "Access-Control-Allow-Origin" not in headers
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert "default-src 'none'" in (await page.http.get("/")).headers["Content-Security-Policy"]

"""A server that a proxy shows in a folder of its site."""

from __future__ import annotations

from pathlib import Path

import pytest

from culet.gateway.identity.paths import reference
from culet.gateway.settings import GatewaySettings
from gateway.running import Endpoints, gateway_alone, gateway_before

TOKEN = "a-token-of-these-tests"  # noqa: S105 - of these tests alone


@pytest.mark.parametrize(
    ("asked", "path", "expected"),
    [
        ("/api/sessions", "/api/sessions/ab", "sessions/ab"),
        ("/api/sessions/ab", "/api/sessions/ab/stream", "ab/stream"),
        ("/api/sessions/ab/events", "/api/sessions/ab/stream", "stream"),
    ],
)
def test_what_an_answer_refers_to_is_relative_to_what_was_asked(asked: str, path: str, expected: str) -> None:
    """As RFC 3986 resolves it, in any folder."""
    assert reference(asked, path) == expected


async def test_requests_come_with_the_folder_or_without(engine: Endpoints, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("<h1>the page</h1>")
    async with gateway_before(engine, web=tmp_path, root_path="/gems", token=TOKEN) as gateway:
        for base in ("", "/gems"):
            assert (await gateway.http.get(f"{base}/")).text == "<h1>the page</h1>"
            assert (await gateway.http.get(f"{base}/readyz")).status_code == 200
            assert (await gateway.http.post(f"{base}/api/sessions")).status_code == 401, "the gate is not gone around"
            made = await gateway.http.post(f"{base}/api/sessions", headers={"Authorization": f"Bearer {TOKEN}"})
            session = made.url.join(made.headers["Location"])
            assert session.path == f"{base}/api/sessions/{made.json()['id']}"
            assert (await gateway.http.get(session)).status_code == 200
            async with gateway.viewer("", path=made.url.join(made.json()["stream"]).path.lstrip("/")) as viewer:
                await viewer.notice("hello")
        assert (await gateway.http.get("/gemstones/readyz")).status_code == 404, "another folder"
        kept = await gateway.http.post("/gems/api/login", headers={"Authorization": f"Bearer {TOKEN}"})
        assert "Path=/gems/;" in kept.headers["set-cookie"], "the rest of the site may be others' servers"


async def test_a_folder_without_its_slash_leads_to_the_page() -> None:
    async with gateway_alone(root_path="/user/ada/gems") as gateway:
        answer = await gateway.http.get("/user/ada/gems?preset=matte")
        assert answer.status_code == 308
        assert answer.url.join(answer.headers["location"]).raw_path == b"/user/ada/gems/?preset=matte"


@pytest.mark.parametrize("folder", ["gems", "/a//b", "/a b", "/../etc", "/ä", "https://gems.example/"])
def test_what_is_no_folder_is_refused(folder: str) -> None:
    with pytest.raises(ValueError, match="expected a folder such as /gems"):
        GatewaySettings(control="ipc://unused", frames="ipc://unused", root_path=folder)


def test_a_folder_may_be_named_with_its_slash() -> None:
    settings = GatewaySettings(control="ipc://unused", frames="ipc://unused", root_path="/user/ada/gems/")
    assert settings.root_path == "/user/ada/gems"

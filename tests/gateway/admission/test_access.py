"""Who may do what: the server's token, and the two links of a session."""

from __future__ import annotations

import asyncio
import io
import json
import runpy
import socket
from pathlib import Path
from typing import cast
from urllib.parse import urlsplit

import httpx
import numpy as np
import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from culet.errors import InputError, NotFoundError
from culet.gateway.admission.access import NOTHING, Right, needed
from culet.gateway.answers.openapi import Application
from culet.gateway.app import create_app
from culet.gateway.identity.address import entrance
from culet.gateway.identity.server_token import PATTERN, Token, is_own_machine
from culet.gateway.settings import GatewaySettings, settings_of, with_token
from culet.gateway.token_file import token_kept
from culet.service.parts import gateway_part
from culet_client import RefusedError, connect
from culet_protocol import SUBPROTOCOL, WATCH_SUBPROTOCOL
from culet_protocol.engine import CloseSession, GetSession
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Orbit, Pick, Resize
from culet_protocol.watch import watch_id
from gateway.running import PATIENCE, SIZE, TETRAHEDRON, Endpoints, Gateway, gateway_before

TOKEN = "correct-horse-battery-staple"  # noqa: S105 - of this test
BEARER = {"Authorization": f"Bearer {TOKEN}"}
UPLOAD = {"file": ("stone.obj", TETRAHEDRON)}
SMALL = {"width": 64, "height": 36, "samples": 1}


def frame_of(topic: bytes) -> tuple[Frame, bytes]:
    """One that a viewer was shown."""
    frame = Frame(topic, Codec.JPEG, Flags.FINAL, 7, 1, 1, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"picture")
    return frame, frame.pack()


def cookie_of(gateway: Gateway) -> str:
    """The name of the cookie that a browser keeps for a server."""
    return f"culet-{urlsplit(gateway.url).port}"


def settings(**given: object) -> GatewaySettings:
    return GatewaySettings.read(given, control="inproc://control", frames="inproc://frames")


@pytest.mark.parametrize(
    ("method", "path", "right"),
    [
        ("GET", "/", NOTHING),
        ("GET", "/assets/page.js", NOTHING),
        ("GET", "/api/presets", NOTHING),
        ("GET", "/api/presets/ruby/thumbnail.webp", NOTHING),
        ("GET", "/api/skies", NOTHING),
        ("POST", "/api/skies", Right.UPLOAD),
        ("POST", "/api/meshes", Right.UPLOAD),
        ("POST", "/api/sessions/abc/meshes", Right.UPLOAD),
        ("POST", "/api/sessions/abc/skies", Right.UPLOAD),
        ("PUT", "/api/sessions/abc", Right.STEER),
        ("POST", "/api/drain", Right.ADMINISTER),
        ("POST", "/api/sessions", Right.STEER),
        ("GET", "/api/sessions", Right.ADMINISTER),
        ("DELETE", "/api/sessions/abc", NOTHING),  # whoever knows the id
        ("GET", "/api/render.png", Right.STEER),
        ("POST", "/api/render", Right.STEER),
        ("GET", "/api/whatever-comes", Right.STEER),
        ("POST", "/api/materials", Right.STEER),
        ("GET", "/metrics", Right.ADMINISTER),
        ("GET", "/healthz", NOTHING),
    ],
)
def test_what_a_request_needs(method: str, path: str, right: Right) -> None:
    assert needed(method, path, settings()) == right


def test_the_description_says_which_requests_need_the_token() -> None:
    asked = settings()
    paths = json.loads(cast(Application, create_app(asked)).document())["paths"]
    for path, operations in paths.items():
        for method, operation in operations.items():
            needs = needed(method.upper(), path, asked) != NOTHING
            assert ("401" in operation["responses"]) is needs, (method, path)


def test_health_and_metrics_have_switches_of_their_own() -> None:
    asked = settings(open_health=False, open_metrics=True)
    assert [needed("GET", path, asked) for path in ("/healthz", "/readyz", "/metrics")] == [
        Right.ADMINISTER,
        Right.ADMINISTER,
        NOTHING,
    ]


@pytest.mark.parametrize(
    ("host", "own"),
    [("127.0.0.1", True), ("127.8.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("::", False),  # noqa: S104
     ("192.0.2.7", False), ("gems.example", False)],
)  # fmt: skip
def test_a_token_is_made_where_others_can_reach_the_server(host: str, own: bool) -> None:
    assert is_own_machine(host) is own
    first, second = with_token(settings(host=host)).token, with_token(settings(host=host)).token
    if own:
        assert first is second is None
    else:
        assert first is not None
        assert second is not None
        assert first != second
        assert PATTERN.fullmatch(first)
        assert with_token(settings(host=host, token=TOKEN)).token == TOKEN
    assert with_token(settings(host=host, no_token=True)).token is None


@pytest.mark.parametrize("said", [{"allow_host": ("gems.example",)}, {"trusted_proxy": ("127.0.0.1",)}])
def test_a_token_is_made_where_others_come_by_a_proxy(said: dict[str, tuple[str, ...]]) -> None:
    made = with_token(settings(host="127.0.0.1", **said)).token
    assert made is not None
    assert PATTERN.fullmatch(made)
    assert with_token(settings(host="127.0.0.1", no_token=True, **said)).token is None


def test_an_option_says_whether_there_is_a_token_whatever_the_environment_has(monkeypatch: pytest.MonkeyPatch) -> None:
    endpoints = "inproc://control", "inproc://frames"
    monkeypatch.setenv("CULET_TOKEN", TOKEN)
    assert with_token(settings_of({"host": "0.0.0.0", "no_token": True}, *endpoints)).token is None  # noqa: S104
    with pytest.raises(InputError, match=r"^--no-token: expected a token or none at all, got both"):
        settings_of({"token": TOKEN, "no_token": True}, *endpoints)
    monkeypatch.setenv("CULET_NO_TOKEN", "true")
    assert with_token(settings_of({"token": TOKEN}, *endpoints)).token == TOKEN
    with pytest.raises(InputError, match=r"^CULET_NO_TOKEN: expected a token or none at all, got both"):
        settings_of({}, *endpoints)


def test_a_token_that_can_be_guessed_or_stands_in_no_address_is_refused() -> None:
    for token in ("secret", "x" * 15, "with a space, and more", "ü" * 20):
        with pytest.raises(InputError, match=r"--token: expected 16 to 200 letters"):
            settings_of({"token": token}, "inproc://control", "inproc://frames")


def test_a_cookie_is_not_the_token() -> None:
    token = Token(TOKEN)
    assert token.is_it(TOKEN)
    assert not token.is_it(TOKEN + "x")
    assert not token.is_it("")
    assert token.is_cookie(token.cookie)
    assert not token.is_cookie(TOKEN)
    assert not token.is_it(token.cookie)
    assert token.cookie == Token(TOKEN).cookie, "the same for all servers that share the token"
    assert token.cookie != Token(TOKEN + "x").cookie


def test_the_address_that_is_printed_has_the_token_where_it_is_sent_nowhere() -> None:
    assert entrance("http://0.0.0.0:8000/", "abc") == "http://0.0.0.0:8000/#token=abc"
    assert entrance("http://0.0.0.0:8000/", None) == "http://0.0.0.0:8000/"


def test_a_gateway_is_told_the_token_where_no_list_of_processes_shows_it(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        part = gateway_part(listening, settings(token=TOKEN))
    assert TOKEN not in " ".join(part.command)
    for name, value in part.environment.items():
        monkeypatch.setenv(name, value)
    assert GatewaySettings.model_validate_json(part.command[-1]).token == TOKEN


def test_a_gateway_that_wants_no_token_does_not_take_up_the_environment_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CULET_TOKEN", TOKEN)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        part = gateway_part(listening, settings(token=None, no_token=True))
    for name, value in part.environment.items():
        monkeypatch.setenv(name, value)
    assert GatewaySettings.model_validate_json(part.command[-1]).token is None


def test_a_token_stands_in_a_file_of_this_user_alone_while_the_server_runs(tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text("what a server that was killed has left")
    file.chmod(0o644)
    with token_kept(settings(token_file=file, token=TOKEN)):
        assert file.read_text() == TOKEN
        assert file.stat().st_mode & 0o777 == 0o600
        assert [*tmp_path.iterdir()] == [file]
    assert not file.exists()
    file.write_text("another one's")
    with token_kept(settings(token_file=file, token=None)):
        assert not file.exists(), "a server without a token has none to tell"
    with token_kept(settings(token_file=file, token=TOKEN)):
        begun_since = token_kept(settings(token_file=file, token=TOKEN))
        begun_since.__enter__()
    assert file.read_text() == TOKEN, "it is that server's"
    begun_since.__exit__(None, None, None)
    assert not file.exists()
    with (
        pytest.raises(InputError, match=r"token_file: cannot keep the token in .*nowhere"),
        token_kept(settings(token_file=tmp_path / "nowhere" / "token", token=TOKEN)),
    ):
        pass


async def test_the_health_check_of_the_image_has_a_picture_by_a_token_that_it_was_not_told(
    engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    health = runpy.run_path(str(Path(__file__).parents[3] / "docker" / "unit_health.py"))
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        health["main"].__globals__["PICTURE"] = f"{guarded.url}api/render.png?width=16&height=16&samples=1"
        monkeypatch.delenv("CULET_TOKEN", raising=False)
        monkeypatch.setenv("CULET_TOKEN_FILE", str(tmp_path / "token"))
        assert await asyncio.to_thread(health["main"]) == 1
        with token_kept(settings(token_file=tmp_path / "token", token=TOKEN)):
            assert await asyncio.to_thread(health["main"]) == 0
        monkeypatch.setenv("CULET_TOKEN", TOKEN)
        assert await asyncio.to_thread(health["main"]) == 0


async def test_without_the_token_nothing_is_made_rendered_or_uploaded(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        http = guarded.http
        wrong = {"Authorization": "Bearer " + TOKEN[::-1]}
        forged = [{"Cookie": f"{cookie_of(guarded)}={value}"} for value in (TOKEN, Token(TOKEN[::-1]).cookie)]
        for headers in ({}, wrong, {"Authorization": f"Basic {TOKEN}"}, *forged):
            for answer in (
                await http.post("/api/sessions", json={}, headers=headers),
                await http.get("/api/render.png", params=SMALL, headers=headers),
                await http.post("/api/meshes", files=UPLOAD, headers=headers),
                await http.get("/metrics", headers=headers),
                await http.post("/api/login", headers=headers),
            ):
                assert answer.status_code == 401, answer.text
                assert answer.headers["WWW-Authenticate"].startswith("Bearer")
                assert answer.headers["Content-Type"] == "application/problem+json"
                assert "set-cookie" not in answer.headers
        assert (await http.get("/api/presets")).status_code == 200
        assert (await http.get("/readyz")).status_code == 200
        assert (await http.post("/api/sessions", json={}, headers=BEARER)).status_code == 201
        assert (await http.get("/api/render.png", params=SMALL, headers=BEARER)).status_code == 200
        assert (await http.post("/api/meshes", files=UPLOAD, headers=BEARER)).status_code == 201
        assert (await http.get("/metrics", headers=BEARER)).status_code == 200


async def test_who_has_the_token_sees_what_is_open_and_can_close_it(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        http = guarded.http
        made = [(await http.post("/api/sessions", json={}, headers=BEARER)).json() for _ in range(2)]
        assert (await http.get("/api/sessions")).status_code == 401
        assert (
            await http.get("/api/sessions", headers={"Authorization": f"Bearer {made[0]['id']}"})
        ).status_code == 401
        listed = (await http.get("/api/sessions", headers=BEARER)).json()["sessions"]
        assert {(one["id"], one["watch"]) for one in listed} == {(one["id"], one["watch"]) for one in made}
        assert {(one["client"], one["viewers"], one["stones"], one["falling"]) for one in listed} == {
            ("127.0.0.1", 0, 1, False)
        }
        assert all(0 <= one["unused_seconds"] < PATIENCE for one in listed)
        async with guarded.viewer(made[0]["id"]):
            first = (await http.get("/api/sessions", headers=BEARER)).json()["sessions"][0]
            assert (first["id"], first["viewers"], first["unused_seconds"]) == (made[0]["id"], 1, 0)
        await http.delete(f"/api/sessions/{made[0]['id']}")
        left = (await http.get("/api/sessions", headers=BEARER)).json()["sessions"]
        assert [one["id"] for one in left] == [made[1]["id"]]


async def test_a_server_that_has_no_token_tells_nobody_what_is_open(gateway: Gateway) -> None:
    """The ids let change sessions, and here nothing tells who may know them."""
    session = await gateway.session()
    refused = await gateway.http.get("/api/sessions")
    assert refused.status_code == 403
    assert session not in refused.text
    assert "--token" in refused.json()["detail"]


async def test_a_browser_keeps_a_cookie_in_the_token_s_place(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        answer = await guarded.http.post("/api/login", headers=BEARER)
        assert answer.status_code == 204
        kept = answer.headers["set-cookie"]
        assert TOKEN not in kept
        for word in ("HttpOnly", "SameSite=strict", "Path=/"):
            assert word in kept
        assert "Secure" not in kept  # by plain http a browser would not keep it
        assert list(guarded.http.cookies) == [cookie_of(guarded)], "the client keeps it"
        assert (await guarded.http.post("/api/sessions", json={})).status_code == 201
        assert (await guarded.http.delete("/api/login")).status_code == 204
        assert (await guarded.http.post("/api/sessions", json={})).status_code == 401


async def test_a_cookie_counts_whatever_other_programs_keep_for_the_host(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        own = f"{cookie_of(guarded)}={Token(TOKEN).cookie}"
        for kept in (own, f"a=b; {own}", f'x={{"a":1}}; {own}', f"{own}; y=[1,2]; z"):
            answer = await guarded.http.post("/api/sessions", json={}, headers={"Cookie": kept})
            assert answer.status_code == 201, kept


async def test_programs_say_the_token(engine: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:

        def connect_thrice() -> None:
            with pytest.raises(RefusedError, match="expected this server's token"):
                connect(guarded.url)
            for url, token in ((f"{guarded.url}#token={TOKEN}", None), (guarded.url, TOKEN)):
                with connect(url, token=token, size=(64, 36), timeout_seconds=PATIENCE) as connection:
                    connection.image()
            monkeypatch.setenv("CULET_TOKEN", TOKEN)
            with connect(guarded.url, size=(64, 36), timeout_seconds=PATIENCE) as connection:
                connection.image()

        await asyncio.to_thread(connect_thrice)


async def test_a_session_s_links_need_no_token(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, token=TOKEN) as guarded:
        made = await guarded.http.post("/api/sessions", json={}, headers=BEARER)
        session = made.json()["id"]
        async with guarded.viewer(session) as steering, guarded.viewer(watch_id(session)) as watching:
            assert (await steering.notice("hello"))["steers"]
            await watching.frame()
        assert (await guarded.http.get(f"/api/sessions/{session}")).status_code == 200


async def test_whoever_has_the_watching_link_sees_all_and_changes_nothing(gateway: Gateway) -> None:
    session = await gateway.session()
    watch = watch_id(session)
    async with gateway.viewer(session) as steering, gateway.viewer(watch) as watching:
        hello = await watching.notice("hello")
        assert (hello["session"], hello["watch"], hello["steers"]) == (watch, watch, False)
        assert (await watching.notice("state"))["scene"]
        await watching.final()
        await watching.say(Orbit(yaw=0.5, pitch=0))
        refused = await watching.notice("problem")
        assert refused["code"] == "only_watching"
        await watching.say(Pick(number=1, x=0, y=0))
        await watching.notice("picked")
        await steering.say(Orbit(yaw=0.5, pitch=0))
        changed = await watching.notice("state")
        assert "snapshot" not in {told["type"] for told in watching.notices}
        assert session not in str(watching.notices) + str(hello) + str(changed)
    said = await gateway.http.get(f"/api/sessions/{watch}")
    assert (said.json()["id"], said.json()["watch"]) == (watch, watch)
    assert session not in said.text
    assert (await gateway.http.get(f"/api/sessions/{watch}/frame.png", params=SMALL)).status_code == 200
    for answer in (
        await gateway.http.patch(f"/api/sessions/{watch}", json={"floor": {"kind": "matte"}}),
        await gateway.http.post(f"/api/sessions/{watch}/events", json={"type": "toggle_fall"}),
        await gateway.http.delete(f"/api/sessions/{watch}"),
        await gateway.http.post("/api/sessions", json={"id": watch, "scene": {}}),
    ):
        assert answer.status_code == 403, answer.text
        assert answer.headers["Content-Type"] == "application/problem+json"
    assert (await gateway.http.get(f"/api/sessions/{session}")).json()["falling"] is False


@pytest.mark.parametrize("part", ["scene", "frame.png", "grade", "diagram.svg"])
async def test_who_watches_is_answered_of_a_session_that_the_engine_forgot(gateway: Gateway, part: str) -> None:
    """Its own id, which steers, is in no answer; and an engine that does not know the session is given it."""
    session = await gateway.session()
    watching = f"/api/sessions/{watch_id(session)}/{part}"
    asked = SMALL if part == "frame.png" else {"error": 10} if part == "grade" else {}
    await gateway.parts.link.request(CloseSession(session=session))
    answer = await gateway.http.get(watching, params=asked)
    assert answer.status_code == 200, answer.text
    assert session not in answer.text


def difference(one: httpx.Response, other: httpx.Response) -> float:
    """Of two pictures, the mean of all channels, in steps of 256. Of one scene two programs may have made them."""
    pixels = [np.asarray(Image.open(io.BytesIO(each.content)).convert("RGB"), float) for each in (one, other)]
    return float(abs(pixels[0] - pixels[1]).mean())


async def test_who_watches_sees_a_session_with_another_design_of_its_stone(gateway: Gateway) -> None:
    """As a still of it: nothing changes, and the session's own id is in no answer. What the design names takes the
    place of what the stone has, also where that has parts, as angles of tiers."""
    session = await gateway.session({"stones": [{"id": "a", "recut": {"angles": {"4": 42.5}}}]})
    watching = f"/api/sessions/{watch_id(session)}"
    scene = (await gateway.http.get(watching)).json()["scene"]
    own = await gateway.http.get(f"{watching}/frame.png", params=SMALL)
    for design in ({}, {"cut": "oval", "mesh": None, "recut": None}, {"recut": {"angles": {"7": 36}}}):
        asked = {"stone": "a", "design": design, "format": "png", **SMALL}
        beside = await gateway.http.post(f"{watching}/beside", json=asked)
        assert (beside.status_code, beside.headers["Content-Type"]) == (200, "image/png"), beside.text
        (stone,) = scene["stones"]
        other = {"scene": scene | {"stones": [stone | design]}, "format": "png", **SMALL}
        expected = await gateway.http.post("/api/render", json=other)
        assert difference(beside, expected) < 0.1
        assert (difference(beside, own) > 0.5) == bool(design)
    assert (await gateway.http.get(watching)).json()["scene"] == scene
    asked = {"stone": "a", "design": {}, **SMALL}
    for change in ({"stone": "b"}, {"design": {"mesh": "x"}}, {"design": {"scale": 2}}, {"step": 2**62}):
        refused = await gateway.http.post(f"{watching}/beside", json=asked | change)
        assert refused.status_code == (404 if "step" in change else 422), refused.text
        assert session not in refused.text


async def test_what_the_engine_says_of_a_session_that_it_does_not_know_has_no_id(gateway: Gateway) -> None:
    session = await gateway.session()
    await gateway.parts.link.request(CloseSession(session=session))
    with pytest.raises(NotFoundError) as refused:
        await gateway.parts.link.request(GetSession(session=session))
    assert session not in str(refused.value)


@pytest.mark.parametrize("part", ["scene", "frame.png"])
async def test_who_asks_for_a_step_that_is_not_kept_disturbs_nobody(gateway: Gateway, part: str) -> None:
    """A session that the engine knows is not opened anew, which its viewers would see."""
    session = await gateway.session()
    record = gateway.parts.sessions.get(session)
    latest = record.latest = frame_of(record.topic)
    answer = await gateway.http.get(f"/api/sessions/{watch_id(session)}/{part}", params={"step": 2**62})
    assert answer.status_code == 404, answer.text
    assert session not in answer.text
    assert record.latest is latest


async def test_a_page_in_another_one_says_its_watch_id_as_a_subprotocol(gateway: Gateway) -> None:
    session = await gateway.session()
    for named in (watch_id(session), session):  # the session's own id steers nothing here either
        offered = [Subprotocol(SUBPROTOCOL), Subprotocol(WATCH_SUBPROTOCOL + named)]
        async with gateway.viewer("", path="api/stream", subprotocols=offered) as watching:
            assert watching.websocket.subprotocol == SUBPROTOCOL
            assert (await watching.notice("hello"))["steers"] is False
            await watching.frame()
            await watching.say(Orbit(yaw=0.5, pitch=0))
            assert (await watching.notice("problem"))["code"] == "only_watching"
    with pytest.raises(ConnectionClosed) as closed:
        async with gateway.viewer("", path="api/stream") as lost:
            await lost.frame()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4404


async def test_who_only_watches_does_not_decide_how_large_the_picture_is(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(watch_id(session), size=Resize(width=32, height=48)) as watching:
        frame = await watching.final()
        assert (frame.width, frame.height) == (32, 48), "unless nobody else is there"
        async with gateway.viewer(session, size=SIZE) as steering:
            await steering.until(lambda: any(frame.width == SIZE.width for frame in steering.frames))

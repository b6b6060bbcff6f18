"""Streams over a real WebSocket: who gets which frame, what is refused, and that one viewer never harms another."""

from __future__ import annotations

import asyncio
import io
import json
from pathlib import Path
from typing import Any, cast

import pytest
from fastapi import WebSocket
from PIL import Image
from starlette.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from culet.gateway.routes import stream as streaming
from culet.gateway.routes.stream import MAX_CONTROL_BYTES
from culet.gateway.sessions.session_record import EVENTS_UNDER_WAY
from culet.gateway.viewers.credit import FIRST_WINDOW
from culet.scene import Scene
from culet_protocol.close import CloseCode
from culet_protocol.frame import Flags
from culet_protocol.messages import Balance, Orbit, Outline, Pick, Ping, ResetStone, Resize, ToggleFall, Visibility
from culet_protocol.watch import watch_id
from gateway.running import FOREIGN, PATIENCE, SIZE, Endpoints, Gateway, eventually, gateway_before


async def test_a_viewer_is_greeted_and_gets_frames_of_its_size_up_to_the_final_one(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        hello = await viewer.notice("hello")
        assert set(hello.pop("encodes")) <= {"h264", "vp9"}  # as there are encoders here
        assert hello == {
            "type": "hello",
            "protocol": 2,
            "session": session,
            "watch": watch_id(session),
            "viewer": 1,
            "steers": True,
        }
        assert (await viewer.notice("state"))["scene"] == Scene().model_dump(mode="json")
        assert (await viewer.notice("viewers"))["count"] == 1
        final = await viewer.final()
    assert final.watch.hex() == watch_id(session)
    assert (final.width, final.height) == (64, 36)
    with Image.open(io.BytesIO(final.payload)) as picture:
        assert (picture.format, picture.size) == (final.codec.name, (64, 36))


async def test_frames_come_in_order_and_none_twice(gateway: Gateway) -> None:
    async with gateway.viewer(await gateway.session()) as viewer:
        await viewer.say(ToggleFall())
        await viewer.until(lambda: len(viewer.frames) >= 20)
    sequences = [frame.sequence for frame in viewer.frames]
    assert sequences == sorted(set(sequences))


async def test_two_viewers_see_the_same_and_are_told_of_each_other(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as first, gateway.viewer(session) as second:
        assert (await second.notice("viewers"))["count"] == 2
        one, two = await first.final(), await second.final()
        assert one.payload == two.payload
        await first.say(Orbit(yaw=0.3, pitch=0))
        moved = await second.notice("state")
        while moved["scene"]["camera"]["position"][0] == 0:
            moved = await second.notice("state")

    async def nobody() -> bool:
        return gateway.parts.sessions.viewers == 0

    await eventually(nobody)


async def test_viewers_share_the_balance(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as first, gateway.viewer(session) as second:
        state = await second.notice("state")
        assert (state["exactness"], state["pinned"]) == (0.5, False)
        await first.say(Balance(exactness=0.25, pinned=True))
        state = await second.notice("state")
        assert (state["exactness"], state["pinned"]) == (0.25, True)
        described = (await gateway.http.get(f"/api/sessions/{session}")).json()
        assert (described["exactness"], described["pinned"]) == (0.25, True)


async def test_a_late_viewer_gets_the_latest_picture_without_a_new_one_being_rendered(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as early:
        final = await early.final()
        rendered = (await gateway.engine_status())["frames_rendered"]
        async with gateway.viewer(session) as late:
            assert (await late.frame()).sequence == final.sequence
            assert (await gateway.engine_status())["frames_rendered"] == rendered


async def test_a_viewer_that_never_acknowledges_gets_its_window_and_delays_nobody(gateway: Gateway) -> None:
    session = await gateway.session({"simulation": {"restitution": 1, "tangential_damping": 1, "angular_damping": 1}})
    async with gateway.viewer(session) as stuck, gateway.viewer(session) as lively:
        stuck.acknowledges = False
        await lively.say(ToggleFall())
        await lively.until(lambda: len(lively.frames) >= 30)
        await stuck.say(Ping(time=1))
        await stuck.notice("pong")
    assert len(stuck.frames) == FIRST_WINDOW


async def test_a_question_about_the_picture_is_answered_to_who_asked(gateway: Gateway) -> None:
    session = await gateway.session({"stones": [{"id": "ruby"}]})
    async with gateway.viewer(session) as curious, gateway.viewer(session) as other:
        frame = await curious.final()
        await curious.say(Pick(number=9, x=0, y=0))
        picked = await curious.notice("picked")
        assert (picked["number"], picked["stone"]) == (9, "ruby")
        await curious.say(Outline(stone="ruby", step=frame.step))
        outlined = await curious.notice("outlined")
        assert (outlined["stone"], outlined["step"]) == ("ruby", frame.step)
        assert len(outlined["points"]) >= 6
        await other.say(Ping(time=3))
        await other.notice("pong")
        assert not {"picked", "outlined"} & {told["type"] for told in other.notices}


async def test_questions_of_who_only_watches_take_no_room_of_the_session_s_events(
    gateway: Gateway, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However long the engine takes for them."""
    asked, session = 0, await gateway.session()

    async def never_answered(*_: object) -> None:
        nonlocal asked
        asked += 1
        await asyncio.Event().wait()

    async def all_asked() -> bool:
        return asked == EVENTS_UNDER_WAY

    monkeypatch.setattr(gateway.parts.sessions, "ask", never_answered)
    async with gateway.viewer(session) as steering, gateway.viewer(watch_id(session)) as watching:
        first = await steering.frame()
        for number in range(2 * EVENTS_UNDER_WAY):
            await watching.say(Pick(number=number, x=0, y=0))
        await eventually(all_asked)
        await steering.say(Orbit(yaw=0.1, pitch=0))
        await steering.until(lambda: steering.frames[-1].step > first.step)


async def test_nobody_watching_means_nothing_rendered(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.frame()

    async def unwatched() -> bool:
        return (await gateway.engine_status())["sessions_watched"] == 0

    await eventually(unwatched)
    rendered = (await gateway.engine_status())["frames_rendered"]
    for x in range(3):
        patched = await gateway.http.patch(f"/api/sessions/{session}", json={"camera": {"position": [x, 2, 6]}})
        assert patched.status_code == 200
    still = await gateway.http.get("/api/render.tga", params={"width": 32, "height": 18, "samples": 1})
    assert still.status_code == 200, "the render thread had its turn after the edits"
    assert (await gateway.engine_status())["frames_rendered"] == rendered


async def test_a_hidden_viewer_gets_nothing_until_it_is_shown_again(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.final()
        await viewer.say(Visibility(visible=False))

        async def unwatched() -> bool:
            return (await gateway.engine_status())["sessions_watched"] == 0

        await eventually(unwatched)
        seen = len(viewer.frames)
        await viewer.say(Orbit(yaw=0.2, pitch=0))
        await viewer.say(Ping(time=2))
        await viewer.notice("pong")
        assert len(viewer.frames) == seen
        await viewer.say(Visibility(visible=True))
        assert (await viewer.frame()).step > viewer.frames[seen - 1].step


async def test_the_latest_resize_decides_the_size(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.final()
        await viewer.say(Resize(width=48, height=48))
        await viewer.until(lambda: (viewer.frames[-1].width, viewer.frames[-1].height) == (48, 48))


async def test_a_second_viewer_does_not_change_the_size_until_the_first_hides_its_page(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as desk, gateway.viewer(session, size=Resize(width=36, height=64)) as phone:
        assert ((await phone.final()).width, phone.frames[-1].height) == (SIZE.width, SIZE.height)
        await desk.say(Visibility(visible=False))
        await phone.until(lambda: (phone.frames[-1].width, phone.frames[-1].height) == (36, 64))


async def test_falling_frames_are_marked_and_a_reset_ends_them(gateway: Gateway) -> None:
    async with gateway.viewer(await gateway.session()) as viewer:
        await viewer.say(ToggleFall())
        await viewer.until(lambda: bool(viewer.frames and Flags.MOVING in viewer.frames[-1].flags))
        assert (await viewer.notice("state"))["falling"] is False
        assert (await viewer.notice("state"))["falling"] is True
        await viewer.say(ResetStone())
        while (await viewer.notice("state"))["falling"]:  # it may have come to rest before
            pass
        assert (await viewer.final()).simulation_time == 0


async def test_viewers_are_told_when_the_stone_has_fallen_asleep(gateway: Gateway) -> None:
    session = await gateway.session({"simulation": {"restitution": 0, "gravity": 100}})
    async with gateway.viewer(session) as viewer:
        await viewer.say(ToggleFall())
        asleep, motions = False, dict[str, str]()
        while not asleep or list(motions.values()) != ["asleep"]:
            state = await viewer.notice("state")
            asleep, motions = state["asleep"], state["motions"] or motions  # none: what was told last
        assert state["falling"] is True
        assert (await gateway.http.get(f"/api/sessions/{session}")).json()["asleep"] is True


@pytest.mark.parametrize(
    ("message", "code", "field"),
    [
        ("not json", "malformed", None),
        ('{"type": "fly"}', "malformed", "type"),
        ('{"type": "orbit", "yaw": "far", "pitch": 0}', "malformed", "orbit.yaw"),
        ('{"type": "orbit", "yaw": NaN, "pitch": 0}', "malformed", "orbit.yaw"),
        ('{"type": "balance", "exactness": 1.5, "pinned": false}', "malformed", "balance.exactness"),
        ('{"type": "patch_scene", "patch": {"film": {"exposure": NaN}}}', "unusable_input", "film.exposure"),
        ('{"type": "patch_scene", "patch": {"film": {"exposure": 1e999}}}', "unusable_input", "film.exposure"),
        ('{"type": "patch_scene", "patch": {"film": {"exposure": -1}}}', "unusable_input", "film.exposure"),
        ('{"type": "set_scene", "scene": {"stones": [{"mesh": "../etc/passwd"}]}}', "unusable_input", "stones.0.mesh"),
        (json.dumps({"type": "set_scene", "scene": {"x": "y" * MAX_CONTROL_BYTES}}), "too_large", None),
        (b"\x00\x01\x02", "binary_message", None),
    ],
    ids=["no json", "unknown type", "wrong type", "nan", "too exact", "nan in patch", "infinity in patch",
         "out of range", "path", "oversized", "binary"],
)  # fmt: skip
async def test_bad_control_messages_are_answered_and_the_session_lives_on(
    gateway: Gateway, message: str | bytes, code: str, field: str | None
) -> None:
    async with gateway.viewer(await gateway.session()) as viewer:
        first = await viewer.frame()
        number = viewer.sent + 1
        await viewer.websocket.send(message)
        problem = await viewer.notice("problem")
        assert (problem["code"], problem["field"]) == (code, field)
        assert problem["message"]
        assert problem["number"] == number, "whoever sent it can tell which message was refused"
        await viewer.say(Orbit(yaw=0.1, pitch=0.1))
        await viewer.until(lambda: viewer.frames[-1].step > first.step)


async def test_a_message_beyond_any_use_closes_that_viewer_only(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as rude, gateway.viewer(session) as other:

        async def be_rude() -> None:  # refused by its length, maybe before all of it was sent
            await rude.websocket.send("x" * (2 << 20))
            await rude.until(lambda: False)

        with pytest.raises(ConnectionClosed) as closed:
            await asyncio.wait_for(be_rude(), PATIENCE)
        assert closed.value.rcvd
        assert closed.value.rcvd.code == 1009
        await other.final()


@pytest.mark.parametrize(
    ("options", "code", "reason"),
    [
        (
            {"origin": FOREIGN},
            CloseCode.FORBIDDEN_ORIGIN,
            "pages of http://elsewhere.example may not open streams here",
        ),
        (
            {"subprotocols": [Subprotocol("culet.v99")]},
            CloseCode.PROTOCOL_ERROR,
            "this server speaks culet.v2; reload the page, or use its own client",
        ),
    ],
    ids=["foreign page", "other protocol"],
)
async def test_a_refused_viewer_is_told_why(gateway: Gateway, options: dict[str, Any], code: int, reason: str) -> None:
    with pytest.raises(ConnectionClosed) as closed:
        async with gateway.viewer(await gateway.session(), size=None, **options) as viewer:
            await viewer.until(lambda: False)
    assert closed.value.rcvd
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (code, reason)


async def test_an_unknown_session_is_closed_with_4404(gateway: Gateway) -> None:
    with pytest.raises(ConnectionClosed) as closed:
        async with gateway.viewer("0" * 32, size=None) as viewer:
            await viewer.until(lambda: False)
    assert closed.value.rcvd
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (
        CloseCode.UNKNOWN_SESSION,
        "no such session; it may have expired",
    )


async def test_a_session_takes_so_many_viewers_and_no_more(engine: Endpoints, tmp_path: Path) -> None:
    async with gateway_before(engine, web=tmp_path, max_viewers=1) as gateway:
        session = await gateway.session()
        async with gateway.viewer(session) as first:
            await first.notice("hello")
            with pytest.raises(ConnectionClosed) as closed:
                async with gateway.viewer(session, size=None) as second:
                    await second.until(lambda: False)
            assert closed.value.rcvd
            assert closed.value.rcvd.code == CloseCode.BUSY
            await first.final()


async def test_a_page_of_the_same_host_may_open_a_stream(gateway: Gateway) -> None:
    async with gateway.viewer(await gateway.session(), origin=gateway.url.rstrip("/")) as viewer:
        await viewer.notice("hello")


class StuckWebSocket:
    """The server's end of a connection whose other end reads nothing after the first message, and says nothing."""

    def __init__(self) -> None:
        self.scope: dict[str, list[str]] = {"subprotocols": [], "headers": []}
        self.headers = Headers()
        self.sent: list[str] = []
        self.closes: list[tuple[int, str]] = []

    async def accept(self, _subprotocol: str | None) -> None: ...

    async def send_text(self, text: str) -> None:
        if self.sent:
            await asyncio.Event().wait()
        self.sent.append(text)

    async def receive(self) -> Any:  # noqa: ANN401 - as starlette's
        await asyncio.Event().wait()

    async def close(self, code: int, reason: str) -> None:
        self.closes.append((code, reason))
        await asyncio.Event().wait()  # uvicorn too waits until what was sent before is taken


async def test_a_viewer_that_reads_nothing_is_given_up_even_if_it_cannot_be_told_so(
    gateway: Gateway, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streaming, "SEND_SECONDS", 0.05)
    session, websocket = await gateway.session(), StuckWebSocket()
    async with asyncio.timeout(PATIENCE):
        await streaming.stream(cast(WebSocket, websocket), gateway.parts, session)
    assert websocket.closes == [(CloseCode.TOO_SLOW, "this viewer does not read what it is sent")]
    assert gateway.parts.sessions.viewers == 0


class VanishingWebSocket(StuckWebSocket):
    """One whose other end sends so many events and is gone before any of them is answered."""

    def __init__(self, events: int) -> None:
        super().__init__()
        self.events = events

    async def receive(self) -> Any:  # noqa: ANN401 - as starlette's
        self.events -= 1
        if self.events < 0:
            return {"type": "websocket.disconnect"}
        return {"type": "websocket.receive", "text": Orbit(yaw=0.1, pitch=0).model_dump_json()}


async def test_viewers_that_vanish_with_events_under_way_leave_room_for_those_of_others(gateway: Gateway) -> None:
    session = await gateway.session()
    for _ in range(5):
        websocket = VanishingWebSocket(EVENTS_UNDER_WAY)
        await streaming.stream(cast(WebSocket, websocket), gateway.parts, session)
    async with gateway.viewer(session) as viewer:
        first = await viewer.frame()
        for _ in range(2 * EVENTS_UNDER_WAY):
            await viewer.say(Orbit(yaw=0.1, pitch=0))
        await viewer.until(lambda: viewer.frames[-1].step >= first.step + 2 * EVENTS_UNDER_WAY)


async def test_a_viewer_that_vanishes_in_mid_frame_leaves_the_others_alone(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as stays:
        async with gateway.viewer(session) as vanishes:
            await stays.say(ToggleFall())
            await vanishes.frame()
            vanishes.websocket.transport.abort()  # no closing handshake, frames on their way
        seen = len(stays.frames)
        await stays.until(lambda: len(stays.frames) >= seen + 5)
        await stays.until(lambda: {"type": "viewers", "count": 1} in stays.notices[2:])


async def test_deleting_a_session_ends_its_streams(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session) as viewer:
        await viewer.frame()
        assert (await gateway.http.delete(f"/api/sessions/{session}")).status_code == 204
        assert (await viewer.notice("problem"))["code"] == "session_closed"
        async with asyncio.timeout(PATIENCE):
            await viewer.websocket.wait_closed()
        assert viewer.websocket.close_code == CloseCode.UNKNOWN_SESSION
    assert (await gateway.http.get(f"/api/sessions/{session}")).status_code == 404

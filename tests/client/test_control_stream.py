"""The client's WebSocket against the real server."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import TypeVar

import httpx
import pytest
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from client.frames import FRAME, SESSION
from culet_client import ClientError, ControlStream
from culet_client.stream import stream_url
from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Ack, Hello, Orbit, PatchScene, Ping, Pong, Problem, Resize, State, ToggleFall

PATIENCE = 30
T = TypeVar("T")


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """The address of a running `culet serve`."""
    with subprocess.Popen([sys.executable, "-m", "culet", "serve", "--port", "0"], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().decode().split()[-1]
        finally:
            process.terminate()


@pytest.fixture
def session(server: str) -> str:
    """A new one."""
    scene = {"floor": {"kind": "none"}, "environment": {"kind": "dark"}}
    reply = httpx.post(f"{server}api/sessions", json={"scene": scene}, timeout=PATIENCE)
    assert reply.status_code == 201, reply.text
    created: str = reply.json()["id"]
    return created


def until(stream: ControlStream, kind: type[T]) -> T:
    """The next of that kind."""
    while not isinstance(message := stream.receive(PATIENCE), kind):
        pass
    return message


def test_a_viewer_is_greeted_and_shown_more_than_its_window_of_frames(server: str, session: str) -> None:
    with ControlStream(server, session) as stream:
        assert until(stream, Hello).session == session
        stream.send(Resize(width=64, height=36))
        stream.send(ToggleFall())
        sequences = [until(stream, Frame).sequence for _ in range(12)]
        assert sequences == sorted(set(sequences))


def test_every_frame_is_acknowledged() -> None:
    """Without, the server would hold each frame's place in the viewer's window for 2 s."""
    acknowledged = []

    def send_three(connection: ServerConnection) -> None:
        for sequence in (5, 6, 9):
            connection.send(replace(FRAME, sequence=sequence).pack())
            acknowledged.append(json.loads(connection.recv(PATIENCE)))

    with serve(send_three, "127.0.0.1", 0, subprotocols=[Subprotocol(SUBPROTOCOL)]) as server:
        threading.Thread(target=server.serve_forever).start()
        try:
            with ControlStream(f"http://127.0.0.1:{server.socket.getsockname()[1]}", SESSION) as stream:
                assert [until(stream, Frame).sequence for _ in range(3)] == [5, 6, 9]
                with pytest.raises(ClientError, match="closed the stream"):
                    stream.receive(PATIENCE)
        finally:
            server.shutdown()
    assert [Ack.model_validate(ack).sequence for ack in acknowledged] == [5, 6, 9]


def test_an_event_changes_what_is_shown(server: str, session: str) -> None:
    with ControlStream(server, session) as stream:
        before = until(stream, Frame)
        stream.send(Orbit(yaw=0.3, pitch=0))
        while (frame := until(stream, Frame)).step == before.step:
            pass
        assert frame.step == before.step + 1


def test_a_refusal_names_the_field(server: str, session: str) -> None:
    with ControlStream(server, session) as stream:
        until(stream, State)
        stream.send(PatchScene(patch={"floor": {"kind": "lava"}}))
        assert until(stream, Problem).field == "floor.kind"
        stream.send(Ping(time=12.5))
        assert until(stream, Pong).time == 12.5


def test_an_unknown_session_is_a_readable_reason(server: str) -> None:
    with pytest.raises(ClientError, match=r"no such session.*4404"), ControlStream(server, "0" * 32) as stream:
        until(stream, Frame)


def test_no_server_is_a_readable_reason() -> None:
    with pytest.raises(ClientError, match="cannot open ws://127"):
        ControlStream("http://127.0.0.1:1", "0" * 32)


def test_addresses_of_servers_become_those_of_streams() -> None:
    assert stream_url("http://gems.example:80/a/", "7") == "ws://gems.example:80/a/api/sessions/7/stream"
    assert stream_url("https://gems.example", "7") == "wss://gems.example/api/sessions/7/stream"
    with pytest.raises(ClientError, match="gems"):
        stream_url("gems", "7")

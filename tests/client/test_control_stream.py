"""The client's WebSocket against the real server."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, TypeVar

import httpx
import numpy as np
import PIL.Image
import pytest
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from client.frames import FRAME, SESSION
from culet_client import ClientError, Connection, ControlStream, Image, RefusedError, connect
from culet_client.stream import stream_url
from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Codec, Frame
from culet_protocol.messages import Ack, Hello, Orbit, PatchScene, Ping, Pong, Problem, Resize, State, ToggleFall
from culet_protocol.watch import watch_id
from shared import patience

PATIENCE = patience.PATIENCE
T = TypeVar("T")


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Where the server's engine publishes frames."""
    return f"ipc://{tmp_path_factory.mktemp('sockets')}/frames"


@pytest.fixture(scope="module")
def server(frames: str) -> Iterator[str]:
    """The address of a running `culet serve`."""
    command = [sys.executable, "-m", "culet", "serve", "--port", "0", "--frames", frames]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
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
    with ControlStream(server, session, timeout_seconds=PATIENCE) as stream:
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
            with ControlStream(
                f"http://127.0.0.1:{server.socket.getsockname()[1]}", SESSION, timeout_seconds=PATIENCE
            ) as stream:
                assert [until(stream, Frame).sequence for _ in range(3)] == [5, 6, 9]
                with pytest.raises(ClientError, match="closed the stream"):
                    stream.receive(PATIENCE)
        finally:
            server.shutdown()
    assert [Ack.model_validate(ack).sequence for ack in acknowledged] == [5, 6, 9]


def test_an_event_changes_what_is_shown(server: str, session: str) -> None:
    with ControlStream(server, session, timeout_seconds=PATIENCE) as stream:
        before = until(stream, Frame)
        stream.send(Orbit(yaw=0.3, pitch=0))
        while (frame := until(stream, Frame)).step == before.step:
            pass
        assert frame.step == before.step + 1


def test_a_refusal_names_the_field(server: str, session: str) -> None:
    with ControlStream(server, session, timeout_seconds=PATIENCE) as stream:
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


RED = {
    "stones": [],
    "floor": {"kind": "none"},
    "backdrop": {"kind": "none"},
    "environment": {"kind": "constant", "radiance": [1, 0, 0]},
}
"""A scene of whose sky nothing is hidden."""
BLUE_SKY = PatchScene(patch={"environment": {"kind": "constant", "radiance": [0, 0, 1]}})


def colour(image: Image) -> list[int]:
    """Of a picture's middle, each channel as far as JPEG keeps it: 0 or 1."""
    height, width, _ = image.pixels.shape
    return [round(float(value) / 255) for value in image.pixels[height // 2, width // 2]]


def until_it_shows(connection: Connection, wanted: list[int]) -> Image:
    """The first picture of that colour."""
    return next(image for image in connection if colour(image) == wanted)


def test_a_connection_by_websocket_shows_what_its_events_make(server: str) -> None:
    with connect(server, scene=RED, size=(64, 36), timeout_seconds=PATIENCE) as connection:
        assert until_it_shows(connection, [1, 0, 0]).pixels.dtype == np.uint8
        connection.send(BLUE_SKY)
        image = until_it_shows(connection, [0, 0, 1])
        assert image.pixels.shape == (image.frame.height, image.frame.width, 3) == (36, 64, 3)
        assert connection.session is not None
        made = f"{server}api/sessions/{connection.session}"
        assert httpx.get(made, timeout=PATIENCE).json()["viewers"] == 1
        with connect(f"{server}?session={connection.session}", timeout_seconds=PATIENCE) as second:
            assert second.session == connection.session
            until_it_shows(second, [0, 0, 1])
        with connect(f"{server}?watch={watch_id(connection.session)}", timeout_seconds=PATIENCE) as onlooker:
            until_it_shows(onlooker, [0, 0, 1])
            with pytest.raises(ClientError, match="one may look, and not steer"):
                onlooker.send(BLUE_SKY)
        assert httpx.get(made, timeout=PATIENCE).status_code == 200, "who only joined leaves the session alone"
    assert httpx.get(made, timeout=PATIENCE).status_code == 404, "who made it takes it along"


def test_a_connection_by_zeromq_shows_what_its_events_make(server: str, frames: str) -> None:
    """The engine of `culet serve` is told by way of the gateway."""
    with connect(frames, scene=RED, control=server, timeout_seconds=PATIENCE) as connection:
        until_it_shows(connection, [1, 0, 0])
        connection.send(BLUE_SKY)
        until_it_shows(connection, [0, 0, 1])
        with pytest.raises(RefusedError) as refusal:
            connection.send(PatchScene(patch={"floor": {"kind": "lava"}}))
        assert refusal.value.field == "floor.kind"
        assert connection.session is not None
        with connect(frames, watch=watch_id(connection.session), timeout_seconds=PATIENCE) as onlooker:
            until_it_shows(onlooker, [0, 0, 1])
            with pytest.raises(ClientError, match="one may look, and not steer"):
                onlooker.send(BLUE_SKY)


def test_a_refused_event_of_a_connection_by_websocket_is_told_with_the_next_picture(server: str, session: str) -> None:
    with connect(server, session=session, timeout_seconds=PATIENCE) as connection:
        connection.image()
        connection.send(PatchScene(patch={"floor": {"kind": "lava"}}))
        with pytest.raises(RefusedError) as refusal:
            for _ in connection:
                pass
        assert refusal.value.field == "floor.kind"
        connection.send(Orbit(yaw=0.1, pitch=0))
        connection.image()


@pytest.mark.parametrize(
    ("url", "given", "said"),
    [
        ("gems", {}, "expected a server such as http"),
        ("http://127.0.0.1:1", {}, "cannot reach http://127.0.0.1:1"),
        ("http://127.0.0.1:1", {"control": "ipc:///nowhere"}, "control: expected with an engine's frames"),
        ("http://127.0.0.1:1", {"watch": SESSION}, "cannot open ws://127.0.0.1:1/"),
        ("http://127.0.0.1:1", {"watch": SESSION, "session": SESSION}, "got both"),
        ("http://127.0.0.1:1", {"session": SESSION}, "cannot open ws://127.0.0.1:1/"),
        ("http://127.0.0.1:1", {"scene": {}, "preset": "ruby"}, "got both"),
        ("tcp://127.0.0.1:1", {}, "expected a session, its watch id, or a control address"),
        ("tcp://127.0.0.1:1", {"session": "x"}, "32 hexadecimal digits"),
        ("tcp://127.0.0.1:1", {"session": SESSION, "size": (64, 36)}, "the size is the engine's to be told"),
        ("tcp://127.0.0.1:1", {"control": "ipc:///nowhere", "preset": "ruby"}, "the engine knows none by name"),
        ("tcp://127.0.0.1:1", {"control": "ipc:///nowhere", "timeout_seconds": 0.01}, "no answer from the engine"),
    ],
)
def test_a_connection_that_cannot_be_says_why(url: str, given: dict[str, Any], said: str) -> None:
    with pytest.raises(ClientError, match=said):
        connect(url, **given)


def test_damaged_pictures_are_said_so() -> None:
    for codec, name in ((Codec.JPEG, "JPEG"), (Codec.PNG, "PNG")):
        with pytest.raises(ClientError, match=f"frame 1 is no {name}"):
            Image.of(replace(FRAME, codec=codec))
    with io.BytesIO() as file:
        PIL.Image.new("RGB", (3, 2), (9, 8, 7)).save(file, "PNG")
        png = replace(FRAME, codec=Codec.PNG, payload=file.getvalue())
    assert Image.of(replace(png, width=3)).pixels.tolist() == [[[9, 8, 7]] * 3] * 2
    with pytest.raises(ClientError, match="expected 4 x 2 pixels"):
        Image.of(png)


def test_addresses_of_servers_become_those_of_streams() -> None:
    assert stream_url("http://gems.example:80/a/", "7") == "ws://gems.example:80/a/api/sessions/7/stream"
    assert stream_url("https://gems.example", "7") == "wss://gems.example/api/sessions/7/stream"
    with pytest.raises(ClientError, match="gems"):
        stream_url("gems", "7")

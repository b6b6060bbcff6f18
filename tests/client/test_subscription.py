"""The client against a publisher that speaks the protocol."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import zmq

import culet_client.view as viewing
from client.frames import FRAME, SESSION
from culet_client import ClientError, FrameSubscription, SilenceError
from culet_client.frame_folder import INDEX, FrameFolder
from culet_client.view import record, view
from culet_protocol.frame import Codec, Frame
from shared.patience import PATIENCE


class Publisher:
    """An XPUB as the engine's."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.XPUB)
        self.socket.setsockopt(zmq.XPUB_VERBOSE, 1)
        self.socket.bind(endpoint)

    def subscription(self) -> bytes:
        """The next one that comes or goes."""
        assert self.socket.poll(int(PATIENCE * 1000)), "nobody subscribed"
        return self.socket.recv()

    def send(self, *sequences: int) -> None:
        """Frames of these numbers."""
        for sequence in sequences:
            self.socket.send(replace(FRAME, sequence=sequence).pack())

    def greet(self) -> threading.Thread:
        """Send frame 1 as soon as somebody subscribes."""

        def greet() -> None:
            self.subscription()
            self.send(1)

        thread = threading.Thread(target=greet)
        thread.start()
        return thread


@pytest.fixture
def publisher(tmp_path: Path) -> Iterator[Publisher]:
    found = Publisher(f"ipc://{tmp_path}/frames")
    yield found
    found.context.destroy(linger=0)


def test_a_subscription_names_the_session_and_ends_with_it(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION):
        assert publisher.subscription() == b"\x01" + bytes.fromhex(SESSION)
    assert publisher.subscription() == b"\x00" + bytes.fromhex(SESSION)


def test_a_frame_arrives_as_it_was_sent(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION) as subscription:
        publisher.subscription()
        publisher.send(1)
        assert subscription.receive() == FRAME


def test_who_wants_every_frame_gets_every_frame(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION, latest_only=False) as subscription:
        publisher.subscription()
        publisher.send(*range(1, 21))
        assert [subscription.receive().sequence for _ in range(20)] == list(range(1, 21))


def test_who_is_slow_gets_the_latest_and_is_never_behind(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION) as subscription:
        publisher.subscription()
        publisher.send(*range(1, 501))
        received = [subscription.receive().sequence]
        while received[-1] != 500:
            received.append(subscription.receive().sequence)
        assert received == sorted(set(received))
        assert len(received) < 500


def test_other_sessions_frames_do_not_come(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION) as subscription:
        publisher.subscription()
        publisher.socket.send(replace(FRAME, watch=bytes(16)).pack())
        publisher.send(7)
        assert subscription.receive().sequence == 7


def test_silence_and_nonsense_are_told_apart(publisher: Publisher) -> None:
    with FrameSubscription(publisher.endpoint, SESSION) as subscription:
        publisher.subscription()
        with pytest.raises(SilenceError, match=r"in 0\.01 s"):
            subscription.receive(0.01)
        publisher.socket.send(bytes.fromhex(SESSION) + b"nonsense")
        with pytest.raises(ClientError, match="something else than a frame"):
            subscription.receive()


@pytest.mark.parametrize("session", ["", "xyz", SESSION.upper(), SESSION + "00"])
def test_an_id_that_is_none_is_refused(session: str) -> None:
    with pytest.raises(ClientError, match="32 hexadecimal digits"):
        FrameSubscription("tcp://127.0.0.1:1", session)


def test_an_address_that_is_none_is_refused() -> None:
    with pytest.raises(ClientError, match="cannot connect"):
        FrameSubscription("the engine", SESSION)


def test_frames_become_files_with_an_index(tmp_path: Path) -> None:
    folder = FrameFolder(tmp_path / "new" / "folder")
    assert folder.write(FRAME).read_bytes() == b"picture"
    assert folder.write(replace(FRAME, codec=Codec.PNG)).name == "frame-000002.png"
    first, _ = (json.loads(line) for line in (folder.folder / INDEX).read_text().splitlines())
    assert (first["file"], first["step"], first["codec"], first["watch"]) == ("frame-000001.jpg", 9, "JPEG", SESSION)


def test_a_folder_that_cannot_be_made_is_said_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ClientError, match="cannot make the folder"):
        FrameFolder(tmp_path / "file" / "folder")


def test_viewing_counts_frames(publisher: Publisher, tmp_path: Path) -> None:
    sequences: list[int] = []

    def one_more(frame: Frame, _: Path) -> None:
        greeter.join()  # a socket is one thread's at a time
        sequences.append(frame.sequence)
        publisher.send(frame.sequence + 1)

    greeter = publisher.greet()
    assert view(publisher.endpoint, SESSION, 3, tmp_path / "out", shown=one_more) == 3
    assert sequences == [1, 2, 3]


def test_recording_writes_a_repeated_frame_once(
    publisher: Publisher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its time is over, by a clock of this test, when the last frame has come."""
    sequences: list[int] = []
    now = [0.0]
    monkeypatch.setattr(viewing, "time", SimpleNamespace(monotonic=lambda: now[0]))

    def some_more(frame: Frame, _: Path) -> None:
        greeter.join()
        sequences.append(frame.sequence)
        if frame.sequence == 1:
            publisher.send(1, 1, 2, 2, 3)
        if frame.sequence == 3:
            now[0] = PATIENCE

    greeter = publisher.greet()
    assert record(publisher.endpoint, SESSION, PATIENCE, tmp_path / "out", shown=some_more) == 3
    assert sequences == [1, 2, 3]


TAKER = """
import sys, time
from culet_client import FrameSubscription
with FrameSubscription(*sys.argv[1:], latest_only=False) as subscription:
    for _ in range(80):
        subscription.receive()
    time.sleep(10)
    for _ in range(80):
        subscription.receive()
"""


@pytest.mark.soak
def test_a_taker_that_pauses_while_frames_wait_is_not_ended_by_zeromq() -> None:
    """With ZeroMQ's heartbeats, 16 of 16 processes were aborted after pauses of 9 and 14 s; only on tcp."""
    publisher = Publisher("tcp://127.0.0.1:*")
    endpoint = publisher.socket.getsockopt(zmq.LAST_ENDPOINT)
    assert isinstance(endpoint, bytes)
    ended = threading.Event()

    def publish() -> None:
        frame = replace(FRAME, payload=bytes(20_000)).pack()
        while not ended.wait(1 / 60):
            publisher.socket.send(frame)

    publishing = threading.Thread(target=publish)
    publishing.start()
    try:
        command = [sys.executable, "-c", TAKER, endpoint.decode(), SESSION]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    finally:
        ended.set()
        publishing.join()
        publisher.context.destroy(linger=0)
    assert (done.returncode, done.stderr) == (0, "")

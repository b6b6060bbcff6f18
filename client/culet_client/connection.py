"""Watching and steering a session, whichever way leads to it."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from typing import Any, Self
from urllib.parse import parse_qs, urlsplit

from pydantic import ValidationError

from culet_client.engine_control import EngineControl
from culet_client.errors import ClientError, RefusedError
from culet_client.image import Image
from culet_client.rest import Rest
from culet_client.stream import ControlStream
from culet_client.subscription import FrameSubscription
from culet_client.video import VideoDecoder, asked_of, decoders
from culet_protocol.engine import CloseSession, Control, Demand, OpenSession
from culet_protocol.frame import Frame
from culet_protocol.messages import FASTEST_RATE, Decoders, Hello, Message, Problem, Resize, SessionEvent
from culet_protocol.watch import VIDEO, watch_id

ZEROMQ = ("tcp", "ipc")
MOST_FAILURES = 2
"""Of decoding, after which pictures are JPEG."""
ONLY_LOOKS = "by a watch id one may look, and not steer: connect by the session's own id"


class Connection(ABC):
    """A session that is watched, and steered unless by its watch id alone. Iterate over it for its pictures.

    Of one thread at a time. Close it, or use it in a `with`: a session that `connect` made is forgotten then.
    """

    session: str | None
    """Its id; None where only the watch id is known."""
    notices: list[Message]
    """What the server said between the last two pictures: the session's scene and changes to it, how many watch. Over
    ZeroMQ nothing is said."""

    @abstractmethod
    def send(self, event: SessionEvent | Resize) -> None:
        """Tell the session something, such as `culet_protocol.messages.Orbit(yaw=0.1, pitch=0)`, or how large the
        pictures are to be (`Resize`).

        Over ZeroMQ a RefusedError comes at once, over WebSocket from the next `image`.
        """

    @abstractmethod
    def image(self, timeout_seconds: float | None = None) -> Image:
        """The next picture, decoded; one at rest is refined until it is final, and comes no more over WebSocket then.

        SilenceError if none comes in that time, RefusedError if an event was refused, ClientError if the server ended
        the connection.
        """

    @abstractmethod
    def close(self) -> None:
        """Leave."""

    def __iter__(self) -> Iterator[Image]:
        """Pictures as they come, until the server ends the connection or is silent, which raises as `image` does."""
        while True:
            yield self.image()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def connect(
    url: str,
    *,
    session: str | None = None,
    watch: str | None = None,
    scene: dict[str, Any] | None = None,
    preset: str | None = None,
    control: str | None = None,
    token: str | None = None,
    size: tuple[int, int] | None = None,
    video: bool = True,
    keys: Path | None = None,
    timeout_seconds: float = 10,
) -> Connection:
    """Watch a session, and steer it.

    Args:
        url: the server, `http://127.0.0.1:8000`, or a session's page, `http://127.0.0.1:8000/?session=...` or, for
            looking alone, `?watch=...`: everything travels by WebSocket. Or where an engine publishes frames,
            `tcp://127.0.0.1:5556` or `ipc://...`: frames travel by ZeroMQ, always the latest.
        session: the session's id, where `url` does not have it. With neither a new session is made, and forgotten when
            the connection is closed.
        watch: a session's watch id in the place of its id: by that one may look and not steer.
        scene: what a new session shows, JSON as everywhere; without it the default scene.
        preset: what a new session shows instead, by a preset's name; over ZeroMQ only by way of a gateway.
        control: over ZeroMQ: where events go, the engine's own socket (`--control` of `culet engine`) or the gateway's
            address (`http://...`); without it one can only look.
        token: the server's, where it has one and a new session is to be made. `url` may have it too, `#token=...`, as
            culet prints it; without either the variable CULET_TOKEN counts.
        size: width and height that pictures should have, pixels, at most; those that were on their way already may be
            larger.
        video: by WebSocket, take what moves as video where the server makes some and PyAV is installed here: half the
            bytes. Else each picture is a JPEG, over ZeroMQ always; what is at rest ends with a PNG, if the link
            carries it.
        keys: over ZeroMQ to another machine, the folder of this client's keys, as `culet keys` makes it; without it the
            one that the variable CULET_KEYS names.
        timeout_seconds: for whatever is waited for, unless `image` is told otherwise.

    Raises:
        ClientError: for an address or an id that is none, or a server that is not there. RefusedError and SilenceError
            are kinds of it.
    """
    if scene is not None and preset is not None:
        raise ClientError("expected a scene or a preset, got both")
    scheme = urlsplit(url).scheme
    if scheme in ZEROMQ:
        token = token or os.environ.get("CULET_TOKEN") or None
        return _OverZeroMq(url, session, watch, scene, preset, control, token, size, keys, timeout_seconds)
    if control is not None:
        raise ClientError(f"control: expected with an engine's frames, such as tcp://127.0.0.1:5556; got {url!r}")
    if session is not None and watch is not None:
        raise ClientError("expected a session or its watch id, got both")
    query, entrance = parse_qs(urlsplit(url).query), parse_qs(urlsplit(url).fragment)
    if session is None and watch is None:
        session, watch = query.get("session", [None])[0], query.get("watch", [None])[0]
    token = token or entrance.get("token", [None])[0] or os.environ.get("CULET_TOKEN") or None
    return _OverWebSocket(url, session, watch, scene, preset, token, size, video, timeout_seconds)


class _OverWebSocket(Connection):
    def __init__(
        self,
        url: str,
        session: str | None,
        watch: str | None,
        scene: dict[str, Any] | None,
        preset: str | None,
        token: str | None,
        size: tuple[int, int] | None,
        video: bool,
        timeout_seconds: float,
    ) -> None:
        self.notices = []
        self._timeout = timeout_seconds
        self._video = video
        self._decoder = VideoDecoder()
        self._failures = 0
        rest = Rest(url, timeout_seconds, token)
        with ExitStack() as opened:
            self.session = session
            if session is None and watch is None:
                self.session = _made(rest, scene, preset, opened)
            named = self.session or watch or ""
            self._stream = opened.enter_context(ControlStream(rest.server, named, timeout_seconds=timeout_seconds))
            if size is not None:
                self.send(_resize(size))
            self._opened = opened.pop_all()

    def send(self, event: SessionEvent | Resize) -> None:
        if self.session is None and not isinstance(event, Resize):
            raise ClientError(ONLY_LOOKS)
        self._stream.send(event)

    def image(self, timeout_seconds: float | None = None) -> Image:
        self.notices.clear()
        while True:
            message = self._stream.receive(self._timeout if timeout_seconds is None else timeout_seconds)
            if isinstance(message, Frame):
                if (image := self._decoded(message)) is not None:
                    return image
                continue
            if isinstance(message, Hello) and self._video and (asked := asked_of(message)) is not None:
                self._stream.send(asked)
            if isinstance(message, Problem):
                raise RefusedError(message.message, message.field)
            self.notices.append(message)

    def _decoded(self, frame: Frame) -> Image | None:
        """None of video that needs a frame which is missing."""
        if frame.codec not in VIDEO:
            return Image.of(frame)
        try:
            pixels = self._decoder.decode(frame)
        except ClientError:
            self._failures += 1
            self._stream.send(Decoders(codecs=decoders() if self._failures < MOST_FAILURES else ()))
            return None
        return None if pixels is None else Image.checked(frame, pixels)

    def close(self) -> None:
        self._opened.close()


class _OverZeroMq(Connection):
    def __init__(
        self,
        endpoint: str,
        session: str | None,
        watch: str | None,
        scene: dict[str, Any] | None,
        preset: str | None,
        control: str | None,
        token: str | None,
        size: tuple[int, int] | None,
        keys: Path | None,
        timeout_seconds: float,
    ) -> None:
        self.notices = []
        self._timeout = timeout_seconds
        if session is None and watch is None and control is None:
            raise ClientError("expected a session, its watch id, or a control address to make a session by; got none")
        if session is not None and watch is not None:
            raise ClientError("expected a session or its watch id, got both")
        self._rest = (
            Rest(control, timeout_seconds, token) if control and urlsplit(control).scheme not in ZEROMQ else None
        )
        self._engine = EngineControl(control, timeout_seconds, keys) if control and self._rest is None else None
        with ExitStack() as opened:
            self.session = session
            if session is None and watch is None:
                self.session = self._make_session(scene, preset, opened)
            watched = watch if self.session is None else watch_id(_checked(self.session))
            self._subscription = opened.enter_context(FrameSubscription(endpoint, watched or "", keys=keys))
            if size is not None:
                self.send(_resize(size))
            self._opened = opened.pop_all()

    def send(self, event: SessionEvent | Resize) -> None:
        if self.session is None:
            raise ClientError(ONLY_LOOKS)
        if isinstance(event, Resize):
            if self._engine is None:
                raise ClientError("over ZeroMQ the size is the engine's to be told: connect with its `control` socket")
            self._engine.ask(
                Demand(session=self.session, frames_per_second=FASTEST_RATE, width=event.width, height=event.height)
            )
        elif self._engine is not None:
            self._engine.ask(Control(session=self.session, event=event))
        elif self._rest is not None:
            self._rest.tell(self.session, event)
        else:
            raise ClientError("nobody to tell: connect with `control`, the engine's socket or the gateway's address")

    def image(self, timeout_seconds: float | None = None) -> Image:
        return Image.of(self._subscription.receive(self._timeout if timeout_seconds is None else timeout_seconds))

    def close(self) -> None:
        self._opened.close()

    def _make_session(self, scene: dict[str, Any] | None, preset: str | None, opened: ExitStack) -> str:
        if self._rest is not None:
            return _made(self._rest, scene, preset, opened)
        assert self._engine is not None  # noqa: S101 - or there is no control
        if preset is not None:
            raise ClientError("preset: the engine knows none by name; give a scene, or a gateway's address as control")
        session = os.urandom(16).hex()
        self._engine.ask(OpenSession(session=session, scene=scene or {}))
        opened.callback(_quietly, partial(self._engine.ask, CloseSession(session=session)))
        return session


def _made(rest: Rest, scene: dict[str, Any] | None, preset: str | None, opened: ExitStack) -> str:
    """A session that is forgotten when `opened` is closed."""
    session = rest.make_session(scene, preset)
    opened.callback(_quietly, partial(rest.forget_session, session))
    return session


def _quietly(forget: Callable[[], object]) -> None:
    """A server that is gone has forgotten the session by itself."""
    with suppress(ClientError):
        forget()


def _resize(size: tuple[int, int]) -> Resize:
    width, height = size
    try:
        return Resize(width=width, height=height)
    except ValidationError as error:
        raise ClientError(f"size: expected 16 to 8192 pixels each way, got {width} x {height}") from error


def _checked(session: str) -> str:
    try:
        if len(bytes.fromhex(session)) == 16:
            return session
    except ValueError:
        pass
    raise ClientError(f"a session's id has 32 hexadecimal digits, got {session!r}")

"""Receiving frames: a few, or all of some time; into a folder, or as a film."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol
from urllib.parse import urlsplit

from culet_client.errors import ClientError, SilenceError
from culet_client.frame_folder import FrameFolder
from culet_client.stream import ControlStream
from culet_client.subscription import FrameSubscription
from culet_protocol.frame import Frame
from culet_protocol.messages import Resize

Shown = Callable[[Frame, Path], None]
"""Called with every frame and the file that it went to."""
ZEROMQ = ("tcp", "ipc")
FILM_SIZE = 1280, 720
"""Pixels of a film, unless somebody says otherwise."""


class FrameSource(Protocol):
    """Whence frames come."""

    def receive(self, timeout_seconds: float) -> Frame:
        """The next one; SilenceError if none comes in that time."""


class FrameStream:
    """Frames of a session's WebSocket; what else comes by it is not heeded."""

    def __init__(self, server: str, session: str, timeout_seconds: float, size: tuple[int, int] | None = None) -> None:
        """By the session's id or watch id; `size` is what this viewer asks for, pixels."""
        self._stream = ControlStream(server, session, timeout_seconds=timeout_seconds)
        if size is not None:
            self._stream.send(Resize(width=size[0], height=size[1]))

    def receive(self, timeout_seconds: float) -> Frame:
        """The next frame; SilenceError if none comes in that time."""
        end = time.monotonic() + timeout_seconds
        while True:
            message = self._stream.receive(max(0.0, end - time.monotonic()))
            if isinstance(message, Frame):
                return message

    def __enter__(self) -> FrameStream:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()


def frames_of(
    address: str, watched: str, timeout_seconds: float, size: tuple[int, int] | None = None
) -> AbstractContextManager[FrameSource]:
    """Every frame of a session, by its watch id, or its id where a gateway is asked: from where an engine publishes
    frames (`tcp://`, `ipc://`), or by WebSocket from a server (`http://`, `ws://`, and with an s)."""
    if urlsplit(address).scheme in ZEROMQ:
        return FrameSubscription(address, watched, latest_only=False)
    parts = urlsplit(address)
    return FrameStream(parts._replace(query="", fragment="").geturl(), watched, timeout_seconds, size)


def view(
    endpoint: str, watch: str, frames: int, folder: Path, *, timeout_seconds: float = 10, shown: Shown | None = None
) -> int:
    """Write the next frames, each the latest when it is taken; the number written.

    A picture at rest comes again, ever more rarely, and counts each time. SilenceError if none comes in the time
    allowed.
    """
    target = FrameFolder(folder)
    with FrameSubscription(endpoint, watch) as subscription:
        while target.count < frames:
            frame = subscription.receive(timeout_seconds)
            path = target.write(frame)
            if shown:
                shown(frame, path)
    return target.count


def record(
    address: str,
    watched: str,
    seconds: float,
    folder: Path,
    *,
    timeout_seconds: float = 10,
    size: tuple[int, int] | None = None,
    shown: Shown | None = None,
) -> int:
    """Write every frame that comes in some seconds, counted from the first, once each; the number written.

    With a `size` all pictures have that many pixels, and are PNGs: those of another size are scaled. Else files are as
    they came. SilenceError if not even one comes in the time allowed.
    """
    target = FrameFolder(folder)
    with frames_of(address, watched, timeout_seconds, size) as source:
        for frame, _ in recorded(source, seconds, timeout_seconds):
            path = target.write(frame if size is None else _resized(frame, size))
            if shown:
                shown(frame, path)
    return target.count


def record_film(
    address: str,
    watched: str,
    seconds: float,
    path: Path,
    *,
    timeout_seconds: float = 10,
    size: tuple[int, int] = FILM_SIZE,
    chroma: str = "444",
) -> int:
    """As `record`, into an MP4; what was recorded until an interruption is kept. Needs PyAV."""
    from culet_client.film import Film
    from culet_client.image import Image

    if chroma not in ("444", "420"):
        raise ClientError(f"expected a chroma of 444 or 420, got {chroma!r}")
    film = Film(path, size, "444" if chroma == "444" else "420")
    began, now = None, 0.0
    try:
        with frames_of(address, watched, timeout_seconds, film.size) as source:
            try:
                for frame, at in recorded(source, seconds, timeout_seconds):
                    began = at if began is None else began
                    now = at - began
                    film.add(Image.of(frame), now)
                now = seconds
            except KeyboardInterrupt:
                if began is None:
                    raise
        film.finish(now)
    finally:
        film.discard()
    return film.count


def recorded(source: FrameSource, seconds: float, timeout_seconds: float) -> Iterator[tuple[Frame, float]]:
    """Every frame that comes in some seconds, counted from the first, once each, and when it came, s."""
    frame = source.receive(timeout_seconds)
    end = time.monotonic() + seconds
    last: int | None = None
    while True:
        if frame.sequence != last:
            last = frame.sequence
            yield frame, time.monotonic()
        try:
            frame = source.receive(max(0.0, end - time.monotonic()))
        except SilenceError:
            return
        if time.monotonic() >= end:
            return


def _resized(frame: Frame, size: tuple[int, int]) -> Frame:
    """As a PNG of that size."""
    import io
    from dataclasses import replace

    import PIL.Image

    from culet_client.film import fitted
    from culet_client.image import Image
    from culet_protocol.frame import Codec

    if (frame.width, frame.height) == size and frame.codec is Codec.PNG:
        return frame
    file = io.BytesIO()
    PIL.Image.fromarray(fitted(Image.of(frame).pixels, size)).save(file, "PNG")
    return replace(frame, codec=Codec.PNG, width=size[0], height=size[1], payload=file.getvalue())

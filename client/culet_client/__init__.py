"""The thin Python client: frames and control events over WebSocket and ZeroMQ. It needs the protocol, not the server.

    import culet_client
    from culet_protocol.messages import ToggleFall

    with culet_client.connect("http://127.0.0.1:8000", preset="falling") as session:
        session.send(ToggleFall())
        for image in session:
            print(image.frame.step, image.pixels.mean())

What a name needs is imported when the name is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from culet_client.connection import Connection, connect
    from culet_client.errors import ClientError, RefusedError, SilenceError
    from culet_client.image import Image
    from culet_client.stream import ControlStream
    from culet_client.subscription import FrameSubscription

_HOMES = {
    "Connection": "connection",
    "connect": "connection",
    "ClientError": "errors",
    "RefusedError": "errors",
    "SilenceError": "errors",
    "Image": "image",
    "ControlStream": "stream",
    "FrameSubscription": "subscription",
}
"""The modules that the names come from."""

__all__ = [
    "ClientError", "Connection", "ControlStream", "FrameSubscription", "Image", "RefusedError", "SilenceError",
    "connect",
]  # fmt: skip


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'culet_client' has no attribute {name!r}")
    found = getattr(import_module(f"culet_client.{_HOMES[name]}"), name)
    globals()[name] = found
    return found

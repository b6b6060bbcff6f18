"""The thin Python client: frames over ZeroMQ, control over WebSocket. It needs the protocol only, not the server."""

from culet_client.errors import ClientError, SilenceError
from culet_client.stream import ControlStream
from culet_client.subscription import FrameSubscription

__all__ = ["ClientError", "ControlStream", "FrameSubscription", "SilenceError"]

"""Requests to an engine's own control socket, as a gateway makes them."""

from __future__ import annotations

import itertools
import time
from pathlib import Path

import zmq
from pydantic import ValidationError

from culet_client.errors import ClientError, RefusedError, SilenceError
from culet_client.key_folder import checked_keys
from culet_protocol.engine import REQUEST_NUMBER, Reply, engine_message
from culet_protocol.messages import Message


class EngineControl:
    """The ROUTER of an engine. Each request has a connection of its own: on one that stayed open the engine would tell
    things that nobody here reads."""

    def __init__(self, endpoint: str, timeout_seconds: float, keys: Path | None = None) -> None:
        """The engine with that endpoint of control, such as `ipc:///tmp/culet.control`; `keys` as for frames."""
        self._keys = checked_keys(endpoint, keys)
        self.endpoint = endpoint
        self._timeout = timeout_seconds
        self._numbers = itertools.count(1)

    def ask(self, request: Message) -> Reply:
        """The reply; RefusedError for one that says no, SilenceError, ClientError for an address that is none."""
        number = REQUEST_NUMBER.pack(next(self._numbers))
        with zmq.Context() as context, context.socket(zmq.DEALER) as socket:
            socket.setsockopt(zmq.LINGER, 0)
            if self._keys is not None:
                self._keys.apply(socket, self.endpoint)
            try:
                socket.connect(self.endpoint)
            except zmq.ZMQError as error:
                raise ClientError(
                    f"cannot connect to {self.endpoint!r}: {error}; expected such as ipc:///tmp/culet.control"
                ) from error
            socket.send_multipart([number, request.model_dump_json().encode()])
            reply = self._reply(socket, number)
        if reply.status >= 400:
            raise RefusedError(f"{reply.title}: {reply.detail}", reply.field)
        return reply

    def _reply(self, socket: zmq.Socket[bytes], number: bytes) -> Reply:
        """Among what the engine tells unasked."""
        end = time.monotonic() + self._timeout
        while socket.poll(max(0, round((end - time.monotonic()) * 1000))):
            parts = socket.recv_multipart()
            if len(parts) < 2 or parts[0] != number:
                continue
            try:
                reply = engine_message.validate_json(parts[1])
            except ValidationError as error:
                raise ClientError(f"{self.endpoint} sent something that is not understood: {error}") from error
            if isinstance(reply, Reply):
                return reply
        raise SilenceError(f"no answer from the engine at {self.endpoint} in {self._timeout:g} s; is it there?")

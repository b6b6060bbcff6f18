"""Who may connect to the engine from other machines: those whose public keys it has."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import zmq
import zmq.asyncio
from zmq.auth.thread import ThreadAuthenticator

from culet.errors import InputError
from culet_protocol.keys import EngineKeys, KeysError


def engine_keys(folder: Path | None) -> EngineKeys | None:
    """The engine's keys, if it was given some; InputError for what is no engine's folder."""
    try:
        return None if folder is None else EngineKeys.read(folder)
    except KeysError as error:
        raise InputError(f"--keys: {error}", "keys") from error


@contextlib.contextmanager
def letting_in(context: zmq.asyncio.Context, keys: EngineKeys | None) -> Iterator[None]:
    """Answer ZeroMQ's questions who may connect (ZAP, rfc.zeromq.org/spec/27), by a thread of its own: a picture that
    is being encoded keeps nobody waiting."""
    if keys is None:
        yield
        return
    doorkeeper = ThreadAuthenticator(zmq.Context.shadow(context.underlying))
    doorkeeper.start()
    try:
        doorkeeper.configure_curve(domain="*", location=keys.allowed)
        yield
    finally:
        doorkeeper.stop()

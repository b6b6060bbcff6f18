"""The address that a gateway listens on."""

from __future__ import annotations

import socket

from culet.errors import InputError

BACKLOG = 1024
"""Connections that wait to be accepted; for as long as a gateway takes to start, if one has died."""


def listening_socket(host: str, port: int) -> socket.socket:
    """A socket that connections reach from now on; InputError if the address cannot be had. `port` 0 is a free one."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # By IPPROTO_TCP asyncio knows that TCP_NODELAY can be set: else an answer's head and body wait for each other.
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen(BACKLOG)
    except (OSError, OverflowError) as error:
        listening.close()
        raise InputError(f"cannot listen on {host} port {port}: {error}; choose another with --port", "port") from error
    return listening


def url_of(listening: socket.socket, host: str) -> str:
    """Where a browser finds it."""
    shown = f"[{host}]" if listening.family == socket.AF_INET6 else host
    return f"http://{shown}:{listening.getsockname()[1]}/"


def entrance(url: str, token: str | None) -> str:
    """The URL by which a browser gets the token, which it keeps to itself: what follows the # is sent nowhere."""
    return url if token is None else f"{url}#token={token}"


def local_url_of(listening: socket.socket, host: str) -> str:
    """Where a browser of this machine finds it: nobody can go to the address that stands for all of them."""
    anywhere = {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}  # noqa: S104 - what was asked for
    return url_of(listening, anywhere.get(host, host))

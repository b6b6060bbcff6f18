"""Where processes of culet listen for each other by ZeroMQ: `ipc://` and a path, or `tcp://`, an address and a port."""

from __future__ import annotations

import errno
import re
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import zmq

from culet.errors import InputError

FORMS = "expected ipc:// and the path of a socket, such as ipc:///tmp/culet.control, or tcp://ADDRESS:PORT"
_TCP = re.compile(r"tcp://(?P<address>[^/]+):(?P<port>\d{1,5}|\*)")
KEEP_ALIVE = (
    (zmq.TCP_KEEPALIVE, 1),
    (zmq.TCP_KEEPALIVE_IDLE, 5),
    (zmq.TCP_KEEPALIVE_INTVL, 5),
    (zmq.TCP_KEEPALIVE_CNT, 3),
)
"""A machine that vanished without a word is noticed by the kernel: 5 s of silence, and three questions 5 s apart."""
_HIGHEST_PORT = 65535
"""ZeroMQ itself takes what is above for the port of its lower 16 bits."""


def bind(socket: zmq.Socket[Any], endpoint: str, option: str) -> None:
    """Listen there; InputError that names the option, what was asked for, what is wrong and what to do."""
    try:
        _check(endpoint)
        socket.bind(endpoint)
    except InputError as error:
        raise InputError(f"--{option}: cannot listen at {endpoint!r}: {error}", option) from None
    except zmq.ZMQError as error:
        raise InputError(f"--{option}: cannot listen at {endpoint!r}: {_reason(error)}", option) from error


REACHED = {
    "frames": "sees every session that is watched and its id for watching, by which nothing can be changed",
    "control": "sees, changes and deletes every session",
}
"""What whoever reaches an endpoint does, by the option that names the endpoint."""


def check_trusted(endpoint: str, option: str, *, trusted: bool) -> None:
    """InputError for an endpoint of REACHED that other machines can reach too, unless their network is trusted."""
    parts = _TCP.fullmatch(endpoint)
    if trusted or parts is None or is_loopback(parts["address"]):
        return
    raise InputError(
        f"--{option}: other machines reach {endpoint!r}, and whoever does {REACHED[option]}; --keys lets in those "
        "who have keys (`culet keys` makes some), --trust-network anybody, tcp://127.0.0.1:PORT this machine alone",
        option,
    )


def tcp_address(endpoint: str) -> str | None:
    """The address or name of a machine, if the endpoint has one."""
    parts = _TCP.fullmatch(endpoint)
    return None if parts is None else parts["address"]


def is_loopback(address: str) -> bool:
    """Whether only this machine reaches it."""
    if address in ("localhost", "lo"):
        return True
    try:
        return ip_address(address.strip("[]")).is_loopback
    except ValueError:  # *, or the name of another interface
        return False


def check_free(endpoint: str, option: str) -> None:
    """InputError if nothing can be bound there."""
    with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
        bind(socket, endpoint, option)


def reachable(endpoint: str) -> str:
    """The endpoint to connect to, for one that was bound on every interface."""
    return endpoint.replace("tcp://*:", "tcp://127.0.0.1:").replace("tcp://0.0.0.0:", "tcp://127.0.0.1:")


def keep_alive(socket: zmq.Socket[Any]) -> None:
    """Have the kernel look after a socket's tcp connections; without effect on those of one machine (ipc)."""
    for option, value in KEEP_ALIVE:
        socket.setsockopt(option, value)


def _check(endpoint: str) -> None:
    """InputError for what ZeroMQ would refuse in fewer words, take for something else, or overwrite."""
    if endpoint.startswith("tcp://"):
        parts = _TCP.fullmatch(endpoint)
        if parts is None or (parts["port"] != "*" and int(parts["port"]) > _HIGHEST_PORT):
            raise InputError(FORMS)
        return
    path = endpoint.removeprefix("ipc://")
    if path in (endpoint, ""):
        raise InputError(FORMS)
    if path.startswith("@"):  # Linux's abstract names, which are no files
        return
    if len(path.encode()) > zmq.IPC_PATH_MAX_LEN:
        raise InputError(f"a socket's path may have {zmq.IPC_PATH_MAX_LEN} bytes, and this has {len(path.encode())}")
    place = Path(path)
    if not place.parent.is_dir():
        raise InputError(f"there is no folder {place.parent}; make it, or choose another")
    if place.exists() and not place.is_socket():
        raise InputError("that is there already, and is not a socket; choose another name")


def _reason(error: zmq.ZMQError) -> str:
    match error.errno:
        case errno.EADDRINUSE:
            return "another program listens there; end it, or choose another port"
        case errno.EADDRNOTAVAIL | errno.ENODEV:
            return "this machine has no such address; tcp://127.0.0.1:PORT serves itself, tcp://*:PORT others too"
        case errno.EACCES | errno.EPERM | errno.EROFS:
            return "permission denied; choose another place"
        case _:
            return f"{str(error).partition(' (addr=')[0]}; {FORMS}"

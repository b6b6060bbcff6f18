"""Keys by which processes on several machines know each other over ZeroMQ: CURVE (rfc.zeromq.org/spec/26) encrypts too.

Each machine has a folder of its own: the engine's with its secret and the public keys that it lets in, a client's (a
gateway's, a viewer's) with its own secret and the engine's public key. What is on one machine (`ipc://`) needs none:
the permissions of the socket's file tell who may.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import zmq
import zmq.auth

ENGINE, ALLOWED = "engine", "allowed"
OWN = "own"
NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,31}")
VARIABLE = "CULET_KEYS"
"""Environment variable that names a client's folder."""


class KeysError(ValueError):
    """Keys that cannot be read or made; says which file, and what to do."""


@dataclass(frozen=True)
class ClientKeys:
    """Of a gateway or a viewer. Each key is 40 characters of Z85."""

    public: bytes
    secret: bytes = field(repr=False)
    engine: bytes
    """The engine's public key: whoever has not its secret is not talked to."""

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Of a folder that `make_keys` made for a client; KeysError."""
        public, secret = _own(folder)
        return cls(public, secret, _public(folder / f"{ENGINE}.key"))

    def apply(self, socket: zmq.Socket[Any], endpoint: str) -> None:
        """Before the socket connects there; without effect on endpoints of one machine."""
        if endpoint.startswith("tcp://"):
            socket.curve_publickey, socket.curve_secretkey, socket.curve_serverkey = (
                self.public,
                self.secret,
                self.engine,
            )


@dataclass(frozen=True)
class EngineKeys:
    """Of an engine."""

    secret: bytes = field(repr=False)
    allowed: Path
    """Folder of the public keys of those who may connect."""

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Of the folder that `make_keys` made for the engine; KeysError."""
        _, secret = _own(folder)
        if not (folder / ALLOWED).is_dir():
            raise KeysError(f"{folder} is no engine's folder of keys: there is no {folder / ALLOWED}")
        for file in (folder / ALLOWED).glob("*.key"):
            _public(file)
        return cls(secret, folder / ALLOWED)

    def apply(self, socket: zmq.Socket[Any], endpoint: str) -> None:
        """Before the socket listens there; endpoints of one machine stay as they are."""
        socket.curve_server = endpoint.startswith("tcp://")
        if endpoint.startswith("tcp://"):
            socket.curve_secretkey = self.secret


def keys_of(endpoint: str, folder: Path | None) -> ClientKeys | None:
    """A client's, for an endpoint that other machines may have; of the folder that CULET_KEYS names, if not of another.
    KeysError."""
    if not endpoint.startswith("tcp://"):
        return None
    named = folder or (Path(os.environ[VARIABLE]) if os.environ.get(VARIABLE) else None)
    return None if named is None else ClientKeys.read(named)


def make_keys(folder: Path, clients: Sequence[str]) -> list[Path]:
    """A folder for the engine, if there is none yet, and one for each new client, that the engine lets in; those that
    were made. KeysError for a name that is none, or whose folder is there: no key is written over."""
    for name in clients:
        if NAME.fullmatch(name) is None or name in (ENGINE, ALLOWED):
            raise KeysError(f"expected a name of small letters, digits and -, which is not {ENGINE!r}; got {name!r}")
        if (folder / name).exists():
            raise KeysError(f"{folder / name} is there already; remove it for new keys")
    before = os.umask(0o077)  # a secret is its owner's from its first byte on
    try:
        made = []
        engine = folder / ENGINE
        if not engine.exists():
            (engine / ALLOWED).mkdir(parents=True)
            zmq.auth.create_certificates(engine, OWN)
            made.append(engine)
        for name in clients:
            own = folder / name
            own.mkdir(parents=True)
            zmq.auth.create_certificates(own, OWN)
            (own / f"{ENGINE}.key").write_bytes((engine / f"{OWN}.key").read_bytes())
            _allowed(folder, name).write_bytes((own / f"{OWN}.key").read_bytes())
            made.append(own)
    finally:
        os.umask(before)
    return made


def _allowed(folder: Path, name: str) -> Path:
    return folder / ENGINE / ALLOWED / f"{name}.key"


def _own(folder: Path) -> tuple[bytes, bytes]:
    file = folder / f"{OWN}.key_secret"
    try:
        mode = file.stat().st_mode
        public, secret = zmq.auth.load_certificate(file)
    except (OSError, ValueError) as error:
        raise KeysError(f"cannot read the secret key {file}: {error}; `culet keys` makes such folders") from error
    if mode & 0o077:
        raise KeysError(f"{file} can be read by others than its owner: run `chmod 600 {file}`")
    if secret is None:
        raise KeysError(f"{file} holds no secret key; `culet keys` makes such folders")
    return public, secret


def _public(file: Path) -> bytes:
    try:
        return zmq.auth.load_certificate(file)[0]
    except (OSError, ValueError) as error:
        raise KeysError(f"cannot read the public key {file}: {error}; `culet keys` makes such folders") from error

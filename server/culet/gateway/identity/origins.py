"""Names of this server and pages of others: what Host and Origin of a request say, and whom to let in by them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from ipaddress import ip_address
from typing import NamedTuple

from starlette.datastructures import Headers
from starlette.types import Scope

_NAME = r"(?P<name>\[[0-9a-f:.]+\]|[a-z0-9_]([a-z0-9_.-]*[a-z0-9_])?)\.?(:(?P<port>\d{1,5}))?"
_HOST = re.compile(_NAME)
_ORIGIN = re.compile(rf"(?P<scheme>https?)://{_NAME}")
_DEFAULT_PORTS = {"http": 80, "https": 443}
_LOOPBACK_NAME = "localhost"


class Origin(NamedTuple):
    """Where a page comes from (RFC 6454)."""

    scheme: str
    name: str
    port: int

    def __str__(self) -> str:
        port = "" if self.port == _DEFAULT_PORTS[self.scheme] else f":{self.port}"
        return f"{self.scheme}://{self.name}{port}"


def read_origin(text: str) -> Origin | None:
    """The origin that the text is, or None: `null`, another scheme, or what is none at all."""
    found = _ORIGIN.fullmatch(text.lower())
    if found is None:
        return None
    scheme = found["scheme"]
    return Origin(scheme, found["name"], int(found["port"] or _DEFAULT_PORTS[scheme]))


def own_origin(scope: Scope) -> Origin | None:
    """The origin that a page of this server has where the request came in, or None without a usable Host."""
    scheme = {"ws": "http", "wss": "https"}.get(scope["scheme"], scope["scheme"])
    return read_origin(f"{scheme}://{Headers(scope=scope).get('host', '')}")


def may_enter(scope: Scope, allow_origin: Collection[str]) -> bool:
    """Whether a request comes from no page at all, from a page of this server, or from one of an allowed origin.

    Browsers open a WebSocket to any host, and send forms there, without asking: CORS covers neither.
    """
    text = Headers(scope=scope).get("origin")
    if text is None:
        return True
    origin = read_origin(text)
    return origin is not None and (str(origin) in allow_origin or origin == own_origin(scope))


class Hosts:
    """Names that this server goes by. A page of another name that leads here (DNS rebinding) is not one of its own.

    Addresses, which no name server can turn elsewhere, `localhost`, and the names that were given: `*.gems.example` for
    all below one, `*` for any.
    """

    def __init__(self, names: Iterable[str]) -> None:
        """ValueError for what is no name."""
        self._names: set[str] = set()
        self._endings: list[str] = []
        self._any = False
        for name in names:
            self._add(name.lower())

    def _add(self, name: str) -> None:
        stem = name.removeprefix("*.")
        if name == "*":
            self._any = True
        elif (found := _HOST.fullmatch(stem)) is None or found["port"]:
            raise ValueError("expected a name without a port, such as gems.example or *.gems.example, or *")
        elif stem == name:
            self._names.add(name)
        else:
            self._endings.append(name.removeprefix("*"))

    def allow(self, host: str | None) -> bool:
        """Whether a request for that Host is for this server. None comes from no browser."""
        if host is None or self._any:
            return True
        found = _HOST.fullmatch(host.lower())
        if found is None:
            return False
        name = found["name"]
        known = name in self._names or name == _LOOPBACK_NAME or name.endswith((f".{_LOOPBACK_NAME}", *self._endings))
        return known or is_address(name)


def is_address(name: str) -> bool:
    """Whether a name is an IP address, one of version 6 in brackets or not."""
    try:
        ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True

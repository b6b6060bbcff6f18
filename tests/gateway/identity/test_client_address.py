"""Who counts as one client, also behind proxies, without a server."""

from __future__ import annotations

from typing import Any

import pytest
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from culet.gateway.identity.client_address import UNKNOWN, client_at, client_of, read_proxies, trusted_hosts


@pytest.mark.parametrize(
    ("host", "client"),
    [
        ("203.0.113.9", "203.0.113.9"),
        ("::ffff:203.0.113.9", "203.0.113.9"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("2001:db8:1:2::ffff", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("", UNKNOWN),
        (None, UNKNOWN),
        ("unix:", UNKNOWN),
        ("x" * 60_000, UNKNOWN),
    ],
)
def test_a_client_is_an_address_and_all_of_an_ipv6_subnet_is_one(host: str | None, client: str) -> None:
    assert client_at(host) == client


async def seen(peer: str, forwarded: list[str], proxies: list[str]) -> str:
    """The client that the application sees."""
    found: list[str] = []

    async def app(scope: Any, _receive: object, _send: object) -> None:  # noqa: ANN401
        found.append(client_of(scope))

    async def nothing(*_: object) -> Any:  # noqa: ANN401
        raise AssertionError

    headers = [(b"x-forwarded-for", value.encode()) for value in forwarded]
    scope: Any = {"type": "http", "client": (peer, 1), "headers": headers}
    await ProxyHeadersMiddleware(app, trusted_hosts(read_proxies(proxies)))(scope, nothing, nothing)
    return found[0]


@pytest.mark.parametrize(
    ("peer", "forwarded", "proxies", "client"),
    [
        ("127.0.0.1", ["203.0.113.9"], [], "127.0.0.1"),
        ("198.51.100.1", ["203.0.113.9"], ["10.0.0.0/8"], "198.51.100.1"),
        ("10.0.0.7", ["203.0.113.9"], ["10.0.0.0/8"], "203.0.113.9"),
        ("10.0.0.7", [], ["10.0.0.0/8"], "10.0.0.7"),
        ("::ffff:10.0.0.7", ["203.0.113.9"], ["10.0.0.7"], "203.0.113.9"),
        ("10.0.0.7", ["192.0.2.1, 203.0.113.9"], ["10.0.0.7"], "203.0.113.9"),
        ("10.0.0.7", ["192.0.2.1", "203.0.113.9, 10.0.0.8"], ["10.0.0.7", "10.0.0.8"], "203.0.113.9"),
        ("10.0.0.7", ["203.0.113.9:4711"], ["10.0.0.7"], "203.0.113.9"),
        ("10.0.0.7", ["[2001:db8::5]:80"], ["10.0.0.7"], "2001:db8::/64"),
    ],
    ids=["nobody is trusted", "not by strangers", "a proxy", "a proxy itself", "a mapped address", "made up",
         "a chain of proxies", "with a port", "in brackets"],
)  # fmt: skip
async def test_only_trusted_proxies_may_say_whom_they_stand_for(
    peer: str, forwarded: list[str], proxies: list[str], client: str
) -> None:
    assert await seen(peer, forwarded, proxies) == client


@pytest.mark.parametrize("text", ["*", "proxy", "10.0.0.0/40", "10.0.0.1/8", ""])
def test_what_is_no_address_is_no_proxy(text: str) -> None:
    with pytest.raises(ValueError, match="expected an address or a network"):
        read_proxies([text])

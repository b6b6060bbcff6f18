"""Who a request or stream comes from, for every limit that is kept for each client.

A client is an address: that of the connection, or, if the connection is a trusted proxy's, the one that the proxy
forwards in X-Forwarded-For. uvicorn's `ProxyHeadersMiddleware` puts that address into the ASGI scope; here are its
arguments, and what of the address counts.
"""

from __future__ import annotations

from collections.abc import Iterable
from ipaddress import IPv4Network, IPv6Network, ip_address, ip_network

from starlette.types import Scope

Network = IPv4Network | IPv6Network

UNKNOWN = "unknown"
"""The client of a connection without an address (a local socket), or of a forwarded address that is none."""
HOST_BITS = 64
"""Of an IPv6 address: whoever has one has the whole /64 (RFC 6177), and could be any number of clients otherwise."""


def client_of(scope: Scope) -> str:
    """The client of an ASGI scope whose proxy headers have been read."""
    address = scope.get("client")
    return client_at(address[0] if address else None)


def client_at(host: str | None) -> str:
    """The client at the other end of a connection: an IPv4 address, the /64 of an IPv6 address, or `UNKNOWN`."""
    try:
        address = ip_address((host or "").partition("%")[0])
    except ValueError:
        return UNKNOWN
    if address.version == 4:
        return str(address)
    if address.ipv4_mapped:
        return str(address.ipv4_mapped)
    return str(ip_network((int(address), 128 - HOST_BITS), strict=False))


def read_proxies(texts: Iterable[str]) -> tuple[Network, ...]:
    """Trusted proxies given as addresses or networks, such as `10.0.0.7` or `172.16.0.0/12`; ValueError."""
    proxies = []
    for text in texts:
        try:
            proxies.append(ip_network(text.strip()))
        except ValueError as error:
            raise ValueError(f"expected an address or a network such as 172.16.0.0/12 ({error})") from error
    return tuple(proxies)


def trusted_hosts(proxies: Iterable[Network]) -> list[str]:
    """The proxies as `ProxyHeadersMiddleware` takes them. A socket that listens on `::` sees IPv4 as ::ffff:a.b.c.d."""
    hosts = []
    for proxy in proxies:
        hosts.append(str(proxy))
        if proxy.version == 4:
            hosts.append(f"::ffff:{proxy.network_address}/{96 + proxy.prefixlen}")
    return hosts

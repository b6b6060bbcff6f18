"""How a gateway comes to its engine: one engine, and with keys where it is on another machine."""

from __future__ import annotations

import socket
from collections.abc import Mapping

from culet.endpoints import tcp_address
from culet.errors import InputError
from culet.gateway.settings import GatewaySettings
from culet_protocol.keys import ClientKeys, KeysError, keys_of


def engine_door_keys(settings: GatewaySettings) -> ClientKeys | None:
    """The gateway's keys, if it was given some and needs them; InputError for what is no client's folder."""
    try:
        return keys_of(settings.control, settings.keys) or keys_of(settings.frames, settings.keys)
    except KeysError as error:
        raise InputError(f"--keys: {error}", "keys") from error


def check_one_engine(endpoints: Mapping[str, str]) -> None:
    """InputError for a name, by the option that has it, that several machines go by: control would come to one engine
    and frames from another, and no picture to anybody. A name that is not known yet passes: the engine may come."""
    for option, endpoint in endpoints.items():
        found = tcp_address(endpoint)
        if found is None:
            continue
        try:
            known = socket.getaddrinfo(found, None, socket.AF_INET, socket.SOCK_STREAM)
        except OSError:
            continue
        addresses = sorted({str(address[0]) for *_, address in known})
        if len(addresses) > 1:
            raise InputError(
                f"--{option}: expected the address of one engine, and {found!r} is the name of {len(addresses)} "
                f"({', '.join(addresses)}); one gateway serves one engine: start a gateway for each (as `culet serve` "
                "does) behind a proxy, or name one address",
                option,
            )

"""How a route gets at the gateway that it belongs to."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from culet.gateway.state import Gateway


def _of(connection: HTTPConnection) -> Gateway:
    gateway: Gateway = connection.app.state.gateway
    return gateway


ThisGateway = Annotated[Gateway, Depends(_of)]

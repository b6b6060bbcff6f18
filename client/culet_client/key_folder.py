"""The keys with which a client comes to an engine on another machine."""

from __future__ import annotations

from pathlib import Path

from culet_client.errors import ClientError
from culet_protocol.keys import ClientKeys, KeysError, keys_of


def checked_keys(endpoint: str, folder: Path | None) -> ClientKeys | None:
    """Those for an endpoint, if it needs some and there are any; ClientError for what is no client's folder of keys."""
    try:
        return keys_of(endpoint, folder)
    except KeysError as error:
        raise ClientError(str(error)) from error

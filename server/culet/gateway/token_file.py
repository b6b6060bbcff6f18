"""The file that tells programs of the same user which token a server has."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path

from culet.errors import InputError
from culet.gateway.settings import GatewaySettings


@contextlib.contextmanager
def token_kept(settings: GatewaySettings) -> Iterator[None]:
    """Keep the token in the file that the settings name, if they name one; a server without a token has no file.

    The file is new, whatever was there, and nobody else could ever read it. At the end it is removed, unless another
    server has put its own there. InputError if it cannot be written.
    """
    file, token = settings.token_file, settings.token
    if file is None:
        yield
        return
    with contextlib.ExitStack() as own:
        try:
            file.unlink(missing_ok=True)
            if token is not None:
                part = file.with_name(f".{file.name}.{secrets.token_hex(8)}.part")
                written = own.enter_context(os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w"))
                own.callback(_remove, file, written.fileno())  # by which it is known, so it stays open until then
                written.write(token)
                written.flush()
                part.replace(file)
        except OSError as error:
            raise InputError(f"token_file: cannot keep the token in {file}: {error.strerror}", "token_file") from error
        yield


def _remove(file: Path, own: int) -> None:
    """Unless a server that was started since has put its own there, maybe of the same token."""
    with contextlib.suppress(OSError):
        if os.path.samestat(file.stat(), os.fstat(own)):
            file.unlink()

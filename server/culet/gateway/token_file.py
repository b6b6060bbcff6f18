"""The file that tells programs of the same user which token a server has."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator

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
    try:
        file.unlink(missing_ok=True)
        if token is not None:
            part = file.with_name(f".{file.name}.{secrets.token_hex(8)}.part")
            with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as written:
                written.write(token)
            part.replace(file)
    except OSError as error:
        raise InputError(f"token_file: cannot keep the token in {file}: {error.strerror}", "token_file") from error
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            if (
                token is not None and file.read_bytes() == token.encode()
            ):  # and not that of a server which was started since
                file.unlink()

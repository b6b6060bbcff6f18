"""Where files are written: looked at before the work, which may be long, and written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Collection
from pathlib import Path

from culet.errors import InputError


def check_place(file: Path, option: str, endings: Collection[str]) -> None:
    """InputError that names the option unless the file's name has one of the endings and it can be made there."""
    if file.suffix.lower().lstrip(".") not in endings:
        raise InputError(f"{option}: expected a name that ends in .{', .'.join(endings)}; got {file.name!r}", option)
    if file.is_dir():
        raise InputError(f"{option}: cannot write {file}: it is a folder", option)
    if not file.parent.is_dir():
        raise InputError(f"{option}: cannot write {file}: there is no folder {file.parent}", option)
    if not os.access(file.parent, os.W_OK):
        raise InputError(f"{option}: cannot write {file}: permission denied", option)


def write_whole(file: Path, content: bytes, option: str) -> None:
    """Put a file there; one that was there before stays if that fails. InputError that names the option says why."""
    # In the same folder, since renaming is atomic within one file system, under a name that no other writer has.
    part = file.with_name(f".{file.name}.{secrets.token_hex(4)}.part")
    try:
        stream = part.open("xb")
        try:
            with stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            part.replace(file)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{option}: cannot write {file}: {error.strerror or error}", option) from error

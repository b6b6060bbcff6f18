"""Where a command writes: looked at before the work, which may be long, rather than after it."""

from __future__ import annotations

import os
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

"""Where a command writes: looked at before the work, which may be long, rather than after it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TextIO

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


@contextlib.contextmanager
def opened(out: Path | None) -> Iterator[TextIO | None]:
    """The file that `--out` names, if any, to add to; what it holds stays. InputError if it cannot be written."""
    if out is None:
        yield None
        return
    try:
        file = out.open("a", encoding="utf-8")
    except OSError as error:
        raise InputError(f"out: cannot write {out}: {error.strerror}", "out") from error
    with file:
        yield file

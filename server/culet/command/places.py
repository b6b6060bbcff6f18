"""Files that a command adds to: opened before the work, which may be long."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from culet.errors import InputError


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

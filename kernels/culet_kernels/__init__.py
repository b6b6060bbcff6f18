"""OpenCL C by physical stage, and a loader that joins the files."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "(\w+\.cl)"$', re.MULTILINE)

NAMES = tuple(sorted(entry.name for entry in files(__name__).iterdir() if entry.name.endswith(".cl")))
"""Every source file."""


@cache
def source(name: str) -> str:
    """The text of a file with what it includes put in place, each once; `#line` keeps the compiler's messages true.

    Joining here, not by the compiler, makes the text all that a program depends on: no cache misses a changed include.
    """
    return _join(name, set())


@cache
def written(name: str) -> str:
    """The text of a file as it is written."""
    return files(__name__).joinpath(name).read_text(encoding="utf-8")


def _join(name: str, seen: set[str]) -> str:
    if name in seen:
        return ""
    seen.add(name)
    text = written(name)
    parts, line, position = [f'#line 1 "{name}"\n'], 1, 0
    for include in _INCLUDE.finditer(text):
        before = text[position : include.start()]
        line += before.count("\n") + 1
        parts += [before, _join(include[1], seen), f'#line {line} "{name}"\n']
        position = include.end() + 1
    return "".join([*parts, text[position:]])

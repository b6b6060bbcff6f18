"""Compile the solver: `python build.py` puts the library beside its sources, where `library` finds it.

Needs nothing but Python itself: it also runs where culet is only being built (hatch_build.py).
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).parent
FLAGS = ("-std=c11", "-O3", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno")
"""Without contraction each operation rounds by itself: the same bits from every compiler. `-fno-math-errno` lets sqrt
be one instruction, which rounds alike."""
NAMES = ("cc", "gcc", "clang")
TIMEOUT = 300.0
"""s. gcc takes 2 s."""


class BuildError(Exception):
    """No compiler, or none that compiles the solver; the message says what was tried and what to do."""


def compilers() -> Iterator[str]:
    """Those on the PATH: cc, gcc, clang, then clang-N, the newest first (PoCL on Debian depends on one of these)."""
    for name in NAMES:
        if found := shutil.which(name):
            yield found
    versioned: dict[int, str] = {}
    for folder in os.get_exec_path():
        for file in Path(folder).glob("clang-*") if folder else ():
            if (version := re.fullmatch(r"clang-(\d+)", file.name)) and os.access(file, os.X_OK):
                versioned.setdefault(int(version[1]), str(file))
    yield from (versioned[version] for version in sorted(versioned, reverse=True))


def library_name() -> str:
    """Of the library of these sources on this machine: another source, flag or processor is another file."""
    content = hashlib.sha256(" ".join((*FLAGS, platform.system(), platform.machine())).encode())
    for file in sorted(SOURCES.glob("*.[ch]")):
        content.update(file.name.encode() + b"\0" + file.read_bytes())
    return f"culet_solver-{content.hexdigest()[:16]}.so"


def build(folder: Path, compiler: str | None = None) -> Path:
    """Compile into that folder, by the first compiler that can, or that one; the library, whole or not at all.

    BuildError if there is none; OSError if the folder cannot be written to.
    """
    target = folder / library_name()
    folder.mkdir(parents=True, exist_ok=True)
    failures = []
    with tempfile.TemporaryDirectory(prefix=".building-", dir=folder) as place:
        part = Path(place) / target.name
        for found in [compiler] if compiler else compilers():
            command = [found, *FLAGS, *map(str, sorted(SOURCES.glob("*.c"))), "-o", str(part), "-lm"]
            try:
                run = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT, check=False)  # noqa: S603
            except (OSError, subprocess.TimeoutExpired) as error:
                failures.append(f"{found}: {error}")
                continue
            if run.returncode == 0:
                part.replace(target)
                return target
            complaint = next((line for line in run.stderr.splitlines() if "error" in line), run.stderr.strip()[-200:])
            failures.append(f"{found}: {complaint}")
    if not failures:
        raise BuildError(
            "found no C compiler (looked for cc, gcc, clang and clang-N on the PATH); "
            "on Debian: apt-get install gcc libc6-dev"
        )
    raise BuildError(f"the C compiler failed: {'; '.join(failures)}")


if __name__ == "__main__":
    if not (SOURCES / library_name()).is_file():
        try:
            built = build(SOURCES)
        except BuildError as error:
            sys.exit(f"the solver of stones in contact is not built: {error}")
        for old in SOURCES.glob("culet_solver-*.so"):
            if old != built:
                old.unlink()

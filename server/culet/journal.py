"""What long work has done, one JSON line each, so that the same work goes on where it was when it is started again."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from culet.errors import InputError

if os.name == "posix":
    import fcntl


MOST_TOLD = 5
"""Differences that a refusal names."""
MOST_LETTERS = 40
"""Of a value in it."""


class Journal:
    """The first line says which work it is; each line after it holds a record that is safely on the disk."""

    def __init__(
        self, path: Path, identity: Mapping[str, Any], *, kind: str, fresh: bool = False, anew: str = "begin anew"
    ) -> None:
        """Open or begin it; `fresh` forgets what is there.

        `kind` is what the work is called, and a key of every identity; `anew` what --fresh would do. InputError if it
        belongs to other work, or to a process that is at that work now.
        """
        self.path = path
        self.records: list[Any] = []
        self._kind, self._anew = kind, anew
        if fresh or not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("a+", encoding="utf-8")
        try:
            self._claim()
            lines = [] if fresh else self._whole_lines()
            if lines:
                self._check(lines[0], identity)
                self.records = [self._read(line) for line in lines[1:]]
            else:
                self._file.truncate(0)
                self._append(dict(identity))
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    def append(self, record: object) -> None:
        """Write a record down, whole or, if the process ends meanwhile, not at all; on return it outlives that."""
        self._append(record)
        self.records.append(record)

    def _append(self, value: object) -> None:
        self._file.write(json.dumps(value, allow_nan=False) + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def _claim(self) -> None:
        """No two processes may write into one journal."""
        if os.name != "posix":
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise InputError(f"{self.path} is in use: another process is at this {self._kind}") from error

    def _whole_lines(self) -> list[str]:
        """What is there, without a last line that was interrupted, which is cut off the file too."""
        data = self.path.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        try:
            lines = whole.decode().splitlines()
        except UnicodeDecodeError:
            lines = [""]
        if data and not whole:
            lines = [""]  # one line without an end was never written by a journal that lived
        elif len(whole) < len(data):
            self._file.truncate(len(whole))
        return lines

    def _check(self, line: str, identity: Mapping[str, Any]) -> None:
        try:
            found = json.loads(line)
        except ValueError:
            found = None
        if not isinstance(found, dict) or self._kind not in found:
            raise InputError(
                f"{self.path} is no journal of a {self._kind}; give another place, or --fresh to replace it"
            )
        differing = differences(found, identity)
        if differing:
            told = [f"{path} {_short(then)}, now {_short(now)}" for path, then, now in differing[:MOST_TOLD]]
            if len(differing) > MOST_TOLD:
                told.append(f"and {len(differing) - MOST_TOLD} more")
            raise InputError(
                f"{self.path} is of another {self._kind} ({'; '.join(told)}); give another place, or --fresh to "
                f"{self._anew}"
            )

    def _read(self, line: str) -> object:
        try:
            return json.loads(line)
        except ValueError as error:
            raise InputError(f"{self.path} holds a line that is no JSON; give --fresh to {self._anew}") from error


def differences(then: object, now: object, path: str = "") -> list[tuple[str, Any, Any]]:
    """Where two values of JSON differ: the names down to there with dots between, and both values; None for one that
    there is not. Lists of one length differ in their elements, others as a whole."""
    if isinstance(then, Mapping) and isinstance(now, Mapping):
        pairs = [(name, then.get(name), now.get(name)) for name in {**then, **now}]
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        pairs = [(str(number), *pair) for number, pair in enumerate(zip(then, now, strict=True))]
    else:
        return [] if then == now else [(path, then, now)]
    return [
        found
        for name, before, after in pairs
        if before != after
        for found in differences(before, after, f"{path}.{name}" if path else name)
    ]


def _short(value: object) -> str:
    text = "none" if value is None else json.dumps(value, ensure_ascii=False) if isinstance(value, list) else str(value)
    short = text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 3]}..."
    return f"{short} ({len(value)} values)" if isinstance(value, list) and short != text else short

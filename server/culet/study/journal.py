"""Points as they are measured, one JSON line each, so that an interrupted study goes on where it was."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Self

from pydantic import TypeAdapter, ValidationError

from culet.errors import InputError
from culet.study.report import Point

_POINTS = TypeAdapter(list[Point])


class Journal:
    """The first line says which study it is; each line after it holds points that are safely on the disk."""

    def __init__(self, path: Path, identity: dict[str, object], *, fresh: bool = False) -> None:
        """Open or begin it; `fresh` forgets what is there. InputError if it belongs to another study."""
        self.path = path
        self.points: dict[str, Point] = {}
        lines = [] if fresh else self._whole_lines()
        if lines:
            self._check(lines[0], identity)
            for line in lines[1:]:
                self._keep(self._read(line))
            self._file = path.open("a", encoding="utf-8")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("w", encoding="utf-8")
            self._append(identity)

    def __contains__(self, key: str) -> bool:
        return key in self.points

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def add(self, *points: Point) -> None:
        """Write them down, all or, if the process ends meanwhile, none; on return they outlive it."""
        self._append([point.model_dump(mode="json") for point in points])
        self._keep(points)

    def _keep(self, points: Iterable[Point]) -> None:
        self.points.update({point.key: point for point in points})

    def _append(self, value: object) -> None:
        self._file.write(json.dumps(value, allow_nan=False) + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def _whole_lines(self) -> list[str]:
        """What is there, without a last line that was interrupted, which is cut off the file too."""
        if not self.path.exists():
            return []
        data = self.path.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        if len(whole) < len(data):
            with self.path.open("r+b") as file:
                file.truncate(len(whole))
        return whole.decode().splitlines()

    def _check(self, line: str, identity: dict[str, object]) -> None:
        try:
            found = json.loads(line)
        except ValueError:
            found = None
        if not isinstance(found, dict) or "study" not in found:
            raise InputError(f"{self.path} is no journal of a study; give another folder, or --fresh to replace it")
        differing = [name for name in {**found, **identity} if found.get(name) != identity.get(name)]
        if differing:
            told = ", ".join(
                f"{name} {_short(found.get(name))}, now {_short(identity.get(name))}" for name in differing
            )
            raise InputError(
                f"{self.path} is of another study ({told}); give another folder, or --fresh to measure anew"
            )

    def _read(self, line: str) -> list[Point]:
        try:
            return _POINTS.validate_json(line)
        except ValidationError as error:
            raise InputError(f"{self.path} holds a line without points; --fresh measures anew") from error


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 24 else text[:21] + "..."

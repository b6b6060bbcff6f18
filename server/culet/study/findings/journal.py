"""Points as they are measured, so that an interrupted study goes on where it was."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from culet import journal
from culet.errors import InputError
from culet.study.report import Point

_POINTS = TypeAdapter(list[Point])


class PointJournal:
    """A journal whose records are lists of points: those that belong together are kept together or not at all."""

    def __init__(self, path: Path, identity: dict[str, object], *, fresh: bool = False) -> None:
        """Open or begin it; `fresh` forgets what is there. InputError if it belongs to another study."""
        self.path = path
        self.points: dict[str, Point] = {}
        self._journal = journal.Journal(path, identity, kind="study", fresh=fresh, anew="measure anew")
        try:
            for record in self._journal.records:
                self._keep(self._read(record))
        except BaseException:
            self._journal.close()
            raise

    def __contains__(self, key: str) -> bool:
        return key in self.points

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._journal.close()

    def add(self, *points: Point) -> None:
        """Write them down, all or, if the process ends meanwhile, none; on return they outlive it."""
        self._journal.append([point.model_dump(mode="json") for point in points])
        self._keep(points)

    def _keep(self, points: Iterable[Point]) -> None:
        self.points.update({point.key: point for point in points})

    def _read(self, record: Any) -> list[Point]:  # noqa: ANN401 - whatever JSON held
        try:
            return _POINTS.validate_python(record)
        except ValidationError as error:
            raise InputError(f"{self.path} holds a line without points; --fresh measures anew") from error

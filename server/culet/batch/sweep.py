"""A sweep: metrics of a scene while some of its fields vary, as a table."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from culet.batch.crew import IN_PROCESS, Crew, in_turn
from culet.batch.digest import identity_of
from culet.batch.metrics import MetricEffort, check_metrics, columns_of, light_sums, measure
from culet.batch.variation import Variation, points_of, varied
from culet.errors import InputError
from culet.grading.metrics import GRADES
from culet.journal import Journal
from culet.places import write_whole
from culet.scene.model import Scene
from culet.simulation.lying import put_down
from culet.stage import Library, Stage
from culet.version import __version__

PROBLEM = "problem"
"""The column that says why a scene has no numbers."""
POINT = "point"
"""In the journal, whose place a point has among all, from 0."""


@dataclass(frozen=True)
class Sweep:
    """What is asked for."""

    stage: Stage
    variations: tuple[Variation, ...]
    metrics: tuple[str, ...]
    effort: MetricEffort = field(default_factory=MetricEffort)

    def identity(self) -> dict[str, Any]:
        """What of another sweep is different."""
        return {
            "sweep": __version__,
            **identity_of(self.stage),
            "fields": [each.field for each in self.variations],
            "vary": {each.field: list(each.values) for each in self.variations},
            "metrics": list(self.metrics),
            "effort": asdict(self.effort),
        }

    def columns(self) -> list[str]:
        """Of the table."""
        return [*(each.field for each in self.variations), *columns_of(self.metrics), PROBLEM]

    def scene(self, values: Sequence[Any]) -> Scene:
        """Of one point; SceneError for a field that there is not, or a value that a field cannot have."""
        fields = (each.field for each in self.variations)
        return varied(self.stage.scene, dict(zip(fields, values, strict=True)))

    def library(self) -> Library:
        """The shapes of files that stones name, to be cut anew."""
        stones = zip(self.stage.scene.stones, self.stage.shapes, strict=True)
        return Library({stone.mesh: shape for stone, shape in stones if stone.mesh and stone.recut is None})


def journal_of(out: Path) -> Path:
    """Beside the table."""
    return out.with_name(f"{out.name}.journal")


def run(
    sweep: Sweep, out: Path, *, fresh: bool = False, crew: Crew = IN_PROCESS
) -> Generator[tuple[int, int], None, None]:
    """Have every point measured, and write the table; points done of all, at the start and after each.

    What an earlier run of the same sweep has measured is taken from its journal; the table is written when the sweep
    ends, however it ends, with the points that are known. A point whose scene cannot be has no numbers, and a reason.
    InputError for what makes no sweep, or for a journal of another one.
    """
    check_metrics(sweep.metrics)
    points = points_of(sweep.variations)
    sweep.scene(points[0])  # a field that there is not is told before anything is begun
    with Journal(journal_of(out), sweep.identity(), kind="sweep", fresh=fresh) as journal:
        known = _known(journal, len(points))
        missing = [(number, values) for number, values in enumerate(points) if number not in known]
        try:
            yield len(known), len(points)
            with closing(crew.results(PointTask(sweep), in_turn(missing))) as done:
                for (number, _), found in done:
                    journal.append({POINT: number, **found})
                    known[number] = found
                    yield len(known), len(points)
        finally:
            write_whole(out, _table(sweep, points, known), "out")


def _known(journal: Journal, count: int) -> dict[int, dict[str, Any]]:
    """Columns of points that are measured; InputError for records that are of none."""
    known: dict[int, dict[str, Any]] = {}
    for record in journal.records:
        number = record.get(POINT) if isinstance(record, dict) else None
        if not isinstance(number, int) or not 0 <= number < count:
            raise InputError(f"{journal.path} holds lines that are no points of this sweep; --fresh begins anew")
        known[number] = record
    return known


@dataclass(frozen=True)
class PointTask:
    """Measures points of a sweep, by their numbers and values."""

    sweep: Sweep

    def __call__(self, item: tuple[int, Sequence[Any]]) -> dict[str, Any]:
        """Columns of that point; those that are no numbers are left out."""
        sweep = self.sweep
        sums = light_sums() if set(sweep.metrics) & set(GRADES) else None
        try:
            stage = put_down(Stage.of(sweep.scene(item[1]), sweep.library(), before=sweep.stage), sweep.stage)
            found = measure(sums, stage, sweep.metrics, sweep.effort)
        except InputError as error:
            return {PROBLEM: str(error)}
        return {name: value for name, value in found.items() if math.isfinite(value)}


def _table(sweep: Sweep, points: Sequence[Sequence[Any]], known: Mapping[int, dict[str, Any]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(sweep.columns())
    for number, values in enumerate(points):
        if number in known:
            told = [known[number].get(column, "") for column in (*columns_of(sweep.metrics), PROBLEM)]
            writer.writerow([*values, *told])
    return text.getvalue().encode()

"""A study's report: one shape for all studies, JSON in and out; docs/explanation/study.md describes it."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from culet.errors import InputError
from culet.scene.fields import Model

SCHEMA_VERSION = 1

Knob = str | bool | int | float | None


class Figure(Model):
    """What a measured number means."""

    unit: str
    better: Literal["less", "more", "neither"] = "less"
    about: str


class Point(Model):
    """One measurement: the knobs' settings and what came of them."""

    key: str = Field(description="All knobs, in words: the same in two reports means the same settings.")
    group: str = Field(description="The sweep that it belongs to.")
    label: str
    knobs: dict[str, Knob]
    figures: dict[str, float | None] = Field(description="By the names in the report's `figures`; null: has none here.")


class Frontier(Model):
    """The points of which no other is both faster and more exact."""

    name: str
    cost: str
    error: str
    keys: tuple[str, ...] = Field(description="Fastest first.")


class Fit(Model):
    """error = constant x step^order, by least squares on logarithms."""

    label: str
    error: str
    step: str
    order: float
    points: int = Field(description="Used for it: those that rounding or instability does not rule.")


class Race(Model):
    """Seconds that one renderer takes to come to an error."""

    name: str
    note: str = ""
    seconds: dict[str, float | None] = Field(description="By RMSE, as text; null: not reached.")
    extrapolated: tuple[str, ...] = Field((), description="Those not waited for: taken on along 1 / sqrt(time).")


class Headline(Model):
    """One number that sums up."""

    name: str
    value: float
    unit: str


class Report(Model):
    """All of a study."""

    schema_version: Literal[1] = 1
    study: Literal["rendering", "simulation", "streaming", "caustics", "growth"]
    made: str = Field(description="ISO 8601, UTC.")
    provenance: dict[str, str | int]
    settings: dict[str, Knob]
    scene: dict[str, object] = Field(description="As culet reads it.")
    figures: dict[str, Figure]
    points: tuple[Point, ...]
    frontiers: tuple[Frontier, ...] = ()
    fits: tuple[Fit, ...] = ()
    races: tuple[Race, ...] = ()
    limits: dict[str, float] = Field({}, description="Of the machine: flop/s and bytes/s by name.")
    headlines: tuple[Headline, ...] = ()
    notes: Annotated[tuple[str, ...], Field(description="What was left out or limits what the figures say.")] = ()

    @model_validator(mode="before")
    @classmethod
    def _named_as_before(cls, data: Any) -> Any:  # noqa: ANN401 - whatever JSON held
        """Earlier reports call the frontiers `fronts`."""
        if isinstance(data, dict) and "fronts" in data:
            return {("frontiers" if name == "fronts" else name): value for name, value in data.items()}
        return data

    @classmethod
    def read(cls, path: Path) -> Report:
        """From a report.json; InputError says what is wrong with it."""
        try:
            text = path.read_bytes()
        except OSError as error:
            raise InputError(f"cannot read {path}: {error.strerror}") from error
        try:
            return cls.model_validate_json(text)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(map(str, first["loc"]))
            raise InputError(
                f"{path} is no report of schema {SCHEMA_VERSION}: {place or 'file'}: {first['msg']}"
            ) from error

    def json_text(self) -> str:
        """For report.json."""
        return json.dumps(self.model_dump(mode="json"), indent=1, allow_nan=False) + "\n"

    def point(self, key: str) -> Point:
        """The point of that key."""
        return next(point for point in self.points if point.key == key)


def csv_text(report: Report) -> str:
    """A row a point: key, group, label, then every knob and every figure; empty where there is none."""
    knobs = list(dict.fromkeys(name for point in report.points for name in point.knobs))
    figures = list(report.figures)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["key", "group", "label", *knobs, *figures])
    for point in report.points:
        cells = [point.knobs.get(name) for name in knobs] + [point.figures.get(name) for name in figures]
        writer.writerow([point.key, point.group, point.label, *("" if cell is None else cell for cell in cells)])
    return text.getvalue()

"""All grades of one stone of a scene, made piece by piece, so that whoever waits sees them come and may stop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from culet.errors import SceneError
from culet.geometry.shape import Shape
from culet.grading.answer import GradeReport
from culet.grading.grades import ASET, SIGMAS, TARGET, TILTS, grade, tilt_curve, weighted_light_return
from culet.grading.number import Number
from culet.grading.optics import StoneOptics, optics_of
from culet.grading.rules import Rules
from culet.grading.size import Size, size_of
from culet.grading.sums import LightSums
from culet.scene.stone import StoneSettings
from culet.stage import Stage

AXES = {"x": 90.0, "z": 0.0}
"""The axes of its own shape about which a stone is tilted for a curve: the azimuth that it is then seen from."""


def reports(
    sums: LightSums,
    shape: Shape,
    optics: StoneOptics,
    rules: Rules,
    *,
    stone: StoneSettings,
    size: Size,
    target: float = TARGET,
    tilt: bool = False,
    light_return: bool = True,
) -> Iterator[GradeReport]:
    """One after each piece of work, the last of which has all. MeshError for a stone that is not convex."""
    steps = 1 + light_return + 2 * tilt
    report = None
    for grades in grade(sums, shape, optics, rules, target):
        report = GradeReport(stone.id, optics.index, size, rules, grades)
        error = SIGMAS * grades.iso.error
        yield replace(report, done=min(1.0, (target / error) ** 2 if error > 0 else 1.0) / steps)
    assert report is not None  # noqa: S101 - the first piece is always made
    if light_return:
        for number in weighted_light_return(sums, shape, optics, rules):
            report = replace(report, weighted_light_return=number)
            yield replace(report, done=2 / steps)
    if tilt:
        first = 1 + light_return
        for axis, azimuth in AXES.items():
            for point in tilt_curve(sums, shape, optics, rules, azimuth):
                curves = dict(report.tilt or {})
                curves[axis] = (*curves.get(axis, ()), point)
                report = replace(report, tilt=curves, done=(first + len(curves[axis]) / len(TILTS)) / steps)
                yield report
            first += 1
    yield replace(report, done=1.0)


def reports_of(
    sums: LightSums,
    stage: Stage,
    rules: Rules,
    *,
    stone: str | None = None,
    target: float = TARGET,
    tilt: bool = False,
    coloured: bool = False,
) -> Iterator[GradeReport]:
    """Of a stone of a stage, by its id; without one, of the first. SceneError if there is none."""
    place = place_of(stage, stone)
    settings, shape, millimetres = stage.scene.stones[place], stage.shapes[place], stage.scene.millimetres
    yield from reports(
        sums, shape, optics_of(settings, millimetres, coloured=coloured), rules,
        stone=settings, size=size_of(shape, settings, millimetres), target=target, tilt=tilt,
    )  # fmt: skip


def place_of(stage: Stage, stone: str | None) -> int:
    """Of the stone of that id among the stage's, of the first without one; SceneError if there is none."""
    stones = stage.scene.stones
    place = next((k for k, each in enumerate(stones) if stone in (None, each.id)), None)
    if place is None:
        there = ", ".join(each.id for each in stones) or "none"
        raise SceneError(f"stone: expected the id of a stone ({there}), got {stone!r:.60}", "stone")
    return place


def table_of(report: GradeReport) -> list[tuple[str, Number, str]]:
    """What is printed: what it is called, the number, and its unit."""
    grades = report.grades
    rows = [
        ("ISO brightness", grades.iso, "%"),
        ("COS brightness", grades.cos, "%"),
        ("SC2 brightness", grades.sc2, "%"),
        *((f"{name} ({low} to {high} degrees)", grades.shares[name], "%") for name, (low, high) in ASET.items()),
        ("leak", grades.shares["leak"], "%"),
        ("surface glare", grades.shares["glare"], "%"),
        ("absorbed", grades.shares["absorbed"], "%"),
        ("window", grades.window, "%"),
        ("extinction", grades.extinction, "%"),
        ("contrast", grades.contrast, "%"),
        ("fire", grades.fire, "%"),
        ("mean parting, 450 and 650 nm", grades.fire_degrees, "degrees"),
    ]
    if report.weighted_light_return is not None:
        rows.append(("weighted light return", report.weighted_light_return, ""))
    return rows

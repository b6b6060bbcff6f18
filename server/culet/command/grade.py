"""`culet grade`."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.options import PresetOption
from culet.command.single import single_command
from culet.command.subject import (
    Coloured,
    GradeError,
    HeadOption,
    IndexOption,
    MaterialOption,
    RulesName,
    StoneOption,
    Subject,
    rules_named,
    subject,
    with_material,
)
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.places import check_place, write_whole

if TYPE_CHECKING:
    from culet.grading.answer import GradeReport

app = single_command()


@app.command()
def grade(
    what: Subject = None,
    preset: PresetOption = None,
    stone: StoneOption = None,
    material: MaterialOption = None,
    index: IndexOption = None,
    head: HeadOption = None,
    rules: RulesName = "culet",
    coloured: Coloured = False,
    tilt: Annotated[bool, typer.Option("--tilt", help="Print the tilt curves about both axes too.")] = False,
    error: GradeError = 0.1,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE.json", help="All numbers as JSON.")] = None,
) -> None:
    """Grade a stone's brightness, leak, contrast and fire face up, and as it tilts; each number with its error."""
    from culet.grading.report import reports_of
    from culet.grading.sums import LightSums
    from culet.rendering.opencl.device import open_device

    with errors_in_one_line():
        if out is not None:
            check_place(out, "out", ["json"])
        graded_by = rules_named(rules, head)
        stage = with_material(subject(what, preset), material, index)
        light = LightSums(open_device())
        report = None
        with progress_bar("grading") as advance:
            for report in reports_of(
                light, stage, graded_by, stone=stone, target=error, tilt=tilt, coloured=coloured,
            ):  # fmt: skip
                advance(report.done)
        assert report is not None  # noqa: S101 - there is a first one
        _print(report, error)
        if out is not None:
            write_whole(out, (json.dumps(asdict(report), indent=2) + "\n").encode(), "out")


def _print(report: GradeReport, target: float) -> None:
    from rich.table import Table

    from culet.grading.grades import SIGMAS
    from culet.grading.report import table_of

    console = report_console()
    rules = report.rules
    console.print(f"{report.stone}, {report.size.words()}")
    console.print(
        f"index {report.index:.4f} at 589.3 nm, head {rules.head_degrees:g} degrees, glare of {rules.glare} facets, at "
        f"most {rules.bounces} facets, cut-off {rules.cutoff:g}; {report.grades.rays} rays"
    )
    table = Table("", "", "standard error", "cut off, at most", box=None)
    for name, number, unit in table_of(report):
        digits = 4 if unit == "" else 2
        bound = f"{number.bound:.{digits + 1}f}" if number.bound else ""
        table.add_row(name, f"{number.value:.{digits}f} {unit}", f"{number.error:.{digits + 1}f}", bound)
    console.print(table)
    reached = SIGMAS * report.grades.iso.error
    if reached > target:
        console.print(f"twice the standard error of ISO is {reached:.4f} points, not {target:g}: all rays are used")
    for axis, points in (report.tilt or {}).items():
        curve = Table(f"tilt about {axis}", "ISO", "COS", "SC2", "standard error", box=None)
        for point in points:
            numbers = (point.iso, point.cos, point.sc2)
            curve.add_row(f"{point.degrees:g}", *(f"{n.value:.2f}" for n in numbers), f"{point.iso.error:.3f}")
        console.print(curve)

"""`culet grade`."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from culet.command.options import Preset
from culet.command.single import single_command
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.errors import SceneError
from culet.places import check_place, write_whole

if TYPE_CHECKING:
    from culet.grading.answer import Report
    from culet.stage import Stage

app = single_command()


@app.command()
def grade(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENE.json|FILE|CUT]",
            help="Scene, design or mesh, or a cut such as oval,length_to_width=1.6; without one the default scene.",
        ),
    ] = None,
    preset: Preset = None,
    stone: Annotated[str | None, typer.Option(metavar="ID", help="Which stone; without it the first.")] = None,
    material: Annotated[str | None, typer.Option(metavar="NAME", help="In place of the stone's own.")] = None,
    index: Annotated[
        float | None,
        typer.Option(min=1.0, max=10.0, help="Refractive index, in place of a material; then there is no fire."),
    ] = None,
    head: Annotated[
        float | None, typer.Option(min=0.0, max=90.0, help="Half the angle of the viewer's head, degrees; 10.")
    ] = None,
    rules: Annotated[
        str, typer.Option("--as", metavar="culet|gemray", help="By whose rules: gemray follows ten facets alone.")
    ] = "culet",
    coloured: Annotated[
        bool, typer.Option("--coloured", help="Count what the material absorbs at 589.3 nm; else the stone is clear.")
    ] = False,
    tilt: Annotated[bool, typer.Option("--tilt", help="Print the tilt curves about both axes too.")] = False,
    error: Annotated[
        float, typer.Option(min=0.001, max=10.0, metavar="POINTS", help="Twice the standard error of ISO.")
    ] = 0.1,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE.json", help="All numbers as JSON.")] = None,
) -> None:
    """Grade a stone's brightness, leak, contrast and fire face up, and as it tilts; each number with its error."""
    from culet.grading.report import reports_of
    from culet.grading.rules import rules_of
    from culet.grading.sums import LightSums
    from culet.rendering.device import open_device

    with errors_in_one_line():
        if out is not None:
            check_place(out, "out", ["json"])
        if rules not in ("culet", "gemray"):
            raise SceneError(f"as: expected culet or gemray, got {rules!r:.40}", "as")
        stage = _with_material(_stage(what, preset), material, index)
        light = LightSums(open_device())
        report = None
        with progress_bar("grading") as advance:
            for report in reports_of(
                light, stage, rules_of("gemray" if rules == "gemray" else "culet", head),
                stone=stone, target=error, tilt=tilt, coloured=coloured,
            ):  # fmt: skip
                advance(report.done)
        assert report is not None  # noqa: S101 - there is a first one
        _print(report, error)
        if out is not None:
            write_whole(out, (json.dumps(asdict(report), indent=2) + "\n").encode(), "out")


def _stage(what: str | None, preset: str | None) -> Stage:
    from culet.scene.cuts import CUTS

    if what is not None and what.partition(",")[0] in CUTS and not Path(what).exists():
        return read_stage(None, preset, None, None, what)
    if what is None or what == "-" or what.lower().endswith(".json"):
        return read_stage(None if what is None else Path(what), preset, None)
    return read_stage(None, preset, Path(what))


def _with_material(stage: Stage, name: str | None, index: float | None) -> Stage:
    from culet.scene import Scene

    if name is not None and index is not None:
        raise SceneError("expected a material or an index, got both", "material")
    if name is None and index is None:
        return stage
    changed: dict[str, Any] = {"material": name if name is not None else {"ior": [index] * 3}}
    data = stage.scene.model_dump(mode="json")
    data["stones"] = [each | changed for each in data["stones"]]
    return stage.showing(Scene.read(data))


def _print(report: Report, target: float) -> None:
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

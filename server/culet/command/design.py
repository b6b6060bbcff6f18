"""`culet design`: cutters' files shown, converted and drawn, and a search for a better cut. Commands import what they
need."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.crew import Scheduler, TlsCa, TlsCert, TlsKey, Workers, crew_of
from culet.command.subject import (
    HeadOption,
    IndexOption,
    MaterialOption,
    RulesName,
    rules_named,
    subject,
    with_material,
)
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.errors import InputError, MeshError, WorkersError
from culet.places import check_place, write_whole
from culet.sources import naming

if TYPE_CHECKING:
    from culet.batch.candidates import Candidates
    from culet.batch.search import Range
    from culet.geometry.designs.design import Design
    from culet.scene.recut import Recut

app = typer.Typer(
    help="Gem designs of cutters' programs: .asc, .gem and .gcs.", no_args_is_help=True, add_completion=False
)

DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE|CUT",
        help="Design: .asc or .gem of GemCad, .gcs of Gem Cut Studio; or a cut, as emerald,length_to_width=1.6.",
    ),
]


@app.command()
def show(file: DesignFile) -> None:
    """Print a design's tiers, its proportions and what was found in the file."""
    from culet.geometry.designs.solid import Solid
    from culet.geometry.designs.tables import print_design

    with errors_in_one_line():
        design = read(file)
        with naming(str(file)):
            solid = Solid(design)
        print_design(report_console(), solid)


@app.command()
def convert(
    file: DesignFile,
    out: Annotated[Path, typer.Argument(metavar="OUT.asc", help="Design to write, as GemCad's text.")],
    crown_ratio: Annotated[
        float, typer.Option(metavar="K", help="Crown steeper by this tangent ratio, all meets kept.")
    ] = 1,
    pavilion_ratio: Annotated[float, typer.Option(metavar="K", help="Pavilion steeper by this tangent ratio.")] = 1,
    girdle: Annotated[
        float | None, typer.Option(metavar="PERCENT", help="Height of the girdle, of the width: the crown is moved.")
    ] = None,
    table: Annotated[
        float | None, typer.Option(metavar="PERCENT", help="Width of the table, of the stone's: the table is moved.")
    ] = None,
    angle: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TIER=DEGREES",
            help="Angle of a tier, by its number or its name, all meets and the girdle kept; may be repeated.",
        ),
    ] = None,
) -> None:
    """Write a design as .asc: the same facets, tiers, names and notes. The file is read back and compared first.

    With ratios, a girdle, a table or angles the design is cut anew, and a heading says so.
    """
    from culet.geometry.cutting.recut_design import angles_of, angles_that_followed, recut_design
    from culet.geometry.designs.asc import read_asc
    from culet.geometry.designs.asc_writer import asc_of, planes_apart

    with errors_in_one_line():
        check_place(out, "out", ["asc"])
        proportions = partial(_recut, crown_ratio, pavilion_ratio, girdle, table)
        proportions({})  # what is wrong of them is said before a file is read
        given = read(file)
        recut = proportions(angles_of(given, angle or []))
        with naming(str(file)):
            design = recut_design(given, recut)
            followed = angles_that_followed(given, design, recut)
            written, data, said = asc_of(design)
        for finding in (*design.findings, *followed, *said):
            typer.echo(f"{file}: {finding}", err=True)
        write_whole(out, data, "out")
        count = sum(len(tier.facets) for tier in design.tiers)
        apart = planes_apart(written, read_asc(data))
        typer.echo(f"{out}: {count} facets in {len(design.tiers)} tiers; read back, planes are {apart:.1g} apart")


@app.command()
def mesh(
    file: DesignFile,
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Mesh to write: .obj, .ply or .stl, by its ending.")],
) -> None:
    """Write a design's stone as a mesh, for other programs.

    It is as a scene has it: y up, the centre of mass at the origin, the farthest corner at 1. Of .obj the corners are
    exact in double precision, of the others rounded to single.
    """
    from culet.geometry.designs.solid import shape_of_design
    from culet.geometry.mesh_files import ENDINGS, mesh_file

    with errors_in_one_line():
        check_place(out, "out", ENDINGS)
        design = read(file)
        with naming(str(file)):
            shape = shape_of_design(design, out.stem)
        write_whole(out, mesh_file(shape, out.suffix[1:].lower()), "out")
        corners, triangles, facets = len(shape.vertices), len(shape.triangles), len(shape.planes)
        typer.echo(f"{out}: {corners} corners, {triangles} triangles of {facets} facets")


@app.command()
def diagram(
    file: DesignFile,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Drawing: .svg")] = Path("diagram.svg"),
) -> None:
    """Draw the cutting diagram on a page: four views, the index wheel, proportions and the table of tiers."""
    from culet.geometry.designs.diagram import diagram_of
    from culet.geometry.designs.solid import Solid

    with errors_in_one_line():
        check_place(out, "out", ["svg"])
        design = read(file)
        with naming(str(file)):
            solid = Solid(design)
        write_whole(out, diagram_of(solid).encode("utf-8", "replace"), "out")
        typer.echo(f"{out}: {len(solid.cut.used)} facets in {len(design.tiers)} tiers")


@app.command()
def optimise(
    file: DesignFile,
    weight: Annotated[
        list[str] | None,
        typer.Option(
            metavar="GRADE=NUMBER",
            help="What is searched for: a weighted sum of grades, as iso=1 and fire=0.5; iso=1 and fire=1 without one.",
        ),
    ] = None,
    crown: Annotated[str, typer.Option(metavar="FROM:TO", help="Tangent ratios of the crown.")] = "0.8:1.25",
    pavilion: Annotated[str, typer.Option(metavar="FROM:TO", help="Tangent ratios of the pavilion.")] = "0.9:1.1",
    angles: Annotated[
        float,
        typer.Option(
            min=0,
            max=10,
            metavar="DEGREES",
            help="Then angles of single tiers by so much, meets kept; 0: ratios alone.",
        ),
    ] = 2.0,
    evaluations: Annotated[
        int,
        typer.Option(
            min=10, max=100_000, help="Designs to grade besides the given one, at most; half of them of other angles."
        ),
    ] = 200,
    material: MaterialOption = None,
    index: IndexOption = None,
    head: HeadOption = None,
    rules: RulesName = "culet",
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE.csv", help="The front as a table.")] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
) -> None:
    """Search crown and pavilion for brightness and fire, all meets kept.

    First tangent ratios of crown and pavilion, then angles of single tiers. Prints the front: designs that no other
    beats in both, since there is no single best one. Each is cut by culet design convert with its ratios and angles.
    Ctrl-C ends the search with the front of what was graded. Whoever grades, the same designs are found.
    """
    from culet.batch.angle_search import LEAST_REACH, free_angles
    from culet.batch.candidates import Candidates
    from culet.command.search import front_csv, print_front, range_of, weights_of
    from culet.grading.optics import optics_of

    with errors_in_one_line():
        if out is not None:
            check_place(out, "out", ["csv"])
        if 0 < angles < LEAST_REACH:
            raise InputError(f"angles: expected 0, or {LEAST_REACH:g} to 10 degrees, got {angles:g}", "angles")
        weights = weights_of(weight or ["iso=1", "fire=1"])
        ends = range_of("crown", crown), range_of("pavilion", pavilion)
        judged = rules_named(rules, head)
        stage = with_material(subject(str(file), None), material, index)
        stone, shape = stage.scene.stones[0], stage.shapes[0]
        optics = optics_of(stone, stage.scene.millimetres)
        turned = bool(angles and free_angles(shape))
        if angles and not turned:
            typer.echo(f"{file}: no tier can be turned by itself with all meets kept; ratios alone", err=True)
        with (
            crew_of(workers, scheduler, tls_ca, tls_cert, tls_key, afterwards="what was graded is told") as crew,
            progress_bar("searching") as advance,
        ):
            candidates = Candidates(
                shape, optics, judged, weights, crew=crew, progress=lambda count: advance(min(1, count / evaluations))
            )
            ended = _search(candidates, *ends, angles if turned else 0, evaluations)
        if candidates.found:
            print_front(report_console(), candidates, weights)
            if out is not None:
                write_whole(out, front_csv(candidates, weights), "out")
                typer.echo(f"{out}: {len(candidates.front())} designs of {len(candidates.found)} that were graded")
        if isinstance(ended, KeyboardInterrupt):
            typer.echo(f"culet: interrupted after {len(candidates.graded)} designs", err=True)
            raise typer.Exit(130)
        if ended is not None:
            raise ended


def _search(
    candidates: Candidates, crown: Range, pavilion: Range, angles: float, evaluations: int
) -> KeyboardInterrupt | WorkersError | None:
    """What has ended it too early, so that what was found until then can be told."""
    from culet.batch.angle_search import search_angles
    from culet.batch.search import search_ratios

    try:
        search_ratios(candidates, crown, pavilion, evaluations // 2 if angles else evaluations)
        if angles:
            search_angles(candidates, angles, evaluations - len(candidates.graded))
    except (KeyboardInterrupt, WorkersError) as error:
        return error
    return None


def _recut(crown: float, pavilion: float, girdle: float | None, table: float | None, angles: dict[int, float]) -> Recut:
    """SceneError names the proportion that is out of range."""
    from pydantic import ValidationError

    from culet.scene.recut import Recut
    from culet.scene.refusal import scene_error

    try:
        return Recut(
            crown_ratio=crown, pavilion_ratio=pavilion, girdle_percent=girdle, table_percent=table, angles=angles
        )
    except ValidationError as error:
        raise scene_error(error, Recut) from error


def read(file: Path) -> Design:
    """The design in a file, or a cut's by its name; InputError names the file or the proportion."""
    from culet.geometry.cuts.cut import shape_of_cut
    from culet.geometry.cuts.wording import cut_headings
    from culet.geometry.designs.of_shape import design_of
    from culet.geometry.designs.reader import read_design
    from culet.scene.cut_text import cut_from_text
    from culet.scene.cuts import CUTS

    if str(file).partition(",")[0] in CUTS and not file.exists():
        cut = cut_from_text(str(file))
        return design_of(shape_of_cut(cut), cut_headings(cut))
    try:
        data = file.read_bytes()
    except OSError as error:
        raise MeshError(f"{file}: cannot be read: {error.strerror}") from error
    with naming(str(file)):
        return read_design(data, file.suffix)

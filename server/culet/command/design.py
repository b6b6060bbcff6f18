"""`culet design`: what is in cutters' files, and one of them as another. What a command needs is imported by it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.terminal import errors_in_one_line, report_console
from culet.errors import MeshError
from culet.places import check_place, write_whole
from culet.sources import naming

if TYPE_CHECKING:
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
) -> None:
    """Write a design as .asc: the same facets, tiers, names and notes. The file is read back and compared first.

    With ratios, a girdle or a table the design is cut anew.
    """
    from culet.geometry.designs.asc import read_asc
    from culet.geometry.designs.asc_writer import asc_of, planes_apart
    from culet.geometry.designs.recut import recut_design

    with errors_in_one_line():
        check_place(out, "out", ["asc"])
        recut = _recut(crown_ratio, pavilion_ratio, girdle, table)
        design = read(file)
        with naming(str(file)):
            design = recut_design(design, recut)
            written, data, said = asc_of(design)
        for finding in (*design.findings, *said):
            typer.echo(f"{file}: {finding}", err=True)
        write_whole(out, data, "out")
        count = sum(len(tier.facets) for tier in design.tiers)
        apart = planes_apart(written, read_asc(data))
        typer.echo(f"{out}: {count} facets in {len(design.tiers)} tiers; read back, planes are {apart:.1g} apart")


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


def _recut(crown: float, pavilion: float, girdle: float | None, table: float | None) -> Recut:
    """SceneError names the proportion that is out of range."""
    from pydantic import ValidationError

    from culet.scene.recut import Recut
    from culet.scene.refusal import scene_error

    try:
        return Recut(crown_ratio=crown, pavilion_ratio=pavilion, girdle_percent=girdle, table_percent=table)
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

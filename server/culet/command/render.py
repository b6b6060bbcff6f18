"""`culet render`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.command.options import CutText, MeshFile, PresetOption, SceneFile, SkyFile
from culet.command.single import single_command
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar
from culet.errors import InputError
from culet.places import check_place
from culet.scene.film import MOST_SAMPLES

app = single_command()


@app.command()
def render(
    scene: SceneFile = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE", help="Picture: .png .jpg .webp .tga, or linear: .exr .npy")
    ] = Path("out.png"),
    width: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 640,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 360,
    samples: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=MOST_SAMPLES,
            help="Samples per pixel, with --error at most; without either as many, from 16 to 256, as an error of 0.01 "
            "takes.",
        ),
    ] = None,
    error: Annotated[
        float | None,
        typer.Option(
            metavar="RMSE",
            help="Take samples until what is shown, from 0 to 1, is estimated to be off by this (root mean square over "
            "pixels and colours); from 0.004 on no difference is seen.",
        ),
    ] = None,
    background: Annotated[
        str | None,
        typer.Option(
            metavar="transparent|#rrggbb", help="Nothing behind the stones, with alpha, or that colour; twice the work."
        ),
    ] = None,
    legend: Annotated[
        bool, typer.Option("--legend", help="In a corner, what ASET's or the Ideal-Scope's colours mean, and the tilt.")
    ] = False,
    preset: PresetOption = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
    cut: CutText = None,
) -> None:
    """Render a still picture into a file."""
    from culet.rendering.film.files import FORMATS

    with errors_in_one_line():
        check_place(out, "out", FORMATS)
        if legend and out.suffix.lower() in (".exr", ".npy"):
            raise InputError(f"legend: expected a picture for a screen, got {out.name!r} of radiance", "legend")
        from culet.rendering.opencl.device import open_in_advance

        open_in_advance()
        from culet.legend import legend_for
        from culet.stills import before, render_stage

        stage = read_stage(scene, preset, mesh, sky, cut)
        if background is not None:
            stage = before(stage, background)
        if legend:
            legend_for(stage.scene, width, height)  # a refusal comes before the work
        with progress_bar(f"rendering {out.name}") as advance:
            picture = render_stage(stage, width, height, samples=samples, error=error, progress=advance)
        if legend:
            picture = picture.with_legend()
        picture.save(out)
        typer.echo(f"{out}: {width} x {height}, {picture.quality()}")

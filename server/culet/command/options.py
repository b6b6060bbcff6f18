"""Options that several commands have, so that they are the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.scene import PRESETS
from culet.scene.cuts import CUTS, summary

SceneFile = Annotated[
    Path | None,
    typer.Argument(metavar="[SCENE.json]", help="Scene to read; - for standard input. Without it, the default scene."),
]


def _presets_that_begin(incomplete: str) -> list[tuple[str, str]]:
    """For completion by the shell."""
    return [(name, each.summary) for name, each in PRESETS.items() if name.startswith(incomplete)]


PresetOption = Annotated[
    str | None,
    typer.Option(help=f"Start from a named scene instead: {', '.join(PRESETS)}.", autocompletion=_presets_that_begin),
]
MeshFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Mesh (.obj .off .stl .ply .glb) or design (.asc .gem .gcs) that takes the place of the stone.",
    ),
]


def _cuts_that_begin(incomplete: str) -> list[tuple[str, str]]:
    """For completion by the shell."""
    return [(name, summary(name)) for name in CUTS if name.startswith(incomplete)]


CutText = Annotated[
    str | None,
    typer.Option(
        "--cut",
        metavar="NAME[,PROPORTION=NUMBER...]",
        help=f"Cut that takes the place of the stone's shape, as emerald,length_to_width=1.6: {', '.join(CUTS)}.",
        autocompletion=_cuts_that_begin,
    ),
]
SkyFile = Annotated[
    Path | None,
    typer.Option("--sky", metavar="FILE", help="Panorama (.exr .hdr .png, twice as wide as high) as the scene's sky."),
]

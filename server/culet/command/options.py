"""Options that several commands have, so that they are the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.scene import PRESETS

SceneFile = Annotated[
    Path | None,
    typer.Argument(metavar="[SCENE.json]", help="Scene to read; - for standard input. Without it, the default scene."),
]


def _presets_that_begin(incomplete: str) -> list[tuple[str, str]]:
    """For completion by the shell."""
    return [(name, each.summary) for name, each in PRESETS.items() if name.startswith(incomplete)]


Preset = Annotated[
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
SkyFile = Annotated[
    Path | None,
    typer.Option("--sky", metavar="FILE", help="Panorama (.exr .hdr .png, twice as wide as high) as the scene's sky."),
]

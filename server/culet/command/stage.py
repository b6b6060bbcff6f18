"""The stage that a command is about, from files and names; what is found in them goes to stderr."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from culet.errors import SceneError
from culet.sources import load_scene, load_stage, naming, parse_json, with_cut

if TYPE_CHECKING:
    from culet.scene import Scene
    from culet.stage import Stage

STDIN = "-"


def read_stage(
    file: Path | None, preset: str | None, mesh: Path | None, sky: Path | None = None, cut: str | None = None
) -> Stage:
    """From what the user named; InputError says which of it cannot be used, and why."""
    from culet.scene.cut_text import cut_from_text

    if file is not None and preset is not None:
        raise SceneError("expected a scene file or a preset, got both")
    if mesh is not None and cut is not None:
        raise SceneError("expected a mesh or a cut, got both")
    scene = _scene(file, preset)
    if cut is not None:
        scene = with_cut(scene, cut_from_text(cut))
    return load_stage(scene, mesh, sky, _tell, sky_is_seen=file is None, name=_name(file))


def _scene(file: Path | None, preset: str | None) -> Scene:
    from culet.scene import Scene
    from culet.scene import preset as preset_scene

    if preset is not None:
        return preset_scene(preset)
    if str(file) == STDIN:
        with naming(_name(file)):
            return Scene.read(parse_json(sys.stdin.buffer.read()))
    return load_scene(file)


def _name(file: Path | None) -> str | None:
    return None if file is None else "standard input" if str(file) == STDIN else str(file)


def _tell(finding: str) -> None:
    typer.echo(finding, err=True)

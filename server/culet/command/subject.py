"""Scene, stone and sky that a command is about, from files and names. What reading needs is imported by the reading."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from culet.errors import InputError, MeshError, SceneError

if TYPE_CHECKING:
    from culet.geometry.stone import Stone
    from culet.rendering.panoramas import Panorama
    from culet.scene import Scene


class Subject(NamedTuple):
    """What a command is about."""

    scene: Scene
    stone: Stone | None
    """None if the scene has none."""
    panorama: Panorama | None
    """The sky from a file; None if the scene's own counts."""


def read_subject(file: Path | None, preset: str | None, mesh: Path | None, sky: Path | None = None) -> Subject:
    """From what the user named; InputError says which of it cannot be used. What was repaired goes to stderr."""
    from culet.geometry.load import stone_of
    from culet.scene import Scene
    from culet.scene import preset as preset_scene

    if file is not None and preset is not None:
        raise SceneError("expected a scene file or a preset, got both")
    scene = preset_scene(preset) if preset is not None else Scene.read(_json(file))
    meshes = {}
    if mesh is not None:
        from culet.geometry.mesh import stone_from_mesh

        try:
            data = mesh.read_bytes()
        except OSError as error:
            raise MeshError(f"cannot read {mesh}: {error.strerror}") from error
        meshes["file"] = stone_from_mesh(data, mesh.suffix.lower().lstrip("."), name=mesh.stem)
        for finding in meshes["file"].findings:
            typer.echo(f"{mesh}: {finding}", err=True)
        stone = (scene.stones[0] if scene.stones else Scene().stones[0]).model_copy(update={"mesh": "file"})
        scene = scene.model_copy(update={"stones": (stone,)})
    scene, panorama = _with_sky(scene, sky)
    return Subject(scene, stone_of(scene.stones[0], meshes) if scene.stones else None, panorama)


def _with_sky(scene: Scene, file: Path | None) -> tuple[Scene, Panorama | None]:
    """The scene under a panorama from a file, which keeps the scale and turn that it may have given to another."""
    from culet.rendering.panoramas import read_panorama
    from culet.scene.model import ImageEnvironment

    if file is None:
        return scene, None
    try:
        panorama = read_panorama(file.read_bytes(), file.suffix.lower().lstrip("."))
    except OSError as error:
        raise InputError(f"cannot read {file}: {error.strerror}", "sky") from error
    image = scene.environment if isinstance(scene.environment, ImageEnvironment) else ImageEnvironment(kind="image")
    return scene.model_copy(update={"environment": image.model_copy(update={"image": "file"})}), panorama


def _json(file: Path | None) -> object:
    """What a JSON file holds; nothing named, the empty object."""
    if file is None:
        return {}
    try:
        return json.loads(sys.stdin.buffer.read() if str(file) == "-" else file.read_bytes())
    except OSError as error:
        raise SceneError(f"cannot read {file}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:  # JSONDecodeError, UnicodeDecodeError; nested beyond all reason
        raise SceneError(f"{file} is not JSON: {error}") from error

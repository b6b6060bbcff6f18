"""Scene, stone and sky that a command is about, from files and names. What reading needs is imported by the reading."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from culet.command.terminal import libraries_silenced
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
    """From what the user named; InputError says which of it cannot be used, and why. Findings go to stderr."""
    from culet.geometry.load import stone_of
    from culet.scene import Scene
    from culet.scene import preset as preset_scene

    if file is not None and preset is not None:
        raise SceneError("expected a scene file or a preset, got both")
    meshes = {}
    with _naming(file):
        scene = preset_scene(preset) if preset is not None else Scene.read(_json(file))
    if mesh is not None:
        meshes["file"] = _mesh(mesh)
        scene = _with_mesh(scene, meshes["file"])
    scene, panorama = _with_sky(scene, sky, seen=file is None)
    with _naming(file):
        return Subject(scene, stone_of(scene.stones[0], meshes) if scene.stones else None, panorama)


def _with_mesh(scene: Scene, shape: Stone) -> Scene:
    """The scene with that shape in place of its stone's, on the floor if the stone was."""
    from culet.geometry.load import stone_of
    from culet.scene import Scene
    from culet.simulation.lying import on_the_floor

    placed = scene.stones[0] if scene.stones else Scene().stones[0]
    named = scene.model_copy(update={"stones": (placed.model_copy(update={"mesh": "file"}),)})
    return named if placed.mesh is not None else on_the_floor(named, shape, stone_of(placed, {}))


def _mesh(file: Path) -> Stone:
    """The stone in a mesh file; what was found in it, or repaired, goes to stderr."""
    from culet.geometry.mesh import stone_from_mesh

    try:
        data = file.read_bytes()
    except OSError as error:
        raise MeshError(f"{file}: cannot be read: {error.strerror}") from error
    with _naming(file):
        stone = stone_from_mesh(data, file.suffix.lower().lstrip("."), name=file.stem)
    _report(file, stone.findings)
    return stone


def _with_sky(scene: Scene, file: Path | None, *, seen: bool) -> tuple[Scene, Panorama | None]:
    """The scene under a panorama from a file, which keeps the scale and turn that it may have given to another.

    `seen`: nothing hides it; else the scene says whether a backdrop does.
    """
    from culet.rendering.sky_files.reading import read_sky
    from culet.scene.model import ImageEnvironment
    from culet.scene.sky_seen import under

    if file is None:
        return scene, None
    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}", "sky") from error
    with _naming(file), libraries_silenced():
        picture = read_sky(data, file.suffix.lower().lstrip("."))
    _report(file, picture.findings)
    image = scene.environment if isinstance(scene.environment, ImageEnvironment) else ImageEnvironment(kind="image")
    image = image.model_copy(update={"image": "file"})
    scene = under(scene, image) if seen else scene.model_copy(update={"environment": image})
    return scene, picture.pixels


def _report(file: Path, findings: Iterable[str]) -> None:
    for finding in findings:
        typer.echo(f"{file}: {finding}", err=True)


def _json(file: Path | None) -> object:
    """What a JSON file holds; nothing named, the empty object."""
    if file is None:
        return {}
    try:
        return json.loads(sys.stdin.buffer.read() if str(file) == "-" else file.read_bytes())
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:  # JSONDecodeError, UnicodeDecodeError; nested beyond all reason
        raise SceneError(f"not JSON: {error}") from error


@contextlib.contextmanager
def _naming(file: Path | None) -> Iterator[None]:
    """What cannot be used is told with the name of the file that it was read from."""
    try:
        yield
    except InputError as error:
        if file is None:
            raise
        name = "standard input" if str(file) == "-" else str(file)
        raise type(error)(f"{name}: {error}", error.field) from error

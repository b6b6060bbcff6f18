"""The stage that a command is about, from files and names. What reading needs is imported by the reading."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from culet.command.terminal import libraries_silenced
from culet.errors import CuletError, InputError, MeshError, SceneError

if TYPE_CHECKING:
    from culet.geometry.shape import Shape
    from culet.optics.sky_files.picture import SkyPicture
    from culet.scene import Scene
    from culet.stage import Stage


FILE = "file"
"""In place of the id of an upload: the mesh or the sky that a command was given as a file."""


def read_stage(file: Path | None, preset: str | None, mesh: Path | None, sky: Path | None = None) -> Stage:
    """From what the user named; InputError says which of it cannot be used, and why. Findings go to stderr."""
    from culet.scene import Scene
    from culet.scene import preset as preset_scene
    from culet.stage import Library, Stage

    if file is not None and preset is not None:
        raise SceneError("expected a scene file or a preset, got both")
    meshes, skies = {}, {}
    with _naming(file):
        scene = preset_scene(preset) if preset is not None else Scene.read(_json(file))
    if mesh is not None:
        meshes[FILE] = _mesh(mesh)
        scene = _with_mesh(scene, meshes[FILE])
    if sky is not None:
        skies[FILE] = _sky(sky)
        scene = _under_the_file(scene, seen=file is None)
    with _naming(file):
        stage = Stage.of(scene, Library(meshes, skies))
    _report_overlaps(stage)
    return stage


def _with_mesh(scene: Scene, shape: Shape) -> Scene:
    """The scene with that shape in place of its stone's, on the floor if the stone was."""
    from culet.geometry.load import shape_of
    from culet.scene import Scene
    from culet.simulation.lying import on_the_floor

    placed = scene.only_stone() or Scene().stones[0]
    named = scene.model_copy(update={"stones": (placed.model_copy(update={"mesh": FILE}),)})
    return named if placed.mesh is not None else named.moved(on_the_floor(placed, shape, placed, shape_of(placed, {})))


def _mesh(file: Path) -> Shape:
    """The shape in a mesh file; what was found in it, or repaired, goes to stderr."""
    from culet.geometry.mesh import shape_from_mesh

    try:
        data = file.read_bytes()
    except OSError as error:
        raise MeshError(f"{file}: cannot be read: {error.strerror}") from error
    with _naming(file):
        shape = shape_from_mesh(data, file.suffix.lower().lstrip("."), name=file.stem)
    _report(file, shape.findings)
    return shape


def _sky(file: Path) -> SkyPicture:
    """The panorama in a file; what was found in it, or left out, goes to stderr."""
    from culet.optics.sky_files.reading import read_sky

    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}", "sky") from error
    with _naming(file), libraries_silenced():
        picture = read_sky(data, file.suffix.lower().lstrip("."))
    _report(file, picture.findings)
    return picture


def _under_the_file(scene: Scene, *, seen: bool) -> Scene:
    """The scene under the panorama from a file, which keeps the scale and turn that it may have given to another.

    `seen`: nothing hides it; else the scene says whether a backdrop does.
    """
    from culet.scene.sky import ImageEnvironment
    from culet.scene.sky_seen import under

    image = scene.environment if isinstance(scene.environment, ImageEnvironment) else ImageEnvironment(kind="image")
    image = image.model_copy(update={"image": FILE})
    return under(scene, image) if seen else scene.model_copy(update={"environment": image, "emitters": scene.points})


def _report(file: Path, findings: Iterable[str]) -> None:
    for finding in findings:
        typer.echo(f"{file}: {finding}", err=True)


def _report_overlaps(stage: Stage) -> None:
    """Which of several stones are inside each other, to stderr."""
    if len(stage.scene.stones) < 2:
        return
    from culet.simulation.overlaps import overlaps
    from culet.simulation.staged import world_of

    with contextlib.suppress(CuletError):  # stones that no solver here can move are drawn all the same
        for finding in overlaps(world_of(stage)):
            typer.echo(finding, err=True)


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

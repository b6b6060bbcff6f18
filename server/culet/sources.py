"""Stages from what a caller names: a scene by preset, mapping or file, a mesh and a sky by file.

What reading needs is imported by the reading, so that a command that refuses its input answers at once.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from culet.errors import CuletError, InputError, MeshError, SceneError

if TYPE_CHECKING:
    from culet.geometry.shape import Shape
    from culet.optics.sky_files.picture import SkyPicture
    from culet.scene import Scene
    from culet.scene.cuts import AnyCut
    from culet.stage import Stage

FILE = "file"
"""In place of the id of an upload: the mesh or the sky that was given as a file."""
SCENE_ENDING = ".json"
"""Of a text that names a file, not a preset."""

Tell = Callable[[str], None]
"""Told what was found in the files, repaired or left out, and which stones overlap, a sentence each."""


def load_scene(source: Scene | Mapping[str, Any] | str | os.PathLike[str] | None = None) -> Scene:
    """The scene that somebody means.

    Args:
        source: the name of a preset; the path of a JSON file, a `Path` or a text that ends in `.json`; what such a file
            holds, as a mapping; a scene, which is returned as it is; nothing for the default scene.

    Raises:
        SceneError: for a scene that cannot be used; its `field` names the place.
        NotFoundError: for a name that no preset has; says which there are.

    >>> load_scene("ruby").stones[0].material
    'ruby'
    >>> load_scene({"floor": {"kind": "matte"}}).floor.kind
    'matte'
    """
    from culet.scene import Scene, preset

    match source:
        case None:
            return Scene()
        case Scene():
            return source
        case str() if not source.lower().endswith(SCENE_ENDING):
            return preset(source)
        case str() | os.PathLike():
            file = Path(source)
            with naming(str(file)):
                return Scene.read(_read_json(file))
        case Mapping():
            return Scene.read(dict(source))
    raise SceneError(
        f"expected a scene, the name of a preset, the path of a {SCENE_ENDING} file or a mapping; got {source!r}"
    )


def load_stage(
    scene: Scene, mesh: Path | None, sky: Path | None, tell: Tell, *, sky_is_seen: bool = False, name: str | None = None
) -> Stage:
    """The scene's stage, with the mesh of a file in place of its stone, and under the panorama of a file.

    `sky_is_seen`: no backdrop hides the panorama, whatever the scene has. `name` is what errors of the scene begin
    with. InputError says what cannot be used, and why.
    """
    from culet.stage import Library, Stage

    meshes, skies = {}, {}
    if mesh is not None:
        meshes[FILE] = _mesh(mesh, tell)
        scene = _with_mesh(scene, meshes[FILE])
    if sky is not None:
        skies[FILE] = _sky(sky, tell)
        scene = _under_the_file(scene, seen=sky_is_seen)
    with naming(name):
        stage = Stage.of(scene, Library(meshes, skies))
    _tell_overlaps(stage, tell)
    return stage


def with_cut(scene: Scene, cut: AnyCut) -> Scene:
    """The scene with its stone cut so, on the floor if the stone was; MeshError if the proportions make no stone."""
    from culet.geometry.cuts.cut import shape_of_cut
    from culet.geometry.load import shape_of
    from culet.scene import Scene
    from culet.simulation.lying import on_the_floor

    placed = scene.only_stone() or Scene().stones[0]
    shape = shape_of_cut(cut)
    stone = placed.model_copy(update={"cut": cut, "mesh": None, "recut": None})
    named = scene.model_copy(update={"stones": (stone,)})
    return named if placed.mesh is not None else named.moved(on_the_floor(stone, shape, placed, shape_of(placed, {})))


def _with_mesh(scene: Scene, shape: Shape) -> Scene:
    """The scene with that shape in place of its stone's, on the floor if the stone was."""
    from culet.geometry.load import shape_of
    from culet.scene import Scene
    from culet.simulation.lying import on_the_floor

    placed = scene.only_stone() or Scene().stones[0]
    stone = placed.model_copy(update={"mesh": FILE, "recut": None})
    named = scene.model_copy(update={"stones": (stone,)})
    return named if placed.mesh is not None else named.moved(on_the_floor(stone, shape, placed, shape_of(placed, {})))


def _mesh(file: Path, tell: Tell) -> Shape:
    """The shape in a file of a mesh or of a design."""
    from culet.geometry.stone_file import shape_from_file

    try:
        data = file.read_bytes()
    except OSError as error:
        raise MeshError(f"{file}: cannot be read: {error.strerror}") from error
    with naming(str(file)):
        shape = shape_from_file(data, file.suffix, name=file.stem)
    _tell_of(file, shape.findings, tell)
    return shape


def _sky(file: Path, tell: Tell) -> SkyPicture:
    """The panorama in a file."""
    from culet.optics.sky_files.reading import read_sky

    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}", "sky") from error
    with naming(str(file)), libraries_silenced():
        picture = read_sky(data, file.suffix.lower().lstrip("."))
    _tell_of(file, picture.findings, tell)
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


def _tell_of(file: Path, findings: Iterable[str], tell: Tell) -> None:
    for finding in findings:
        tell(f"{file}: {finding}")


def _tell_overlaps(stage: Stage, tell: Tell) -> None:
    """Which of several stones are inside each other."""
    if len(stage.scene.stones) < 2:
        return
    from culet.simulation.overlaps import overlaps
    from culet.simulation.staged import world_of

    with contextlib.suppress(CuletError):  # stones that no solver here can move are drawn all the same
        for finding in overlaps(world_of(stage)):
            tell(finding)


def _read_json(file: Path) -> object:
    try:
        data = file.read_bytes()
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}") from error
    return parse_json(data)


def parse_json(data: bytes) -> object:
    """What JSON text holds; SceneError for what is none."""
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:  # JSONDecodeError, UnicodeDecodeError; nested beyond all reason
        raise SceneError(f"not JSON: {error}") from error


@contextlib.contextmanager
def naming(source: str | None) -> Iterator[None]:
    """What cannot be used is told with the name of what it was read from."""
    try:
        yield
    except InputError as error:
        if source is None:
            raise
        raise type(error)(f"{source}: {error}", error.field) from error


@contextlib.contextmanager
def libraries_silenced() -> Iterator[None]:
    """What C libraries print by themselves, such as libpng, does not reach the terminal: the error says it."""
    sys.stderr.flush()
    kept = os.dup(2)
    with open(os.devnull, "wb") as nowhere:  # noqa: PTH123 - a device
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)

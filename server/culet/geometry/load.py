"""The shapes of a scene's stones."""

from __future__ import annotations

from collections.abc import Mapping

from culet.errors import MeshError, SceneError
from culet.geometry.brilliant import brilliant
from culet.geometry.shape import Shape
from culet.scene.model import BrilliantCut, StoneSettings


def shape_of(settings: StoneSettings, meshes: Mapping[str, Shape]) -> Shape:
    """The mesh that the settings name, or else their cut.

    `meshes` holds what was uploaded, by id. SceneError if the id is unknown; MeshError, its field within the scene, if
    the cut's proportions make no shape.
    """
    if settings.mesh is not None:
        try:
            return meshes[settings.mesh]
        except KeyError:
            raise SceneError(f"stones.0.mesh: no uploaded mesh {settings.mesh!r}", "stones.0.mesh") from None
    cut = BrilliantCut() if settings.cut == "brilliant" else settings.cut
    try:
        return brilliant(cut)
    except MeshError as error:
        field = "stones.0.cut" if error.field is None else f"stones.0.cut.{error.field}"
        raise MeshError(str(error), field) from error

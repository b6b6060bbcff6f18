"""The shape of a stone of a scene."""

from __future__ import annotations

from collections.abc import Mapping

from culet.errors import MeshError, SceneError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.shape import Shape
from culet.scene.cuts import proportions
from culet.scene.stone import StoneSettings


def shape_of(settings: StoneSettings, meshes: Mapping[str, Shape], field: str = "stones.0") -> Shape:
    """The mesh that the settings name, or else their cut.

    `meshes` holds what was uploaded, by id; `field` is the stone's place in the scene. SceneError if the id is unknown;
    MeshError, its field within the scene, if the cut's proportions make no shape.
    """
    if settings.mesh is not None:
        try:
            return meshes[settings.mesh]
        except KeyError:
            raise SceneError(f"{field}.mesh: no uploaded mesh {settings.mesh!r}", f"{field}.mesh") from None
    try:
        return shape_of_cut(proportions(settings.cut))
    except MeshError as error:
        within = f"{field}.cut" if error.field is None else f"{field}.cut.{error.field}"
        raise MeshError(str(error), within) from error

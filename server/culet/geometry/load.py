"""The shape of a stone of a scene."""

from __future__ import annotations

from collections.abc import Mapping

from culet.errors import MeshError, SceneError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cutting.recut import recut_shape
from culet.geometry.designs.shipped import SHIPPED, shipped_shape
from culet.geometry.shape import Shape
from culet.scene.cuts import proportions
from culet.scene.stone import StoneSettings


def shape_of(settings: StoneSettings, meshes: Mapping[str, Shape], field: str = "stones.0") -> Shape:
    """The mesh that the settings name, or else their cut, cut anew if they say so.

    `meshes` holds what was uploaded, by id, besides the designs that are shipped; `field` is the stone's place in the
    scene. SceneError if the id is unknown; MeshError, its field within the scene, if the proportions make no shape.
    """
    shape = _as_it_came(settings, meshes, field)
    if settings.recut is None:
        return shape
    try:
        return recut_shape(shape, settings.recut)
    except MeshError as error:
        raise _within(f"{field}.recut", error) from error


def _as_it_came(settings: StoneSettings, meshes: Mapping[str, Shape], field: str) -> Shape:
    if settings.mesh is not None:
        if settings.mesh in meshes:
            return meshes[settings.mesh]
        if settings.mesh in SHIPPED:
            return shipped_shape(settings.mesh)
        raise SceneError(f"{field}.mesh: no uploaded mesh {settings.mesh!r}", f"{field}.mesh")
    try:
        return shape_of_cut(proportions(settings.cut))
    except MeshError as error:
        raise _within(f"{field}.cut", error) from error


def _within(field: str, error: MeshError) -> MeshError:
    return MeshError(str(error), field if error.field is None else f"{field}.{error.field}")

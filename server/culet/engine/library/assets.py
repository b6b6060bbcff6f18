"""What scenes name: the uploads that an engine has read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.panoramas import Panorama, panorama_of
from culet.rendering.sky_files.picture import SkyPicture
from culet.scene import Environment, StoneSettings
from culet.scene.model import ImageEnvironment


@dataclass(frozen=True)
class Assets:
    """By the ids of the uploads."""

    meshes: Mapping[str, Shape]
    skies: Mapping[str, SkyPicture]

    def stone(self, settings: StoneSettings) -> Shape:
        """The stone's shape, which may take a while to make; SceneError for an unknown id, MeshError for no shape."""
        return shape_of(settings, self.meshes)

    def panorama(self, environment: Environment) -> Panorama | None:
        """The picture of a sky that is one; SceneError for an unknown id."""
        if not isinstance(environment, ImageEnvironment):
            return None
        picture = self.skies.get(environment.image)
        return panorama_of(environment, {} if picture is None else {environment.image: picture.pixels})

"""A stage: a scene with the shapes of its stones and the picture of its sky, which is all that a picture or a step of
the simulation depends on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

from culet.geometry.designs.shipped import SHIPPED
from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.optics.panoramas import STUDIO, Panorama, panorama_of
from culet.optics.sky_files.picture import SkyPicture
from culet.scene.fields import Pose
from culet.scene.model import Scene
from culet.scene.sky import Environment, ImageEnvironment
from culet.scene.sky_seen import Surroundings
from culet.scene.stone import StoneSettings


class Sky(NamedTuple):
    """An environment, with its picture."""

    environment: Environment
    panorama: Panorama | None = None
    """Of an environment that is an image; None of another."""
    surroundings: Surroundings | None = None
    """Those that it was seen with, before the scene was put under the light one."""


@dataclass(frozen=True)
class Library:
    """What scenes name by an id: the uploads that an engine has read, or the files of a command."""

    meshes: Mapping[str, Shape] = field(default_factory=dict)
    skies: Mapping[str, SkyPicture] = field(default_factory=dict)
    around_shape: Callable[[], object] = lambda: None
    """Called before each shape that is made, and after it; it may raise, where that is not wanted any more."""

    def shape(self, stone: StoneSettings, field: str) -> Shape:
        """The shape of a stone, which is that field of its scene. It may take seconds; raises as `shape_of` does."""
        self.around_shape()
        shape = shape_of(stone, self.meshes, field)
        self.around_shape()
        return shape

    def sky(self, environment: Environment) -> Sky:
        """The environment with its picture; SceneError for an unknown id."""
        if not isinstance(environment, ImageEnvironment):
            return Sky(environment)
        picture = self.skies.get(environment.image)
        uploads = {} if picture is None else {environment.image: picture.pixels}
        return Sky(environment, panorama_of(environment, uploads))


NOTHING = Library()
"""The library of those who uploaded nothing."""


@dataclass(frozen=True)
class Stage:
    """Immutable; `of` makes one, the other methods vary it. Equal are those of equal scenes and the same shapes."""

    scene: Scene
    shapes: tuple[Shape, ...]
    """One for each stone of the scene, in the scene's order."""
    panorama: Panorama | None = field(compare=False)
    """The picture of the scene's sky, where that is an image."""

    @classmethod
    def of(cls, scene: Scene, library: Library = NOTHING, *, before: Stage | None = None) -> Self:
        """The stage of a scene. Making a shape may take a while.

        What `before` has is taken from it: the library may have forgotten or replaced it since. SceneError names the
        field of an unknown id, MeshError that of a cut whose proportions make no shape.
        """
        known: dict[object, Shape] = {}
        panorama = None
        if before is not None:
            known = dict(zip(map(_form, before.scene.stones), before.shapes, strict=True))
            panorama = before.panorama if _image(scene) == _image(before.scene) else None
        shapes = tuple(
            known.get(_form(stone)) or library.shape(stone, f"stones.{number}")
            for number, stone in enumerate(scene.stones)
        )
        return cls(scene, shapes, library.sky(scene.environment).panorama if panorama is None else panorama)

    @property
    def sky(self) -> Sky:
        """The scene's environment with its picture."""
        return Sky(self.scene.environment, self.panorama)

    def uses(self) -> frozenset[str]:
        """Ids of the uploads that the scene names."""
        return uploads_of(self.scene)

    def showing(self, scene: Scene) -> Self:
        """This stage with a scene that differs in nothing that shapes or the sky's picture depend on; ValueError if it
        does."""
        if _resolved(scene) != _resolved(self.scene):
            raise ValueError(f"expected a scene of {_resolved(self.scene)}, got one of {_resolved(scene)}")
        return replace(self, scene=scene)

    def under(self, sky: Sky) -> Self:
        """This stage under another sky."""
        scene = self.scene.model_copy(update={"environment": sky.environment})
        return replace(self, scene=scene, panorama=sky.panorama)

    def posed(self, poses: Iterable[Pose]) -> Self:
        """This stage with its stones elsewhere: a pose for each of them."""
        return replace(self, scene=self.scene.moved(*poses))


def uploads_of(scene: Scene, *environments: Environment) -> frozenset[str]:
    """Ids of the uploads that a scene and further environments name."""
    meshes = {stone.mesh for stone in scene.stones if stone.mesh is not None}
    skies = {sky.image for sky in (scene.environment, *environments) if isinstance(sky, ImageEnvironment)}
    return frozenset((meshes - SHIPPED) | (skies - STUDIO.keys()))


def _resolved(scene: Scene) -> object:
    """What shapes and the sky's picture depend on."""
    return [_form(stone) for stone in scene.stones], _image(scene)


def _form(stone: StoneSettings) -> object:
    return stone.cut if stone.mesh is None else ("mesh", stone.mesh), stone.recut


def _image(scene: Scene) -> object:
    sky = scene.environment
    return (sky.image, sky.head_degrees) if isinstance(sky, ImageEnvironment) else None

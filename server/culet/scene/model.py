"""The scene: JSON in, JSON out, every field with a default, so that `{}` is the default scene.

y is up. The unit of length is R, the radius of a stone of scale 1, the unit of time the second; colours and radiance
are linear. The floor is the plane y = -1. Anything unknown, out of range or not finite is refused, with its field.
A scene of version 1 is read, and brought up to version 2 (`culet.scene.upgrade`).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from culet.errors import SceneError
from culet.scene import atelier
from culet.scene.backdrop import Backdrop, GradientBackdrop
from culet.scene.camera import Camera, Head
from culet.scene.emitters import AnyEmitter, Emitter, PointLight, check_counts, lamps, points
from culet.scene.fields import Model, Pose
from culet.scene.film import Film, Sampling
from culet.scene.motion import MotionLaws
from culet.scene.optics import Optics
from culet.scene.refusal import scene_error
from culet.scene.room import Floor, Plane, StudioFloor
from culet.scene.sky import SKIES_WITHOUT_LAMPS, Environment, StudioEnvironment
from culet.scene.stone import MOST_STONES, StoneSettings, with_ids
from culet.scene.upgrade import brought_up

CARAT_MILLIMETRES = 3.25
"""Radius R of a round brilliant of about one carat, 6.5 mm across."""
SPIN = (0.5, 3.0, 0.0)
"""rad/s, of the default stone, as in the report."""


class Scene(Model):
    """Everything that a picture depends on. `Scene()` is the default scene."""

    version: Literal[2] = 2
    millimetres: Annotated[float, Field(gt=0, le=1e9)] = Field(
        CARAT_MILLIMETRES, description="R in millimetres: how deep the colour of coloured materials is."
    )
    stones: Annotated[tuple[StoneSettings, ...], Field(max_length=MOST_STONES)] = (
        StoneSettings(id="stone", spin=SPIN),
    )
    emitters: tuple[Emitter, ...] = Field(
        atelier.LAMPS,
        description="Lamps in the sky, at most 24, and point lights, at most 8. By default the atelier's lamps under a "
        "`studio` sky, and none under any other. The skies `dark` and `light` show no lamps.",
    )
    floor: Floor = StudioFloor(kind="studio")
    walls: Plane = Plane(kind="none")
    environment: Environment = StudioEnvironment()
    backdrop: Backdrop = Field(
        GradientBackdrop(kind="gradient"), description="What the camera sees in place of the sky."
    )
    head: Head | None = Field(Head(), description="The observer's, as stones see it; none without one.")
    camera: Camera = Camera()
    optics: Optics = Optics()
    sampling: Sampling = Sampling()
    film: Film = Film()
    simulation: MotionLaws = MotionLaws()

    @model_validator(mode="before")
    @classmethod
    def _of_any_version(cls, data: Any) -> Any:  # noqa: ANN401 - whatever JSON held
        data = brought_up(data)
        if isinstance(data, dict) and "emitters" not in data:
            return {**data, "emitters": default_emitters(_kind(data.get("environment")))}
        return data

    @field_validator("stones", mode="after")
    @classmethod
    def _each_by_its_id(cls, stones: tuple[StoneSettings, ...]) -> tuple[StoneSettings, ...]:
        stones = with_ids(stones)
        places: dict[str, int] = {}
        for number, stone in enumerate(stones):
            if (first := places.setdefault(stone.id, number)) != number:
                taken = PydanticCustomError(
                    "id", "Input should be an id of its own, not that of stone {first}", {"first": first}
                )
                finding = InitErrorDetails(type=taken, loc=(number, "id"), input=stone.id)
                raise ValidationError.from_exception_data(cls.__name__, [finding])
        return stones

    @field_validator("emitters", mode="after")
    @classmethod
    def _not_too_many(cls, found: tuple[AnyEmitter, ...]) -> tuple[AnyEmitter, ...]:
        return check_counts(found)

    @classmethod
    def read(cls, data: Any) -> Scene:  # noqa: ANN401 - whatever JSON held
        """Validate parsed JSON; raise SceneError naming the first field that cannot be used."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise scene_error(error, cls) from error

    @property
    def points(self) -> tuple[PointLight, ...]:
        """The point lights."""
        return points(self.emitters)

    @property
    def shown_lamps(self) -> tuple[AnyEmitter, ...]:
        """The lamps that the sky shows."""
        return () if self.environment.kind in SKIES_WITHOUT_LAMPS else lamps(self.emitters)

    def only_stone(self) -> StoneSettings | None:
        """The stone, or None; SceneError for more than one, where only one can be handled."""
        if len(self.stones) > 1:
            raise SceneError(f"stones: expected at most 1 here, got {len(self.stones)}", "stones")
        return self.stones[0] if self.stones else None

    def moved(self, *poses: Pose) -> Scene:
        """The same scene with its stones elsewhere: a pose for each of them."""
        stones = [
            stone.model_copy(update={"position": position, "orientation": orientation})
            for stone, (position, orientation) in zip(self.stones, poses, strict=True)
        ]
        return self.model_copy(update={"stones": tuple(stones)})


def default_emitters(sky: str) -> tuple[AnyEmitter, ...]:
    """Those of a scene that names none, under a sky of that kind."""
    return atelier.LAMPS if sky == "studio" else ()


def _kind(environment: object) -> str:
    kind = environment.get("kind") if isinstance(environment, dict) else getattr(environment, "kind", "studio")
    return kind if isinstance(kind, str) else "studio"

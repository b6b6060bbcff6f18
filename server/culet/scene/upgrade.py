"""Scenes of version 1, which had one stone: what they may say, and the same picture as a scene of version 2.

There, a stone's `size_mm` made its absorption one per millimetre, the lamps were the studio's, point lights were apart,
and the simulation held the stone's mass and how it starts.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from culet.scene import atelier
from culet.scene.backdrop import Backdrop, GradientBackdrop
from culet.scene.camera import Camera, Head
from culet.scene.cuts import Cut
from culet.scene.emitters import MOST_LAMPS, MOST_POINTS, BoxLamp, PointLight, RoundLamp
from culet.scene.fields import Colour, Model, Orientation, Vector, said
from culet.scene.film import Film, Sampling
from culet.scene.motion import MotionLaws
from culet.scene.optics import Optics
from culet.scene.room import Floor, Plane, StudioFloor
from culet.scene.sky import (
    ConstantEnvironment,
    DarkEnvironment,
    GradientEnvironment,
    HalfEnvironment,
    ImageEnvironment,
    LightEnvironment,
    StudioEnvironment,
)
from culet.scene.stone import StoneMaterial, StoneSettings, UploadId

Coefficient1 = Annotated[float, Field(ge=0, le=1e9)]
ONLY_IN_1 = {"environment": {"lamps"}, "simulation": {"mass", "spin", "velocity"}}
"""Fields of the scene's parts that tell a document without a version; so do `lights`, and a stone's `size_mm`."""


class Stone1(Model):
    """The stone. A size, R in millimetres, makes its absorption one per millimetre."""

    cut: Cut = "brilliant"
    mesh: UploadId | None = None
    material: StoneMaterial = "diamond"
    absorption: tuple[Coefficient1, Coefficient1, Coefficient1] = (0, 0, 0)
    size_mm: Annotated[float, Field(gt=0, le=1e9)] | None = None
    position: Vector = (0, -0.373345, 0)
    orientation: Orientation = Field((0.93670, 0.33047, 0, 0.11566), validate_default=True)


class Light1(Model):
    """A point light."""

    position: Vector
    colour: Colour


def _shape_of_lamp(value: object) -> str | None:
    shape = said(value, "shape", "round")
    return f"<{shape}>" if shape in ("round", "box") else None


Lamp1 = Annotated[
    Annotated[RoundLamp, Tag("<round>")] | Annotated[BoxLamp, Tag("<box>")],
    Discriminator(
        _shape_of_lamp,
        custom_error_type="lamp",
        custom_error_context={"discriminator": "'shape'"},
        custom_error_message="Input should be a lamp of shape 'round' or 'box'",
    ),
]
"""One without a shape is round."""


class Studio1(Model):
    """Lamps before a uniform ground."""

    kind: Literal["studio"] = "studio"
    ambient: Colour = atelier.AMBIENT
    lamps: Annotated[tuple[Lamp1, ...], Field(max_length=MOST_LAMPS)] = atelier.LAMPS


class Simulation1(MotionLaws):
    """The laws of motion, and of the one stone what moves."""

    mass: Annotated[float, Field(ge=1e-9, le=1e9)] = 2
    spin: Vector = (0.5, 3, 0)
    velocity: Vector = (0, 0, 0)


class Scene1(Model):
    """A scene of version 1, with its defaults."""

    version: Literal[1] = 1
    stones: Annotated[tuple[Stone1, ...], Field(max_length=1)] = (Stone1(),)
    floor: Floor = StudioFloor(kind="studio")
    walls: Plane = Plane(kind="none")
    lights: Annotated[tuple[Light1, ...], Field(max_length=MOST_POINTS)] = ()
    environment: Annotated[
        ImageEnvironment
        | Studio1
        | DarkEnvironment
        | LightEnvironment
        | ConstantEnvironment
        | HalfEnvironment
        | GradientEnvironment,
        Field(discriminator="kind"),
    ] = Studio1()
    backdrop: Backdrop = GradientBackdrop(kind="gradient")
    head: Head | None = Head()
    camera: Camera = Camera()
    optics: Optics = Optics()
    sampling: Sampling = Sampling()
    film: Film = Film()
    simulation: Simulation1 = Simulation1()


def brought_up(data: Any) -> Any:  # noqa: ANN401 - whatever JSON held
    """What a document of version 1 says, as fields of version 2; any other as it came.

    pydantic's ValidationError, with the places of version 1, if it says what that version cannot.
    """
    if not isinstance(data, dict) or not _is_of_1(data):
        return data
    old = Scene1.model_validate(data)
    kept = ("floor", "walls", "backdrop", "head", "camera", "optics", "sampling", "film")
    new: dict[str, object] = {name: getattr(old, name) for name in kept}
    sizes = [stone.size_mm for stone in old.stones if stone.size_mm is not None]
    if sizes:
        new["millimetres"] = sizes[0]
    laws = old.simulation
    new["simulation"] = MotionLaws.model_validate(laws.model_dump(exclude={"mass", "spin", "velocity"}))
    new["stones"] = tuple(_stone(stone, laws) for stone in old.stones)
    studio = old.environment if isinstance(old.environment, Studio1) else None
    new["environment"] = StudioEnvironment(ambient=studio.ambient) if studio else old.environment
    points = [PointLight(position=light.position, colour=light.colour) for light in old.lights]
    new["emitters"] = (*(studio.lamps if studio else ()), *points)
    return new


def _is_of_1(data: dict[str, Any]) -> bool:
    if "version" in data:
        return bool(data["version"] == 1)
    parts = ((data.get(name), only) for name, only in ONLY_IN_1.items())
    stones = data.get("stones")
    return (
        "lights" in data
        or any(isinstance(part, dict) and only & part.keys() for part, only in parts)
        or (isinstance(stones, list) and any(isinstance(stone, dict) and "size_mm" in stone for stone in stones))
    )


def _stone(old: Stone1, laws: Simulation1) -> StoneSettings:
    red, green, blue = old.absorption
    per_r = 1 if old.size_mm is None else old.size_mm
    return StoneSettings(
        id="stone",
        cut=old.cut,
        mesh=old.mesh,
        material=old.material,
        absorption=(red * per_r, green * per_r, blue * per_r),
        position=old.position,
        orientation=old.orientation,
        velocity=laws.velocity,
        spin=laws.spin,
        mass=laws.mass,
    )

"""The scene: JSON in, JSON out, every field with a default, so that `{}` is the default scene.

y is up. The unit of length is the stone's circumradius R, the unit of time the second; colours and radiance are linear.
The floor is the plane y = -1. Anything unknown, out of range or not finite is refused with the field's name.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import (
    BaseModel,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    field_validator,
    model_validator,
)

from culet.errors import SceneError
from culet.scene.fields import Colour, Coordinate, Model, Vector
from culet.scene.studio import Backdrop, GradientBackdrop, Head, StudioEnvironment, StudioFloor
from culet.scene.wording import at_its_tag, expected, unknown_field

Index = Annotated[float, Field(ge=1, le=10)]
Pose = tuple[Vector, tuple[float, float, float, float]]
"""Where a stone's centre of mass is (R), and how the stone is turned: a unit quaternion w, x, y, z from its own axes to
those of the world."""


class BrilliantCut(Model):
    """A round brilliant by its proportions, in the trade's own measures.

    Percentages: the table of the girdle's diameter (corner to corner), star and lower half of the way that they could
    reach, the girdle's thickness (at the mains) of the diameter. Which combinations exist is the cut's own affair.
    """

    name: Literal["brilliant"] = "brilliant"
    table_percent: Annotated[float, Field(gt=0, lt=100)] = 53
    crown_degrees: Annotated[float, Field(gt=0, lt=90)] = 34.5
    pavilion_degrees: Annotated[float, Field(gt=0, lt=90)] = 40.75
    star_percent: Annotated[float, Field(gt=0, lt=100)] = 55
    lower_half_percent: Annotated[float, Field(gt=0, lt=100)] = 80
    girdle_percent: Annotated[float, Field(gt=0, le=50)] = 3


class IndexMaterial(Model):
    """Three indices of refraction, for the red, green and blue channel."""

    ior: tuple[Index, Index, Index]


class SellmeierMaterial(Model):
    """n^2 = 1 + sum B l^2 / (l^2 - C^2), wavelength l and C in micrometres (Sellmeier 1871)."""

    sellmeier: Annotated[tuple[tuple[float, float], ...], Field(min_length=1, max_length=8)]


def _form_of_cut(value: object) -> str | None:
    if isinstance(value, str):
        return "<name>"
    return "<proportions>" if isinstance(value, dict | BrilliantCut) else None


Cut = Annotated[
    Annotated[Literal["brilliant"], Tag("<name>")] | Annotated[BrilliantCut, Tag("<proportions>")],
    Discriminator(
        _form_of_cut, custom_error_type="cut", custom_error_message="Input should be 'brilliant' or its proportions"
    ),
]
"""Of the two forms only the one that was meant is judged. The tags are told from fields by their brackets."""


def _form_of_material(value: object) -> str | None:
    if isinstance(value, str):
        return "<name>"
    if isinstance(value, SellmeierMaterial) or (isinstance(value, dict) and "sellmeier" in value):
        return "<sellmeier>"
    return "<ior>" if isinstance(value, IndexMaterial) or (isinstance(value, dict) and "ior" in value) else None


MaterialName = Literal[
    "diamond", "diamond-turri", "moissanite", "cubic-zirconia", "sapphire", "ruby", "emerald", "spinel", "yag",
    "quartz", "strontium-titanate", "rutile", "bk7", "classic",
]  # fmt: skip
"""Those of optics/materials.py, which has their sources."""

Material = Annotated[
    Annotated[MaterialName, Tag("<name>")]
    | Annotated[IndexMaterial, Tag("<ior>")]
    | Annotated[SellmeierMaterial, Tag("<sellmeier>")],
    Discriminator(
        _form_of_material,
        custom_error_type="material",
        custom_error_message="Input should be a material's name, an object with `ior` or one with `sellmeier`",
    ),
]


class StoneSettings(Model):
    """One stone: its shape, what it is made of, and where it is when nothing has moved yet."""

    cut: Cut = "brilliant"
    mesh: Annotated[str, Field(max_length=64, pattern=r"^[A-Za-z0-9_-]+$")] | None = Field(
        None, description="Id of an uploaded mesh; takes the place of the cut."
    )
    material: Material = "diamond"
    absorption: tuple[
        Annotated[float, Field(ge=0, le=1e9)],
        Annotated[float, Field(ge=0, le=1e9)],
        Annotated[float, Field(ge=0, le=1e9)],
    ] = Field((0, 0, 0), description="Absorption coefficient of each channel, per R (Beer-Lambert).")
    size_mm: Annotated[float, Field(gt=0, le=1e9)] | None = Field(
        None,
        description="R in millimetres, from the centre of mass to the farthest corner; then `absorption` is per "
        "millimetre.",
    )
    position: Vector = Field((0, -0.373345, 0), description="By default the default cut lies on the floor.")
    orientation: tuple[Coordinate, Coordinate, Coordinate, Coordinate] = Field(
        (0.93670, 0.33047, 0, 0.11566),
        description="Unit quaternion w, x, y, z; normalised when read. The default tilts the table 41 degrees towards "
        "the camera, as a brilliant lies on its pavilion.",
        validate_default=True,
    )

    @field_validator("orientation")
    @classmethod
    def _normalise(cls, q: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        length = math.sqrt(sum(c * c for c in q))
        if not length > 1e-6:
            raise ValueError("a quaternion of length 0 is no orientation")
        if abs(length - 1) < 1e-12:  # normalising again would change the last bit, and the scene with it
            return q
        w, x, y, z = (c / length for c in q)
        return w, x, y, z


class Plane(Model):
    """The floor, or the three walls at distance 8: absent, matte (checkered, lit, shadowed) or a mirror."""

    kind: Literal["none", "matte", "mirror"] = "none"


def _form_of_floor(value: object) -> str | None:
    kind = value.get("kind", "none") if isinstance(value, dict) else getattr(value, "kind", None)
    if kind == "studio":
        return "<studio>"
    return "<matte>" if kind in ("none", "matte", "mirror") else None


Floor = Annotated[
    Annotated[Plane, Tag("<matte>")] | Annotated[StudioFloor, Tag("<studio>")],
    Discriminator(
        _form_of_floor,
        custom_error_type="floor",
        custom_error_context={"discriminator": "'kind'"},
        custom_error_message="Input should be a floor of kind 'none', 'matte', 'mirror' or 'studio'",
    ),
]


class Light(Model):
    """A point light without falloff; it lights the floor and the walls, and the stone shades it."""

    position: Vector
    colour: Colour


class DarkEnvironment(Model):
    """A vertical blend of two dark blues: the report's."""

    kind: Literal["dark"]


class LightEnvironment(Model):
    """A uniform pale blue: the report's."""

    kind: Literal["light"]


class ConstantEnvironment(Model):
    """The same radiance from everywhere: the white furnace of the tests."""

    kind: Literal["constant"]
    radiance: Colour = (1, 1, 1)


class HalfEnvironment(Model):
    """Radiance from above the horizon, nothing from below."""

    kind: Literal["half"]
    radiance: Colour = (1, 1, 1)


class GradientEnvironment(Model):
    """A vertical blend, linear in the direction's y, from `bottom` to `top`."""

    kind: Literal["gradient"]
    bottom: Colour = (0, 0, 0)
    top: Colour = (1, 1, 1)


class ImageEnvironment(Model):
    """A panorama of all directions: an uploaded picture, or one of the studio's own."""

    kind: Literal["image"]
    image: Annotated[str, Field(max_length=64, pattern=r"^[A-Za-z0-9_-]+$")] = Field(
        "light-box",
        description="light-box, ring-lights, aset or ideal-scope, or the id of an uploaded .exr, .hdr or .png.",
    )
    scale: Annotated[float, Field(ge=0, le=1e6)] = Field(1, description="Factor on its radiance.")
    turn_degrees: Annotated[float, Field(ge=-360, le=360)] = Field(0, description="About the vertical.")


Environment = Annotated[
    ImageEnvironment
    | StudioEnvironment
    | DarkEnvironment
    | LightEnvironment
    | ConstantEnvironment
    | HalfEnvironment
    | GradientEnvironment,
    Field(discriminator="kind"),
]


class Camera(Model):
    """A pinhole, or parallel rays as in the instruments of the trade."""

    kind: Literal["pinhole", "orthographic"] = Field(
        "pinhole",
        description="orthographic: parallel rays, from a plane through the position; one within 2 R of the stone's "
        "centre is moved back.",
    )
    position: Vector = (0, 8.146, 11.032)
    target: Vector = (0, -0.473, 0)
    up: Vector = (0, 1, 0)
    fov_degrees: Annotated[float, Field(ge=1e-3, le=170)] = Field(13.5, description="Vertical field of view (pinhole).")
    height: Annotated[float, Field(ge=1e-6, le=1e9)] = Field(
        3, description="R, of what the picture shows (orthographic)."
    )

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        forward = [t - p for t, p in zip(self.target, self.position, strict=True)]
        length, up = math.hypot(*forward), math.hypot(*self.up)
        if length == 0:
            raise ValueError("position and target are the same point: the camera looks nowhere")
        if up == 0:
            raise ValueError("up has length 0")
        f, u = [c / length for c in forward], [c / up for c in self.up]
        sine = math.hypot(f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0])
        if sine < 1e-6:
            raise ValueError("up is parallel to the line of sight")
        return self


class Optics(Model):
    """How light is followed."""

    fresnel: Literal["exact", "schlick"] = "exact"
    bands: Annotated[int, Field(ge=3, le=64)] = Field(
        3, description="3: an index for each channel. More: that many sampled wavelengths for each pixel and sample."
    )
    polarised: bool = Field(
        False, description="Carry polarisation along each path, with the phases of total reflection; else average it."
    )
    cutoff: Annotated[float, Field(ge=1e-9, lt=1)] = Field(
        0.01, description="A chain whose weight falls below this ends; what it carried is counted as cut."
    )
    max_bounces: Annotated[int, Field(ge=1, le=65536)] = Field(
        256, description="Interior segments of a chain, at most."
    )
    end: Literal["cut", "roulette", "sky"] = Field(
        "cut",
        description="Of a chain below the cut-off: dropped, continued by chance without bias, or replaced by the sky.",
    )
    glare: bool = Field(
        True,
        description="Whether the stone's surface shows what it reflects outside. Without it the picture is not "
        "physical: it shows what comes out of the stone, as a polarising filter does in part.",
    )
    estimator: Literal["chain", "classic"] = "chain"


class Sampling(Model):
    """How each pixel is sampled; the first sample is the pixel's centre."""

    filter: Literal["box", "tent"] = Field(
        "box", description="Reconstruction: box averages the pixel, tent reaches to its neighbours' centres."
    )

    samples_per_pixel: Annotated[int, Field(ge=1, le=65536)] = 1


class Film(Model):
    """From linear radiance to what a screen shows: radiance x exposure, then the tone map."""

    exposure: Annotated[float, Field(gt=0, le=1e6)] = 1
    tone_map: Literal["srgb", "neutral", "filmic", "classic", "none"] = Field(
        "neutral",
        description="srgb: IEC 61966-2-1; neutral: as it is up to 0.8, above that a shoulder towards white, then srgb; "
        "filmic: a curve on the luminance that keeps hues, then srgb; "
        "classic: (1.2 L)^1.2 as in the report; none: linear. What is above 1 is clipped.",
    )
    gamut: Literal["desaturate", "clip"] = Field(
        "desaturate", description="What becomes of spectral colours that no screen has: towards grey, or clipped."
    )


class Simulation(Model):
    """How the stone moves."""

    model: Literal["rigid", "classic"] = Field(
        "rigid",
        description="rigid: the stone's own corners against floor and walls; classic: the report's sphere against "
        "the floor.",
    )
    inertia: Literal["polyhedron", "cone", "cone_apex"] = Field(
        "polyhedron",
        description="polyhedron: integral over the mesh; cone: R=1, h=2 about its centre of mass; "
        "cone_apex: the same about its apex, as the report's formula (1).",
    )
    gravity: Annotated[float, Field(ge=0, le=1e6)] = Field(9.81, description="Downward, R/s^2.")
    mass: Annotated[float, Field(ge=1e-9, le=1e9)] = 2
    spin: Vector = Field((0.5, 3, 0), description="Initial angular velocity, rad/s.")
    velocity: Vector = Field((0, 0, 0), description="Initial velocity, R/s.")
    restitution: Annotated[float, Field(ge=0, le=1)] = 0.6
    friction: Annotated[float, Field(ge=0, le=1e3)] = Field(0.3, description="Coulomb's coefficient (rigid).")
    rolling_resistance: Annotated[float, Field(ge=0, le=1)] = Field(
        0.02, description="Lever arm of the floor's resistance to rolling, R (rigid)."
    )
    integrator: Literal["rkmk4", "rk4", "midpoint", "splitting", "symmetric_top", "euler"] = Field(
        "rkmk4",
        description="How a free rotation is followed (rigid): Munthe-Kaas or classical Runge-Kutta, both of fourth "
        "order; Lie midpoint or two splittings, of second (symmetric_top is exact for a body of revolution); the "
        "report's Euler, of first.",
    )
    bounce_speed: Annotated[float, Field(ge=1e-6, le=1)] = Field(
        0.02, description="A slower impact does not bounce, in sqrt(g R) (rigid)."
    )
    contact_step: Annotated[float, Field(ge=1e-5, le=0.1)] = Field(
        0.02, description="Longest step in contact, in sqrt(R / g) (rigid)."
    )
    sleeping: bool = Field(True, description="Whether a stone at rest is left out of the simulation (rigid).")
    velocity_threshold: Annotated[float, Field(ge=0, le=1e6)] = Field(
        0.1, description="A slower impact stops, R/s (classic)."
    )
    tangential_damping: Annotated[float, Field(ge=0, le=1)] = Field(
        0.9, description="Factor on the horizontal velocity at a contact (classic)."
    )
    angular_damping: Annotated[float, Field(ge=0, le=1)] = Field(
        0.75, description="Factor on the angular momentum at a soft contact (classic)."
    )
    random_torque: Annotated[float, Field(ge=0, le=1e6)] = Field(
        5, description="Largest random change of angular momentum about x and z at a hard impact (classic)."
    )
    random_torque_speed: Annotated[float, Field(ge=0, le=1e6)] = Field(
        2, description="An impact is hard above this rebound speed, R/s (classic)."
    )
    time_step: Annotated[float, Field(ge=1e-4, le=0.25)] = Field(
        1 / 120, description="Seconds. A picture is drawn between two steps, so a longer one cuts bounces off."
    )
    seed: Annotated[int, Field(ge=0, le=2**53 - 1)] = 0


class Scene(Model):
    """Everything that a picture depends on. `Scene()` is the default scene."""

    version: Literal[1] = 1
    stones: Annotated[tuple[StoneSettings, ...], Field(max_length=1)] = (StoneSettings(),)
    floor: Floor = StudioFloor(kind="studio")
    walls: Plane = Plane(kind="none")
    lights: Annotated[tuple[Light, ...], Field(max_length=8)] = ()
    environment: Environment = StudioEnvironment()
    backdrop: Backdrop = Field(
        GradientBackdrop(kind="gradient"), description="What the camera sees in place of the sky."
    )
    head: Head | None = Field(Head(), description="The observer's, as stones see it; none without one.")
    camera: Camera = Camera()
    optics: Optics = Optics()
    sampling: Sampling = Sampling()
    film: Film = Film()
    simulation: Simulation = Simulation()

    @classmethod
    def read(cls, data: Any) -> Scene:  # noqa: ANN401 - whatever JSON held
        """Validate parsed JSON; raise SceneError naming the first field that cannot be used."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise scene_error(error) from error

    def moved(self, *poses: Pose) -> Scene:
        """The same scene with its stones elsewhere: a pose for each of them."""
        stones = [
            stone.model_copy(update={"position": position, "orientation": orientation})
            for stone, (position, orientation) in zip(self.stones, poses, strict=True)
        ]
        return self.model_copy(update={"stones": tuple(stones)})


_KINDS = {
    name: frozenset(get_args(kind.model_fields["kind"].annotation)[0] for kind in get_args(get_args(union)[0]))
    for name, union in (("environment", Environment), ("backdrop", Backdrop))
}


def field_of(location: tuple[int | str, ...]) -> str:
    """The place in the JSON: without the names that pydantic gives to the alternatives of a union."""
    parts = [str(part) for part in location]
    return ".".join(
        part
        for before, part in zip(["", *parts], parts, strict=False)
        if not (part.startswith("<") or part in _KINDS.get(before, ()))
    )


def scene_error(error: ValidationError) -> SceneError:
    """The first finding of pydantic as one line: the field, what was expected, what came."""
    first = at_its_tag(error.errors(include_url=False)[0])
    field = field_of(first["loc"])
    more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
    if first["type"] == "extra_forbidden":
        root = Scene if error.title == Scene.__name__ else BaseModel  # a message's fields are not the scene's
        return SceneError(f"{field}: {unknown_field(first['loc'], root)}{more}", field)
    came = repr(first["input"])
    shown = came if len(came) <= 80 else came[:77] + "..."
    return SceneError(f"{field or 'scene'}: {expected(first)}; got {shown}{more}", field or None)

"""A stone: its shape and size, what it is made of, where it is, and how it moves when time begins.

Lengths are in R, the radius of a stone of scale 1, from its centre of mass to its farthest corner.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, field_validator, model_validator
from pydantic.config import JsonDict

from culet.scene.cuts import Cut
from culet.scene.fields import Model, Orientation, Vector
from culet.scene.recut import Recut

MOST_STONES = 64
CARATS_PER_GRAM = 5
"""The metric carat is 0.2 g."""

Index = Annotated[float, Field(ge=1, le=10)]


class IndexMaterial(Model):
    """Three indices of refraction, for the red, green and blue channel."""

    ior: tuple[Index, Index, Index]


class SellmeierMaterial(Model):
    """n^2 = 1 + sum B l^2 / (l^2 - C^2), wavelength l and C in micrometres (Sellmeier 1871)."""

    sellmeier: Annotated[tuple[tuple[float, float], ...], Field(min_length=1, max_length=8)]


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

NICKNAMES = {"glass": "bk7", "cz": "cubic-zirconia"}
"""What people call them, in any case of letters."""


def material_named(value: object) -> object:
    """A material's own name, of what it is called; anything else as it is."""
    if not isinstance(value, str):
        return value
    name = value.lower()
    return NICKNAMES.get(name, name)


NamedMaterial = Annotated[MaterialName, BeforeValidator(material_named)]

StoneMaterial = Annotated[
    Annotated[NamedMaterial, Tag("<name>")]
    | Annotated[IndexMaterial, Tag("<ior>")]
    | Annotated[SellmeierMaterial, Tag("<sellmeier>")],
    Discriminator(
        _form_of_material,
        custom_error_type="material",
        custom_error_message="Input should be a material's name, an object with `ior` or one with `sellmeier`",
    ),
]


StoneId = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,31}$")]
UNNAMED = "stone"
"""What stones without an id are called: `stone`, `stone-2` and so on."""

UploadId = Annotated[str, Field(max_length=64, pattern=r"^[A-Za-z0-9_-]+$")]
Coefficient = Annotated[float, Field(ge=0, le=1e18)]


def _no_default(schema: JsonDict) -> None:
    del schema["default"]


class StoneSettings(Model):
    """One stone: its shape, what it is made of, and where it is when nothing has moved yet."""

    id: StoneId = Field(
        "",
        description="Its name for patches and events, unique in its scene; `stone`, `stone-2` and so on if it has "
        "none.",
        json_schema_extra=_no_default,
    )
    cut: Cut = "brilliant"
    mesh: UploadId | None = Field(
        None,
        description="Id of an uploaded mesh or design, or `standard-round-brilliant`, a cutter's design that comes "
        "with culet; takes the place of the cut.",
    )
    recut: Recut | None = Field(
        None, description="How the mesh or the design, or else the cut, is cut anew; of convex stones."
    )
    scale: Annotated[float, Field(ge=0.01, le=100)] = Field(
        1, description="Its radius, from the centre of mass to the farthest corner, in R."
    )
    material: StoneMaterial = "diamond"
    absorption: tuple[Coefficient, Coefficient, Coefficient] = Field(
        (0, 0, 0),
        description="Absorption coefficient of each channel, per R (Beer-Lambert), besides the material's own.",
    )
    position: Vector = Field(
        (0, -0.373345, 0), description="Of the centre of mass, R. By default the default cut lies on the floor."
    )
    orientation: Orientation = Field(
        (0.93670, 0.33047, 0, 0.11566),
        description="Unit quaternion w, x, y, z; normalised when read. The default tilts the table 41 degrees towards "
        "the camera, as a brilliant lies on its pavilion.",
        validate_default=True,
    )
    velocity: Vector = Field((0, 0, 0), description="Of its centre when time begins, R/s.")
    spin: Vector = Field((0, 0, 0), description="Angular velocity when time begins, about the world's axes, rad/s.")
    density: Annotated[float, Field(ge=1, le=1e6)] | None = Field(
        None,
        description="kg/m^3. Without one, and without a mass, the material's; diamond's for one without a name.",
    )
    mass: Annotated[float, Field(ge=1e-9, le=1e9)] | None = Field(
        None, description="Carats (0.2 g), in place of a density."
    )
    restitution: Annotated[float, Field(ge=0, le=1)] | None = Field(None, description="None: the simulation's.")
    friction: Annotated[float, Field(ge=0, le=1e3)] | None = Field(None, description="None: the simulation's.")

    @field_validator("recut")
    @classmethod
    def _none_that_changes_nothing(cls, recut: Recut | None) -> Recut | None:
        """So that a stone that is cut as it came is equal to itself before it was cut anew."""
        return recut if recut is not None and recut.changes else None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.density is not None and self.mass is not None:
            raise ValueError("expected a density or a mass, got both; null takes one away")
        return self


def new_id(taken: Iterable[str], like: str = UNNAMED) -> str:
    """An id that nobody has: `ruby`, `ruby-2`, `ruby-3` and so on."""
    return next(name for name in _names(like) if name not in set(taken))


def _names(like: str) -> Iterator[str]:
    yield like
    number = 2
    while True:
        yield f"{like[: 31 - len(str(number))]}-{number}"
        number += 1


def with_ids(stones: tuple[StoneSettings, ...]) -> tuple[StoneSettings, ...]:
    """The stones, of which those without an id are given one in their order."""
    taken = {stone.id for stone in stones}
    named = []
    for stone in stones:
        if not stone.id:
            stone = stone.model_copy(update={"id": new_id(taken)})  # noqa: PLW2901
            taken.add(stone.id)
        named.append(stone)
    return tuple(named)

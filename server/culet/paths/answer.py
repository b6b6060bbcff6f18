"""What is told of one ray. Lengths are in R, the radius of a stone of scale 1, places in the world; light is linear
radiance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

WAVELENGTHS = (380.0, 780.0)
"""nm that may be asked for: what is visible."""
MOST_WAVELENGTHS = 16

Vector = tuple[float, float, float]
Kind = Literal["enters", "meets", "lands", "sees", "ends", "chance"]
Met = Literal["lamp", "sky", "head", "backdrop", "floor", "left-wall", "middle-wall", "right-wall", "cut", "untold"]
Channel = Literal["red", "green", "blue"]
Side = Literal["above", "below", "left", "right", "ahead", "behind"]


@dataclass(frozen=True)
class Chain:
    """Light of one colour, which is followed by itself."""

    wavelength: float | None
    """nm; None for a channel of a scene with three indices."""
    channel: Channel | None
    """None for a wavelength."""
    colour: Vector
    """Linear sRGB from 0 to 1 in which a picture may draw it."""
    indices: dict[str, float]
    """Of refraction, by the stones' ids."""


@dataclass(frozen=True)
class Pose:
    """Of a stone, in the world."""

    position: Vector
    orientation: tuple[float, float, float, float]
    """A unit quaternion w, x, y, z."""
    scale: float


@dataclass(frozen=True)
class Reflectance:
    """Of a stone's surface at that angle."""

    s: float
    """Of light whose field is perpendicular to the plane of incidence,"""
    p: float
    """in it,"""
    unpolarised: float
    """and their mean."""


@dataclass(frozen=True)
class Pass:
    """One chain at one step."""

    chain: int | None
    """Its number in `chains`; None before a stone parts them."""
    start: Vector
    """Where the ray came from."""
    point: Vector
    """Where it meets what the step says; of the sky a point 3 R on."""
    direction: Vector
    """Of the ray that comes, of unit length; from the eye to the light, against the way that light goes."""
    weight_before: float
    """Part of the pixel that the ray carries where it came from,"""
    weight: float
    """and here: less by absorption on the way."""
    cut: float
    """Weight that is dropped, mean of the channels."""
    kept: float
    """Part of that weight which is reflected: at a stone or a mirror; of `chance` the factor on the weight."""
    light: Vector
    """What the pixel shows of it, red, green and blue."""
    length: float | None = None
    """R of the way inside the stone."""
    incidence_degrees: float | None = None
    """Between the ray and the facet's normal."""
    refraction_degrees: float | None = None
    """On the other side; None where all is reflected."""
    critical_degrees: float | None = None
    """Of total reflection, for a ray inside."""
    reflectance: Reflectance | None = None
    polarisation: float | None = None
    """Degree of polarisation that the ray has come to know, of a polarised scene: from 0 to 1."""


@dataclass(frozen=True)
class Part:
    """Of the pixel's light: where it comes from."""

    meets: Met
    number: int | None
    """Of a lamp, in the scene's `emitters`."""
    side: Side | None
    """Of the viewer, where the lamp is."""
    light: Vector
    share: float
    """Of the pixel's luminance, from 0 to 1."""


@dataclass(frozen=True)
class Step:
    """One place in the tree of a pixel's light: the chains that go there are together still."""

    number: int
    parent: int | None
    """The step before; None where the eye's ray is the first."""
    kind: Kind
    """`enters` a stone from outside, `meets` a facet from inside, `lands` on floor or wall, `sees` the sky; `ends`,
    since its weight is below the cut-off, or its bounces are used up; goes on by `chance`."""
    passes: tuple[Pass, ...]
    stone: str | None = None
    facet: int | None = None
    """Of the stone's planes, from 0."""
    facet_name: str | None = None
    """As the cut or design calls it."""
    tier: int | None = None
    """Counted from 1."""
    inside: bool = False
    """Whether it ends inside a stone."""
    elevation_degrees: float | None = None
    """Of the direction in which the sky is seen, above the horizon."""
    parts: tuple[Part, ...] = ()
    """What is seen there, and how much of the pixel's light each makes."""


@dataclass(frozen=True)
class Path:
    """All light of one pixel, in one sample, or of one ray."""

    pixel: tuple[int, int, int, int] | None
    """x, y, of width and height; None of a ray that was given."""
    origin: Vector
    """The eye, of parallel rays a point before the stones,"""
    direction: Vector
    """and where it looks there."""
    value: Vector
    """The pixel's linear radiance, before exposure and tone mapping."""
    cut: float
    """Weight that was dropped, mean of the channels: what it would have shown is missing."""
    chains: tuple[Chain, ...]
    steps: tuple[Step, ...]
    """None comes before its parent."""
    parts: tuple[Part, ...]
    """Of the whole pixel, the brightest first."""
    left_out: int
    """Events that were too many to be told; their light is in `parts` as untold."""
    poses: dict[str, Pose]
    """Where the stones were, by their ids."""
    polarised: bool
    """Whether the chains carried polarisation: then `kept` is of light as it is polarised, not `reflectance`'s mean."""

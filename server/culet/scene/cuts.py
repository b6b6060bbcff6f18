"""Cuts by their proportions: of each what can be told, in the trade's own measures, from where to where.

Percentages without another word are of the width, the smaller extent across the table; `length_to_width` stretches the
stone along its length. Angles are from the horizontal, at the middle of the stone's side. Which combinations exist is
the cut's own affair (`culet.geometry.cuts`). `usual` in a field's schema is what is cut: how far a slider reaches.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, Literal, get_args

from pydantic import Discriminator, Field, Tag

from culet.scene.fields import Model

USUAL = "usual"
"""In a field's schema: from where to where people cut."""


def _field(
    description: str,
    least: float,
    most: float,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:  # noqa: ANN401 - as pydantic's own
    """What a proportion is; `least` and `most` are usual, the others what is allowed."""
    return Field(description=description, json_schema_extra={USUAL: [least, most]}, gt=gt, ge=ge, lt=lt, le=le)


def _percent(description: str, least: float, most: float) -> Any:  # noqa: ANN401
    return _field(description, least, most, gt=0, lt=100)


def _degrees(description: str, least: float, most: float) -> Any:  # noqa: ANN401
    return _field(description, least, most, gt=0, lt=90)


TablePercent = Annotated[float, _percent("The top facet's width, from corner to corner", 45, 75)]
NarrowTable = Annotated[float, _percent("The top facet's width, from corner to corner", 40, 62)]
"""Of outlines with sharp ends, where stars have less room."""
Crown = Annotated[float, _degrees("Slope of the main facets above the girdle", 20, 45)]
Pavilion = Annotated[
    float,
    _degrees("Slope of the main facets below the girdle: too flat or too steep, and light leaks through them", 36, 48),
]
Star = Annotated[float, _percent("How far the stars reach from the table, % of the way to the girdle", 30, 70)]
LowerHalf = Annotated[float, _percent("How far the lower halves reach down, % of the way to the culet", 50, 95)]
Girdle = Annotated[float, _field("Thickness at the main facets", 0.5, 10, gt=0, le=50)]
LengthToWidth = Annotated[float, _field("Length over width", 1, 2, ge=1, le=10)]
StepTable = Annotated[float, _percent("The top facet's width", 45, 75)]
StepRows = Annotated[int, _field("Rows of facets", 1, 5, ge=1, le=8)]
CrownStep = Annotated[float, _degrees("Slope of the lowest step of the crown", 30, 60)]
PavilionStep = Annotated[float, _degrees("Slope of the highest step of the pavilion", 45, 70)]
Flattening = Annotated[
    float, _field("By how much each step is flatter than the one nearer to the girdle", 1, 15, ge=0, lt=90)
]
Sides = Annotated[int, _field("Facets of a row", 8, 20, ge=3, le=64)]
FacetRows = Annotated[int, _field("Rows of facets", 2, 6, ge=2, le=12)]


class BrilliantCut(Model):
    """A round brilliant by its proportions, in the trade's own measures.

    Percentages: the table of the girdle's diameter (corner to corner), star and lower half of the way that they could
    reach, the girdle's thickness (at the mains) of the diameter. Which combinations exist is the cut's own affair.
    """

    name: Literal["brilliant"] = "brilliant"
    table_percent: TablePercent = 53
    crown_degrees: Crown = 34.5
    pavilion_degrees: Pavilion = 40.75
    star_percent: Star = 55
    lower_half_percent: LowerHalf = 80
    girdle_percent: Girdle = 3


class OldEuropeanCut(Model):
    """A round brilliant of before 1930: a small table, a high crown, short lower halves and an open culet."""

    name: Literal["old-european"] = "old-european"
    table_percent: Annotated[float, _percent("The top facet's width, from corner to corner", 35, 60)] = 45
    crown_degrees: Crown = 37
    pavilion_degrees: Pavilion = 41.5
    star_percent: Star = 45
    lower_half_percent: LowerHalf = 50
    girdle_percent: Girdle = 2
    culet_percent: Annotated[float, _field("Width of the facet at the bottom; 0: a point", 0, 15, ge=0, lt=100)] = 8


class SingleCut(Model):
    """Eight facets above, eight below: what small stones have."""

    name: Literal["single"] = "single"
    table_percent: TablePercent = 60
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41
    girdle_percent: Girdle = 3


class RoseCut(Model):
    """A Dutch rose: a dome of triangles over a flat base."""

    name: Literal["rose"] = "rose"
    height_percent: Annotated[float, _field("From the girdle to the apex", 20, 60, gt=0, le=500)] = 45
    ring_percent: Annotated[float, _percent("Width of the upper hexagon", 40, 70)] = 55
    ring_height_percent: Annotated[float, _percent("Height of the upper hexagon, % of the apex", 60, 90)] = 78
    girdle_percent: Girdle = 2


class PortugueseCut(Model):
    """Rows of rhombs, steep at the girdle and flatter from row to row."""

    name: Literal["portuguese"] = "portuguese"
    sides: Sides = 16
    table_percent: Annotated[float, _percent("The top facet's width, from side to side", 25, 60)] = 45
    crown_rows: FacetRows = 4
    crown_degrees: Annotated[float, _degrees("Slope of the lowest row of the crown", 35, 60)] = 48
    crown_top_degrees: Annotated[float, _degrees("Slope of the crown's row at the table", 10, 35)] = 20
    pavilion_rows: FacetRows = 5
    pavilion_degrees: Annotated[float, _degrees("Slope of the highest row of the pavilion", 50, 75)] = 66
    culet_degrees: Annotated[float, _degrees("Slope of the pavilion's last row", 35, 48)] = 40
    girdle_percent: Girdle = 3


class BrioletteCut(Model):
    """A drop of rhombs all around, without a table."""

    name: Literal["briolette"] = "briolette"
    sides: Sides = 12
    upper_rows: FacetRows = 4
    upper_degrees: Annotated[float, _degrees("Slope of the lowest row of the upper part", 70, 85)] = 80
    tip_degrees: Annotated[float, _degrees("Slope of the row at the upper point", 50, 75)] = 68.5
    lower_rows: FacetRows = 5
    lower_degrees: Annotated[float, _degrees("Slope of the highest row of the lower part", 60, 80)] = 70
    base_degrees: Annotated[float, _degrees("Slope of the row at the lower point", 10, 40)] = 16


class OvalCut(Model):
    """A brilliant on an ellipse."""

    name: Literal["oval"] = "oval"
    length_to_width: LengthToWidth = 1.4
    table_percent: TablePercent = 56
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41
    star_percent: Star = 55
    lower_half_percent: LowerHalf = 75
    girdle_percent: Girdle = 3


class CushionCut(Model):
    """A brilliant on a pillow, |x/a|^p + |y|^p = 1."""

    name: Literal["cushion"] = "cushion"
    length_to_width: LengthToWidth = 1.1
    squareness: Annotated[float, _field("Its power p: 2 is an oval, more is squarer", 2.1, 4, ge=2, le=16)] = 2.6
    table_percent: TablePercent = 58
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41.5
    star_percent: Star = 50
    lower_half_percent: LowerHalf = 75
    girdle_percent: Girdle = 3


class PearCut(Model):
    """A brilliant on a drop: half a circle, and two arcs that meet in a tip."""

    name: Literal["pear"] = "pear"
    length_to_width: Annotated[float, _field("Length over width", 1.25, 2, gt=1, le=10)] = 1.5
    table_percent: NarrowTable = 56
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41
    star_percent: Star = 50
    lower_half_percent: LowerHalf = 75
    girdle_percent: Girdle = 3


class MarquiseCut(Model):
    """A brilliant on two arcs that meet in two tips; its mains end in a keel, or else those at the tips were flat."""

    name: Literal["marquise"] = "marquise"
    length_to_width: Annotated[float, _field("Length over width", 1.5, 2.5, gt=1, le=10)] = 2
    keel_percent: Annotated[
        float, _field("Length of the keel below, % of what the stone is longer than wide", 10, 90, ge=0, lt=100)
    ] = 50
    table_percent: TablePercent = 58
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41
    star_percent: Star = 50
    lower_half_percent: LowerHalf = 75
    girdle_percent: Girdle = 3


class TrillionCut(Model):
    """A brilliant on a triangle of three arcs."""

    name: Literal["trillion"] = "trillion"
    bulge_percent: Annotated[float, _field("Height of a side's arc, % of the side", 5, 20, gt=0, le=28)] = 12
    table_percent: NarrowTable = 55
    crown_degrees: Crown = 33
    pavilion_degrees: Pavilion = 40
    star_percent: Star = 50
    lower_half_percent: LowerHalf = 70
    girdle_percent: Girdle = 3


class HeartCut(Model):
    """Two lobes, each a brilliant on a tilted drop, cut where they meet. Its cleft makes it not convex."""

    name: Literal["heart"] = "heart"
    length_to_width: Annotated[float, _field("Length over width", 0.9, 1.1, ge=0.5, le=2)] = 0.96
    lobe_percent: Annotated[float, _field("Width of a lobe's arc", 55, 62, gt=50, lt=100)] = 56
    table_percent: NarrowTable = 56
    crown_degrees: Crown = 35
    pavilion_degrees: Pavilion = 41
    star_percent: Star = 50
    lower_half_percent: LowerHalf = 75
    girdle_percent: Girdle = 3


class PrincessCut(Model):
    """A square with sharp corners: chevrons fan from the corners below, bezels, stars and halves above."""

    name: Literal["princess"] = "princess"
    length_to_width: Annotated[float, _field("Length over width", 1, 1.5, ge=1, le=10)] = 1
    table_percent: Annotated[float, _percent("The top facet's width, from side to side", 55, 80)] = 68
    crown_degrees: Annotated[float, _degrees("Slope of the bezels, at the girdle", 25, 45)] = 36
    star_degrees: Annotated[float, _degrees("Slope of the stars, at the table", 12, 32)] = 22
    star_percent: Annotated[
        float, _percent("How far the stars reach from the table, % of the way to the girdle", 30, 70)
    ] = 50
    pavilion_percent: Annotated[float, _field("Depth below the girdle", 50, 70, gt=0, le=500)] = 60
    pavilion_degrees: Annotated[float, _degrees("Slope at the girdle from which the chevrons flatten", 56, 68)] = 62
    corner_percent: Annotated[float, _percent("Where the corners' mains begin, % of the way out", 20, 35)] = 28
    chevrons: Annotated[int, _field("Chevrons of each side", 2, 5, ge=2, le=16)] = 3
    girdle_percent: Girdle = 3


class EmeraldCut(Model):
    """A step cut with cut corners, longer than wide."""

    name: Literal["emerald"] = "emerald"
    length_to_width: LengthToWidth = 1.4
    corner_percent: Annotated[float, _percent("What is cut off a corner, % of half the width", 15, 45)] = 30
    table_percent: StepTable = 60
    crown_steps: StepRows = 3
    crown_degrees: CrownStep = 50
    crown_step_degrees: Flattening = 10
    pavilion_steps: StepRows = 3
    pavilion_degrees: PavilionStep = 56
    pavilion_step_degrees: Flattening = 7
    girdle_percent: Girdle = 4


class AsscherCut(Model):
    """A square step cut with large corners, which ends in a point."""

    name: Literal["asscher"] = "asscher"
    corner_percent: Annotated[float, _percent("What is cut off a corner, % of half the width", 35, 60)] = 52
    table_percent: StepTable = 56
    crown_steps: StepRows = 3
    crown_degrees: CrownStep = 49
    crown_step_degrees: Flattening = 8
    pavilion_steps: StepRows = 3
    pavilion_degrees: PavilionStep = 55
    pavilion_step_degrees: Flattening = 7
    girdle_percent: Girdle = 4


class BaguetteCut(Model):
    """A slim step cut with sharp corners."""

    name: Literal["baguette"] = "baguette"
    length_to_width: Annotated[float, _field("Length over width", 1.5, 4, ge=1, le=10)] = 2
    table_percent: StepTable = 60
    crown_steps: StepRows = 2
    crown_degrees: CrownStep = 45
    crown_step_degrees: Flattening = 10
    pavilion_steps: StepRows = 3
    pavilion_degrees: PavilionStep = 54
    pavilion_step_degrees: Flattening = 7
    girdle_percent: Girdle = 4


AnyCut = (
    BrilliantCut | OldEuropeanCut | SingleCut | RoseCut | PortugueseCut | BrioletteCut | OvalCut | CushionCut | PearCut
    | MarquiseCut | TrillionCut | HeartCut | PrincessCut | EmeraldCut | AsscherCut | BaguetteCut
)  # fmt: skip
CutName = Literal[
    "brilliant", "old-european", "single", "rose", "portuguese", "briolette", "oval", "cushion", "pear", "marquise",
    "trillion", "heart", "princess", "emerald", "asscher", "baguette",
]  # fmt: skip

TITLES: Mapping[str, str] = MappingProxyType(
    {
        "brilliant": "Round brilliant",
        "old-european": "Old European",
        "single": "Single cut",
        "rose": "Rose",
        "portuguese": "Portuguese",
        "briolette": "Briolette",
        "oval": "Oval",
        "cushion": "Cushion",
        "pear": "Pear",
        "marquise": "Marquise",
        "trillion": "Trillion",
        "heart": "Heart",
        "princess": "Princess",
        "emerald": "Emerald cut",
        "asscher": "Asscher",
        "baguette": "Baguette",
    }
)
"""What people call them."""
CUTS: Mapping[str, type[AnyCut]] = MappingProxyType(dict(zip(get_args(CutName), get_args(AnyCut), strict=True)))
"""By name, in the order in which they are shown."""


def _form_of_cut(value: object) -> str | None:
    """The tag of what was meant: tags are told from fields by their brackets."""
    if isinstance(value, str):
        return "<name>"
    if isinstance(value, dict):
        return f"<{value.get('name', 'brilliant')}>"
    return f"<{value.name}>" if isinstance(value, get_args(AnyCut)) else None


Cut = Annotated[
    Annotated[CutName, Tag("<name>")]
    | Annotated[BrilliantCut, Tag("<brilliant>")]
    | Annotated[OldEuropeanCut, Tag("<old-european>")]
    | Annotated[SingleCut, Tag("<single>")]
    | Annotated[RoseCut, Tag("<rose>")]
    | Annotated[PortugueseCut, Tag("<portuguese>")]
    | Annotated[BrioletteCut, Tag("<briolette>")]
    | Annotated[OvalCut, Tag("<oval>")]
    | Annotated[CushionCut, Tag("<cushion>")]
    | Annotated[PearCut, Tag("<pear>")]
    | Annotated[MarquiseCut, Tag("<marquise>")]
    | Annotated[TrillionCut, Tag("<trillion>")]
    | Annotated[HeartCut, Tag("<heart>")]
    | Annotated[PrincessCut, Tag("<princess>")]
    | Annotated[EmeraldCut, Tag("<emerald>")]
    | Annotated[AsscherCut, Tag("<asscher>")]
    | Annotated[BaguetteCut, Tag("<baguette>")],
    Discriminator(
        _form_of_cut,
        custom_error_type="cut",
        custom_error_message="Input should be a cut's name or its proportions, with a `name` among "
        + ", ".join(get_args(CutName)),
        custom_error_context={"discriminator": "'name'"},
    ),
]
"""By name, with the usual proportions, or by proportions, of which only the form that was meant is judged."""


def proportions(cut: CutName | AnyCut) -> AnyCut:
    """The usual ones of a cut by its name."""
    return CUTS[cut]() if isinstance(cut, str) else cut


def usual_range(cut: AnyCut, name: str) -> tuple[float, float]:
    """From where to where people cut this proportion."""
    extra: Any = type(cut).model_fields[name].json_schema_extra
    least, most = extra[USUAL]
    return float(least), float(most)


def summary(name: str) -> str:
    """One sentence, or two, about a cut."""
    return " ".join((CUTS[name].__doc__ or "").split("\n\n")[0].split())

"""Named scenes: the default and its kin, instruments of the trade, coloured stones, the report's and its figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from culet.errors import NotFoundError
from culet.scene import daylight, piles, showcase
from culet.scene.camera import Camera
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.model import Scene
from culet.scene.optics import SPECTRAL_AT_REST
from culet.scene.report_scenes import CLASSIC, classic, tinted

Group = Literal["diamonds", "instruments", "coloured stones", "other cuts", "several stones", "the report"]


@dataclass(frozen=True)
class Preset:
    """A named scene."""

    name: str
    """As commands and REST take it."""
    title: str
    """What people call it."""
    summary: str
    """One sentence about it."""
    group: Group
    scene: Scene


_FIG_1 = classic(position=(0, 2, 0), camera=Camera(position=(0, 1.6, 8), target=(0, 0.6, 0), fov_degrees=45))

_ALL = (
    Preset(
        "default",
        "Atelier",
        "A diamond at rest under soft boxes, before a dark backdrop.",
        "diamonds",
        Scene(optics=SPECTRAL_AT_REST),
    ),
    Preset("white", "On white", "The same diamond on white, as shops show it.", "diamonds", showcase.WHITE),
    Preset(
        "fire", "Fire", "Small lamps in the dark: the colours that a diamond makes of white.", "diamonds", showcase.FIRE
    ),
    Preset("falling", "Falling", "A diamond tossed into the atelier: let it fall.", "diamonds", showcase.FALLING),
    Preset(
        "mirror", "Mirror floor", "A diamond that floats over a mirror, lit red and blue.", "diamonds", LEGACY_DEFAULT
    ),
    Preset("sun", "Sun", "A diamond lies in the low sun, and throws its fire about.", "diamonds", daylight.SUN),
    Preset("window", "Window", "A diamond lies in the soft light of a tall window.", "diamonds", daylight.WINDOW),
    Preset(
        "matte",
        "Checkered floor",
        "A diamond over a checkered floor, on which two lights throw its flecks.",
        "diamonds",
        daylight.MATTE,
    ),
    Preset(
        "face-up",
        "Face up",
        "Straight down its table: the dark arrows are your own head.",
        "instruments",
        showcase.FACE_UP,
    ),
    Preset(
        "aset",
        "ASET",
        "Red comes from above, green from aside, blue from the head; black leaks.",
        "instruments",
        showcase.ASET,
    ),
    Preset(
        "ideal-scope",
        "Ideal-Scope",
        "Red comes back to you, black is your head, white leaks.",
        "instruments",
        showcase.IDEAL_SCOPE,
    ),
    Preset("ruby", "Ruby", "A ruby in a cut of its own, red by chromium.", "coloured stones", showcase.RUBY),
    Preset(
        "sapphire",
        "Sapphire",
        "A sapphire in a cut of its own, blue by iron and titanium.",
        "coloured stones",
        showcase.SAPPHIRE,
    ),
    Preset(
        "emerald", "Emerald", "An emerald in a cut of its own, green by chromium.", "coloured stones", showcase.EMERALD
    ),
    Preset(
        "princess",
        "Princess",
        "A square diamond whose pavilion fans out in chevrons.",
        "other cuts",
        showcase.PRINCESS,
    ),
    Preset("oval", "Oval", "A sapphire with a brilliant's facets on an ellipse.", "other cuts", showcase.OVAL),
    Preset("emerald-cut", "Emerald cut", "An emerald in steps with cut corners.", "other cuts", showcase.EMERALD_CUT),
    Preset(
        "portuguese",
        "Portuguese",
        "Rock crystal in nine rows of rhombs: 161 facets.",
        "other cuts",
        showcase.PORTUGUESE,
    ),
    Preset(
        "cutters-design",
        "Cutter's design",
        "Rock crystal by a cutter's file: under Cut turn it tier by tier.",
        "other cuts",
        showcase.CUTTERS_DESIGN,
    ),
    Preset("trio", "Trio", "A diamond between a ruby and a sapphire that touch it.", "several stones", piles.TRIO),
    Preset("heap", "Heap", "A dozen stones that have fallen into a corner.", "several stones", piles.HEAP),
    Preset(
        "classic",
        "Its own scene",
        "The report's own scene, to its constants: a small stone in the dark.",
        "the report",
        CLASSIC,
    ),
    Preset("report-fig1", "Fig. 1", "A falling diamond and its reflection, in the dark.", "the report", _FIG_1),
    Preset(
        "light-walls",
        "Fig. 2",
        "Light sky, walls, checker.",
        "the report",
        classic(floor="matte", walls="matte", light=True),
    ),
    Preset("dark-checker", "Fig. 3", "Dark sky, checker, no walls.", "the report", classic(floor="matte")),
    Preset("tinted-blue", "Fig. 11, blue", "Final values: absorbs red and green.", "the report", tinted((2, 1, 0.1))),
    Preset("tinted-red", "Fig. 11, red", "After Fig. 11: absorbs green and blue.", "the report", tinted((0.1, 2, 1))),
    Preset("tinted-green", "Fig. 11, green", "After Fig. 11: absorbs red and blue.", "the report", tinted((2, 0.1, 1))),
    Preset("tinted-yellow", "Fig. 11, yellow", "After Fig. 11: absorbs blue.", "the report", tinted((0.1, 0.3, 2))),
)

PRESETS: Mapping[str, Preset] = MappingProxyType({each.name: each for each in _ALL})
"""By name, in the order in which they are shown."""


def preset(name: str) -> Scene:
    """The scene of that name, or NotFoundError with the names that exist."""
    try:
        return PRESETS[name].scene
    except KeyError:
        raise NotFoundError(f"no preset {name!r}; there are: {', '.join(PRESETS)}") from None

"""Writes GemCad's `.asc`; what is read back has the same facets, tiers, names and notes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import assert_never

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from culet.errors import MeshError
from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.design import Design, Facet, Tier, Wheel, plane_of
from culet.geometry.designs.grouping import tier_of
from culet.geometry.designs.solid import Solid
from culet.geometry.designs.text import encoded, one_line
from culet.geometry.mass import solid_integrals
from culet.geometry.polygons import fan

VERSION = "GemCad 5.0"
LINE = 78
"""Characters, after which a record wraps onto the next line, as GemCad's own do."""

SAME_TIER = 1e-9
"""Facets of a tier whose planes are nearer than this to the tier's angle and distance are written with it."""

READ_BACK = 1e-8
"""By how much a plane may differ when read back, its distance in units of the largest."""


def asc_of(design: Design) -> tuple[Design, bytes, list[str]]:
    """The design as it was written, the file, and what had to be written otherwise than it was, a sentence each.

    MeshError if the facets enclose no solid, about whose centre they would have to be written.
    """
    said = []
    distances = design.planes()[:, 3]
    if not distances.min() > 0:  # its sign is the side in .asc, at least a culet's
        design, shift = _about_centre(design)
        x, y, z = shift.tolist()
        said.append(f"The origin is moved by ({x:g}, {y:g}, {z:g}), since a facet of .asc cannot lie at it.")
    if any(" " in facet.name for _, facet in design.facets()):
        said.append("Blanks in names are written as _.")
    data = _file(design)
    off = planes_apart(design, read_asc(data))
    if not off < READ_BACK:
        raise MeshError(f"the design cannot be written as .asc: read back, its planes are {off:.1e} off")
    return design, data, said


def planes_apart(one: Design, other: Design) -> float:
    """How far a plane of one is from any of the other at most: the largest difference of a component of the normal, or
    of the distance in units of the largest."""
    a, b = one.planes(), other.planes()
    scale = [1, 1, 1, float(abs(a[:, 3]).max()) or 1.0]
    nearest = (KDTree(to / scale).query(of / scale, p=np.inf)[0] for of, to in ((a, b), (b, a)))
    return max(float(apart.max()) for apart in nearest)


def _file(design: Design) -> bytes:
    lines = [VERSION, f"g {design.wheel.teeth} {_decimal(design.wheel.offset, 1)}"]
    lines.append(f"y {design.fold} {'y' if design.mirror else 'n'}")
    if design.refractive_index is not None:
        lines.append(f"I {_decimal(design.refractive_index, 2)}")
    lines += [f"H {heading}".rstrip() for heading in design.headings]
    scale = float(abs(design.planes()[:, 3]).max())
    for tier in design.tiers:
        for part in _of_one_angle(tier, design.wheel, scale):
            lines += _wrapped(_words(part, design.wheel))
    lines += [f"F {footnote}".rstrip() for footnote in design.footnotes]
    return encoded("\r\n".join([*lines, ""]))


def _of_one_angle(tier: Tier, wheel: Wheel, scale: float) -> Iterator[Tier]:
    """The tier, but facets that lie elsewhere than it says in tiers of their own."""
    own: list[Facet] = []
    others: list[Tier] = []
    for facet in tier.facets:
        plane = plane_of(tier.side, tier.angle, wheel.azimuth(facet.index), tier.distance)
        off = abs(np.subtract(plane, facet.plane)) / [1, 1, 1, scale]
        if off.max() <= SAME_TIER and (tier.angle > 0 or not own):
            own.append(facet)
        else:
            others.append(tier_of([facet.plane], [facet.name], wheel, tier.notes))
    if own:
        yield replace(tier, facets=tuple(own))
    yield from others


def _words(tier: Tier, wheel: Wheel) -> list[str]:
    """A record, in words that a line may end behind."""
    match tier.side:
        case "table" | "crown":
            angle, distance = tier.angle, tier.distance
        case "girdle" | "pavilion":
            angle, distance = -tier.angle, tier.distance
        case "culet":
            angle, distance = 0.0, -tier.distance
        case _:
            assert_never(tier.side)
    words = [f"a {_decimal(angle, 8)} {_decimal(distance, 8)}"]
    common = tier.name
    for place, facet in enumerate(tier.facets):
        named = facet.name if place == 0 or facet.name != common else ""
        words.append(_decimal(facet.index, 0).rstrip(".") + (f" n {'_'.join(named.split())}" if named else ""))
    if tier.notes:
        first, *more = one_line(tier.notes).split()
        words += [f"G {first}", *more]
    return words


def _wrapped(words: Sequence[str]) -> list[str]:
    """Lines of a record; those but the first begin with a blank, and with no word that may be a record's letter."""
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + 1 + len(word) > LINE and word[0] not in "HFa":
            lines.append("")
        lines[-1] += f" {word}"
    return lines


def _decimal(value: float, places: int) -> str:
    """With so many decimals, or with as many more as it takes to read the same number."""
    text = f"{value:.{places}f}"
    return text if float(text) == value else np.format_float_positional(value, min_digits=places)


def _about_centre(design: Design) -> tuple[Design, NDArray[np.float64]]:
    """The design with its origin at its centre of mass, and where that was."""
    cut = Solid(design).cut
    triangles, _ = fan([cut.polygons[k] for k in cut.used])
    centre = solid_integrals(cut.vertices, triangles).centre
    centre[abs(centre) < SAME_TIER * abs(cut.planes[:, 3]).max()] = 0  # a symmetrical stone's, but for rounding
    tiers = []
    for tier in design.tiers:
        planes = [(x, y, z, d - float(centre @ (x, y, z))) for x, y, z, d in (facet.plane for facet in tier.facets)]
        if planes:
            moved = tier_of(planes, [facet.name for facet in tier.facets], design.wheel, tier.notes)
            tiers.append(moved)
    return replace(design, tiers=tuple(tiers)), centre

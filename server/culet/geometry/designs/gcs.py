"""Gem Cut Studio's XML, `.gcs`: `tier` elements of `facet` elements with `vertex` elements.

Normals decide, then the tier's depth if the corners lie at it, else the corners. Labels (`index_angle`) do not: files
of other writers have them otherwise. Tiers that are hidden (`visible="false"`) are not cut.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError, MeshError, TooLargeError
from culet.geometry.designs.design import LEVEL, MOST_TEETH, Design, PlaneRow, Tier, Wheel
from culet.geometry.designs.grouping import tier_of
from culet.geometry.designs.limits import LARGEST_DISTANCE, check_facets
from culet.geometry.designs.text import decoded, number, one_line, shown

DEEPEST = 16
"""Elements within elements; programs write 4."""
OFF_DEPTH = 1e-4
"""Of corners, in units of the facet's distance, up to which the tier's depth is taken: files that were edited have
1e-5."""
_NO_GEAR = 96


@dataclass
class _Facet:
    normal: tuple[float, float, float] | None
    corners: list[tuple[float, float, float]] = field(default_factory=list)


@dataclass
class _Tier:
    attributes: dict[str, str]
    facets: list[_Facet] = field(default_factory=list)


class _Target:
    """What the parser tells: keeps tiers and the few elements about them, and refuses what no such file has."""

    def __init__(self) -> None:
        self.tiers: list[_Tier] = []
        self.others: dict[str, dict[str, str]] = {}
        self.unknown: Counter[str] = Counter()
        self._open: list[str] = []
        self._facets = 0

    def doctype(self, name: str, _system: str | None, _public: str | None, _internal: bool) -> None:
        """Refused: without one there are no entities to expand, and no other file to ask for."""
        raise MeshError(f"expected XML without a document type, got one ({shown(name)})")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if not self._open and tag != "GemCutStudio":
            raise MeshError(f"expected the element GemCutStudio, got {shown(tag)}")
        self._open.append(tag)
        if len(self._open) > DEEPEST:
            raise TooLargeError(f"expected elements at most {DEEPEST} deep")
        match self._open[1:]:
            case []:
                pass
            case ["tier"]:
                self.tiers.append(_Tier(attributes))
            case ["tier", "facet"]:
                self._facets += 1
                check_facets(self._facets)
                self.tiers[-1].facets.append(_Facet(_vector(attributes, ("nx", "ny", "nz"))))
            case ["tier", "facet", "vertex"]:
                corner = _vector(attributes, ("x", "y", "z"))
                if corner is None:
                    raise MeshError("expected a vertex with x, y and z, got one without")
                self.tiers[-1].facets[-1].corners.append(corner)
            case ["index" | "render" | "info"]:
                self.others[tag] = attributes
            case _:
                self.unknown[tag] += 1

    def end(self, _tag: str) -> None:
        self._open.pop()


def read_gcs(data: bytes) -> Design:
    """The design; MeshError names the line that makes none, TooLargeError a limit."""
    target = _parsed(data)
    findings: list[str] = []
    if target.unknown:
        names = ", ".join(one_line(name)[:40] for name, _ in target.unknown.most_common(5))
        findings.append(f"Elements not understood and left out: {names}.")
    gear = number(target.others.get("index", {}).get("gear", str(_NO_GEAR)), "the gear of an index", MOST_TEETH)
    if gear == 0 or gear != int(gear):
        raise MeshError(f"index: expected a gear of a whole number of teeth, not 0, got {gear:g}")
    wheel = Wheel(int(gear))
    info, index = target.others.get("info", {}), target.others.get("index", {})
    symmetry = index.get("symmetry", "1")
    return Design(
        "gcs", wheel, tuple(_tiers(target.tiers, wheel, findings)),
        fold=int(symmetry) if re.fullmatch(r"[1-9]\d{0,3}", symmetry, re.ASCII) else 1,
        mirror=index.get("mirror", "") in ("true", "1"),
        refractive_index=_refractive_index(target.others.get("render", {}), findings),
        headings=_texts(info, ("title", "author", "header2")), footnotes=_texts(info, ("footer1", "footer2")),
        findings=tuple(findings),
    )  # fmt: skip


def _parsed(data: bytes) -> _Target:
    # As text, so that neither a wrong declaration of the encoding nor an encoding of its own matters.
    text = re.sub(r"^\s*<\?xml[^>]*\?>", lambda found: "\n" * found[0].count("\n"), decoded(data))
    target = _Target()
    parser = expat.ParserCreate("utf-8")
    parser.StartDoctypeDeclHandler = target.doctype
    parser.StartElementHandler, parser.EndElementHandler = target.start, target.end
    try:
        parser.Parse(text.encode("utf-8", "replace"), True)
    except expat.ExpatError as error:
        said = expat.ErrorString(error.code)
        raise MeshError(f"line {error.lineno}, column {error.offset + 1}: expected XML, got {said}") from None
    except InputError as error:
        raise type(error)(f"line {parser.CurrentLineNumber}: {error}") from error
    return target


def _tiers(given: list[_Tier], wheel: Wheel, findings: list[str]) -> list[Tier]:
    tiers, off = [], 0
    for place, tier in enumerate(given, 1):
        called = one_line(tier.attributes.get("name", ""))[:40]
        said = f"Tier {place} ({called})" if called else f"Tier {place}"
        if tier.attributes.get("visible") == "false":
            findings.append(f"{said} is hidden; not cut.")
            continue
        if tier.attributes.get("guide") == "true" and not any(len(facet.corners) > 2 for facet in tier.facets):
            findings.append(f"{said} is a guide without corners; not cut.")
            continue
        if tier.attributes.get("frosting", "0") not in ("0", "0.0", ""):
            findings.append(f"{said} is frosted; polished here.")
        depth = tier.attributes.get("depth")
        distance = None if depth is None else number(depth, f"{said}: a depth", LARGEST_DISTANCE)
        planes = []
        for facet in tier.facets:
            plane, beside = _plane(facet, distance, said)
            planes.append(plane)
            off += beside
        if planes:
            names = [called.replace(" ", "_")] * len(planes)
            tiers.append(tier_of(planes, names, wheel, one_line(tier.attributes.get("instructions", ""))))
    if off:
        findings.append(f"{off} facets do not lie at their tier's depth; their corners are taken.")
    return tiers


def _plane(facet: _Facet, depth: float | None, said: str) -> tuple[PlaneRow, bool]:
    """The facet's plane, and whether it lies elsewhere than at the depth."""
    corners = np.array(facet.corners, np.float64).reshape(-1, 3)
    normal = np.array(facet.normal or _normal_of(corners, said))
    normal /= np.linalg.norm(normal)
    if math.hypot(normal[0], normal[1]) < LEVEL:
        normal = np.array([0.0, 0.0, math.copysign(1, normal[2])])
    elif abs(normal[2]) < LEVEL:
        normal[2] = 0
    if not len(corners):
        if depth is None:
            raise MeshError(f"{said}: expected a depth or a facet's corners, got neither")
        distance, beside = depth, False
    else:
        at = float(np.median(corners @ normal))
        if facet.normal is None and at < 0:  # the origin is inside
            normal, at = -normal, -at
        beside = depth is not None and abs(at - depth) > OFF_DEPTH * max(abs(at), abs(depth))
        distance = at if depth is None or beside else depth
    x, y, z = normal.tolist()
    return (x, y, z, distance), beside


def _normal_of(corners: NDArray[np.float64], said: str) -> tuple[float, float, float]:
    """Of a polygon, by Newell's sum; either way."""
    if len(corners) < 3:
        raise MeshError(f"{said}: expected a facet with a normal or three corners, got neither")
    x, y, z = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0).tolist()
    if not math.hypot(x, y, z) > 0:
        raise MeshError(f"{said}: expected a facet with an area, got corners in a line")
    return x, y, z


def _vector(attributes: dict[str, str], names: tuple[str, str, str]) -> tuple[float, float, float] | None:
    """The three attributes as numbers; None if all are missing. A normal of length 0 is none."""
    if not any(name in attributes for name in names):
        return None
    x, y, z = (number(attributes.get(name, ""), name, LARGEST_DISTANCE) for name in names)
    if names[0] == "nx" and not math.hypot(x, y, z) > 1e-9:
        raise MeshError(f"expected a facet's normal, got ({x:g}, {y:g}, {z:g})")
    return x, y, z


def _refractive_index(render: dict[str, str], findings: list[str]) -> float | None:
    text = render.get("refractive_index")
    if text is None:
        return None
    try:
        index = number(text, "a refractive index", 10)
    except MeshError:
        index = 0.0
    if index > 1:
        return index
    findings.append(f"Expected a refractive index above 1, at most 10, got {shown(text)}; left out.")
    return None


def _texts(info: dict[str, str], keys: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(one_line(info[key]) for key in keys if info.get(key))

"""GemCad's binary, `.gem`, little-endian.

A facet is its plane as the vector n / d (3 doubles), its tier (int32), a text `name<tab>instructions`, and its
corners: an int32 of 1 and 3 doubles each, an int32 of 0 behind the last. The double -99999 ends the facets. Then come
int32 fold, mirror and teeth, the refractive index (double), an int32 of 32767, the wheel's offset (double), and four
headings and four footnotes. A text is its length in one byte, and as many bytes in Windows' code page 1252. The word
`preform` and a second such section may follow. Corners are a note of what the program computed: planes decide.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field

from culet.errors import MeshError
from culet.geometry.designs.design import LEVEL, MOST_TEETH, Design, PlaneRow, Wheel
from culet.geometry.designs.grouping import tier_of
from culet.geometry.designs.limits import LARGEST_DISTANCE, check_facets
from culet.geometry.designs.text import one_line

END = -99999.0
"""In place of a facet's first number."""
OFFSET_FOLLOWS = 32767
PREFORM = "preform"

OFF_PLANE = 1e-4
"""Of a corner, in units of its facet's distance; more is told. Programs leave up to 2e-8, edited files 1e-5."""


class _Bytes:
    """What is left of a file."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self.at = 0

    @property
    def left(self) -> int:
        return len(self._data) - self.at

    def double(self, what: str) -> float:
        value: float = struct.unpack("<d", self._take(8, what))[0]
        return value

    def integer(self, what: str) -> int:
        return int.from_bytes(self._take(4, what), "little", signed=True)

    def vector(self, what: str) -> tuple[float, float, float]:
        return self.double(what), self.double(what), self.double(what)

    def text(self, what: str) -> str:
        return self._take(self._take(1, what)[0], what).decode("cp1252", "replace")

    def _take(self, size: int, what: str) -> bytes:
        if size > self.left:
            raise MeshError(f"byte {self.at}: expected {what}, got the end of the file")
        taken = self._data[self.at : self.at + size]
        self.at += size
        return taken


@dataclass
class _Given:
    """A tier as the file has it."""

    planes: list[PlaneRow] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    notes: str = ""


def read_gem(data: bytes) -> Design:
    """The design; MeshError names the byte that makes none, TooLargeError a limit."""
    source = _Bytes(data)
    findings: list[str] = []
    design = _section(source, findings)
    if source.left:
        if source.text("what follows the footnotes") == PREFORM:
            preform = _section(source, [])
            count = sum(len(tier.facets) for tier in preform.tiers)
            findings.append(f"The preform ({count} facets) is left out: the stone is cut from it.")
        if source.left:
            findings.append(f"{source.left} bytes behind the footnotes left out.")
    return Design(
        "gem", design.wheel, design.tiers, design.fold, design.mirror, design.refractive_index, design.headings,
        design.footnotes, tuple(findings),
    )  # fmt: skip


def _section(source: _Bytes, findings: list[str]) -> Design:
    tiers: dict[int, _Given] = {}
    count, farthest = 0, 0.0
    while True:
        at = source.at
        first = source.double(f"a facet or {END:g} behind the last")
        if first == END:
            break
        count += 1
        check_facets(count)
        plane = _plane((first, source.double("a facet"), source.double("a facet")), at)
        tier = tiers.setdefault(source.integer("a facet's tier"), _Given())
        name, _, notes = source.text("a facet's name").partition("\t")
        tier.planes.append(plane)
        tier.names.append(one_line(name))
        tier.notes = tier.notes or one_line(notes)
        farthest = max(farthest, _corners(source, plane))
    if farthest > OFF_PLANE:
        findings.append(f"Corners in the file lie up to {farthest:.1e} off their facets; the facets' planes are taken.")
    fold, mirror, at = source.integer("the symmetry"), source.integer("the mirror"), source.at
    teeth = source.integer("the index wheel")
    if not 0 < abs(teeth) <= MOST_TEETH:
        raise MeshError(f"byte {at}: expected the teeth of an index wheel, 1 to {MOST_TEETH} or negative, got {teeth}")
    index = source.double("the refractive index")
    tag = source.integer(f"{OFFSET_FOLLOWS}")
    offset = source.double("the wheel's offset") if tag == OFFSET_FOLLOWS else float(tag)
    texts = [one_line(source.text("the headings and footnotes")) for _ in range(8)]
    if not math.isfinite(offset):
        raise MeshError(f"expected an index wheel's offset, got {offset}")
    if not 1 < index <= 10:
        findings.append(f"Expected a refractive index above 1, at most 10, got {index:g}; left out.")
    wheel = Wheel(teeth, offset)
    return Design(
        "gem", wheel,
        tuple(tier_of(tier.planes, tier.names, wheel, tier.notes) for tier in tiers.values()),
        fold=max(1, fold), mirror=mirror != 0, refractive_index=index if 1 < index <= 10 else None,
        headings=_texts(texts[:4]), footnotes=_texts(texts[4:]),
    )  # fmt: skip


def _plane(vector: tuple[float, float, float], at: int) -> PlaneRow:
    """Of n / d; what is level or upright but for rounding is so exactly."""
    size = math.hypot(*vector)
    if not 1 / LARGEST_DISTANCE <= size <= LARGEST_DISTANCE:
        raise MeshError(
            f"byte {at}: expected a facet's normal by its distance, {1 / LARGEST_DISTANCE:g} to {LARGEST_DISTANCE:g} "
            f"long, got {vector}"
        )
    x, y, z = (component / size for component in vector)
    if math.hypot(x, y) < LEVEL:
        x, y, z = 0.0, 0.0, math.copysign(1, z)
    elif abs(z) < LEVEL:
        z = 0.0
    return x, y, z, 1 / size


def _corners(source: _Bytes, plane: PlaneRow) -> float:
    """How far the facet's corners are off its plane, in units of its distance."""
    x, y, z, distance = plane
    farthest = 0.0
    while True:
        at = source.at
        more = source.integer("a corner, or 0 behind the last")
        if more == 0:
            return farthest
        if more != 1:
            raise MeshError(f"byte {at}: expected 1 before a corner or 0 behind the last, got {more}")
        corner = source.vector("a corner")
        off = abs(x * corner[0] + y * corner[1] + z * corner[2] - distance) / distance
        farthest = max(farthest, off if math.isfinite(off) else math.inf)


def _texts(texts: list[str]) -> tuple[str, ...]:
    """Without empty ones at the end."""
    while texts and not texts[-1]:
        texts.pop()
    return tuple(texts)

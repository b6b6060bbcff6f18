"""GemCad's text, `.asc`: a record a line, named by its first letter.

    GemCad version          may be missing
    g teeth offset          index wheel; its letter may be missing, its sign is the direction, the last one counts
    y fold y|n              symmetry that the program had set
    I index                 refractive index
    H text, F text          headings and footnotes
    a angle distance item*  a tier; an item is an index, `n` and a name, or `G` and notes to the record's end

Records of tiers wrap: a line that begins with a blank, a number, `n` or `G` goes on with the tier before it. Angles are
positive for the crown, negative for the pavilion, 90 of either sign for the girdle, 0 for the table; a culet has the
angle 0 with a negative distance, or -0.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from culet.errors import InputError, MeshError
from culet.geometry.designs.design import MOST_TEETH, Design, Facet, FacetSide, Tier, Wheel, plane_of
from culet.geometry.designs.limits import LARGEST_DISTANCE, check_facets
from culet.geometry.designs.text import decoded, is_number, lines_of, number, one_line, shown

_VERSION = re.compile(r"GemCad\b", re.IGNORECASE)
_RECORD = re.compile(r"([gyIHFa])(?=[\s\d+.\-]|$)\s*(.*)", re.DOTALL)
"""The number may follow its letter at once, as in `g96`."""

LARGEST_INDEX = 1e6
"""Teeth; files have negative ones and some beyond the wheel's."""


@dataclass
class _Record:
    """A line and what wraps onto the next ones."""

    line: int
    key: str
    """Its letter, `GemCad` or, of a line that is none of all, nothing."""
    parts: list[str]

    @property
    def text(self) -> str:
        """Without its letter, in one line."""
        return " ".join(self.parts)


@dataclass
class _Given:
    """A tier as its record has it, before the wheel is known."""

    record: _Record
    side: FacetSide
    angle: float
    distance: float
    indices: list[float] = field(default_factory=list)
    names: dict[int, str] = field(default_factory=dict)
    """By the place of the index that the name follows; -1 before the first."""
    notes: str = ""


def read_asc(data: bytes) -> Design:
    """The design; MeshError names the line that makes none, TooLargeError a limit."""
    design = Design("asc", Wheel(1), ())
    wheel: Wheel | None = None
    given: list[_Given] = []
    findings: list[str] = []
    unknown: list[_Record] = []
    count = 0
    for record in _records(lines_of(decoded(data))):
        try:
            match record.key:
                case "GemCad":
                    pass
                case "g":
                    wheel = _wheel(record.text.split())
                case "y":
                    design = _with_symmetry(design, record, findings)
                case "I":
                    design = _with_refractive_index(design, record, findings)
                case "H":
                    design = replace(design, headings=(*design.headings, one_line(record.text)))
                case "F":
                    design = replace(design, footnotes=(*design.footnotes, one_line(record.text)))
                case "a":
                    given.append(_tier(record, findings))
                    count += max(1, len(given[-1].indices))
                    check_facets(count)
                case _:
                    words = record.text.split()
                    if wheel is None and not given and len(words) <= 2 and all(map(is_number, words)):
                        wheel = _wheel(words)
                    else:
                        unknown.append(record)
        except InputError as error:
            raise type(error)(f"line {record.line}: {error}") from error
    if wheel is None:
        but = f"; line {unknown[0].line} is {shown(unknown[0].text)}" if unknown else ""
        raise MeshError(f"expected an index wheel, a line such as `g 96 0.0`, got none{but}")
    if unknown:
        more = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
        findings.append(f"Line {unknown[0].line}{more} not understood and left out: {shown(unknown[0].text)}.")
    return replace(design, wheel=wheel, tiers=tuple(_placed(tier, wheel) for tier in given), findings=tuple(findings))


def _records(lines: list[str]) -> Iterator[_Record]:
    tier: _Record | None = None
    for line, text in enumerate(lines, 1):
        stripped = text.strip()
        if not stripped:
            continue
        found = None if tier is not None and _goes_on(text, stripped) else _RECORD.match(stripped)
        if found is not None or _VERSION.match(stripped):
            if tier is not None:
                yield tier
            key, rest = found.groups() if found is not None else ("GemCad", stripped[6:])
            record = _Record(line, key, [rest])
            tier = record if key == "a" else None
            if tier is None:
                yield record
        elif tier is not None and (text[0] in " \t" or re.match(r"[\dnG+\-.]", stripped)):
            tier.parts.append(stripped)
        else:
            yield _Record(line, "", [stripped])
    if tier is not None:
        yield tier


def _goes_on(text: str, stripped: str) -> bool:
    """Whether an indented line that could be a record by its first letter belongs to the tier before it."""
    if text[0] not in " \t" or stripped[0] in "HF":
        return False
    words = re.sub(r"^a(?=\S)", "a ", stripped).split()
    return not (words[0] == "a" and len(words) > 2 and is_number(words[1]) and is_number(words[2]))


def _wheel(words: list[str]) -> Wheel:
    if not words:
        raise MeshError("expected the teeth of an index wheel, got nothing")
    teeth = number(words[0], "the teeth of an index wheel", MOST_TEETH)
    if teeth == 0 or teeth != int(teeth):
        raise MeshError(f"expected a whole number of teeth, not 0, got {shown(words[0])}")
    offset = number(words[1], "the wheel's offset", LARGEST_INDEX) if len(words) > 1 else 0.0
    return Wheel(int(teeth), offset)


def _with_symmetry(design: Design, record: _Record, findings: list[str]) -> Design:
    words = record.text.split()
    if not words or not re.fullmatch(r"[1-9]\d{0,3}", words[0], re.ASCII):
        findings.append(f"Line {record.line}: expected a symmetry such as `8 y`, got {shown(record.text)}; left out.")
        return design
    return replace(design, fold=int(words[0]), mirror=len(words) > 1 and words[1][0] in "yY")


def _with_refractive_index(design: Design, record: _Record, findings: list[str]) -> Design:
    words = record.text.split()
    if not words or not is_number(words[0]) or not 1 < float(words[0]) <= 10:
        findings.append(
            f"Line {record.line}: expected a refractive index above 1, at most 10, got {shown(record.text)}; left out."
        )
        return design
    return replace(design, refractive_index=float(words[0]))


def _tier(record: _Record, findings: list[str]) -> _Given:
    words = record.text.split(None, 2)
    if len(words) < 2:
        raise MeshError(f"expected a tier's angle and distance, got {shown(record.text)}")
    angle = number(words[0], "an angle in degrees", 90)
    distance = number(words[1], "a distance", LARGEST_DISTANCE)
    tier = _Given(record, _side(angle, distance), abs(angle), abs(distance))
    if distance < 0 and angle != 0:
        findings.append(f"Line {record.line}: a sloping facet at the distance {words[1]}; taken as {abs(distance):g}.")
    _read_items(words[2] if len(words) > 2 else "", tier, findings)
    if angle != 0 and not tier.indices:
        findings.append(f"Line {record.line}: a tier of {words[0]} degrees without an index; it has no facets.")
    return tier


def _side(angle: float, distance: float) -> FacetSide:
    if angle == 0:
        return "culet" if distance < 0 or math.copysign(1, angle) < 0 else "table"
    if abs(angle) == 90:
        return "girdle"
    return "crown" if angle > 0 else "pavilion"


def _read_items(text: str, tier: _Given, findings: list[str]) -> None:
    stray: list[str] = []
    words = re.finditer(r"\S+", text)
    for found in words:
        word = found[0]
        if word == "n":
            name = next(words, None)
            if name is not None:
                tier.names.setdefault(len(tier.indices) - 1, one_line(name[0]))
        elif word == "G":
            tier.notes = one_line(text[found.end() :])
            break
        elif re.match(r"[+-]?\.?\d", word):
            tier.indices.append(number(word, "an index", LARGEST_INDEX))
        else:
            stray.append(word)
    if stray:
        more = f" and {len(stray) - 1} more" if len(stray) > 1 else ""
        findings.append(f"Line {tier.record.line}: expected an index, got {shown(stray[0])}{more}; left out.")


def _placed(given: _Given, wheel: Wheel) -> Tier:
    level = given.side in ("table", "culet")
    indices = (given.indices or [float(abs(wheel.teeth))])[:1] if level else given.indices
    name = next(iter(given.names.values()), "")
    facets = tuple(
        Facet(
            index, given.names.get(place, name),
            plane_of(given.side, given.angle, wheel.azimuth(index), given.distance),
        )
        for place, index in enumerate(indices)
    )  # fmt: skip
    return Tier(given.side, given.angle, given.distance, facets, given.notes, given.record.line)

"""A cutting diagram as SVG, one page: four views, the index wheel, proportions, the tiers in the order of cutting."""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from culet.geometry.designs.design import Tier, Wheel
from culet.geometry.designs.measures import DesignOutline, outline_of, proportions_of
from culet.geometry.designs.solid import Solid
from culet.geometry.designs.tables import indices_of, listing
from culet.geometry.designs.views import ABOVE, BELOW, END, FRONT, Face, ViewSide, faces_seen

WIDTH, HEIGHT = 210.0, 297.0
"""Of the page, mm: ISO 216 A4."""
MARGIN = 12.0
VIEW = 62.0
"""Largest extent of the stone in a view, mm."""
RING = 40.0
"""Largest distance of a corner from the wheels' middle, mm: two wheels with their numbers lie side by side."""
TEXT = 3.2
"""Height of letters, mm."""
ROW = 4.4
SMALLEST_LABEL, LARGEST_LABEL = 1.5, 2.4
"""Height of letters on facets, mm."""
LETTER = 0.6
"""Width of a letter of a fixed pitch by its height; most fonts have a little less."""
MOST_TICKS = 120
LABELS = 16
"""Of an index wheel, at most."""
COLUMNS = (MARGIN, MARGIN + 9, MARGIN + 45, MARGIN + 65)
"""Of the table; mm from the left."""
TITLES = ("tier", "name", "angle", "indices and notes")

FONT = "DejaVu Sans Mono,Liberation Mono,Consolas,monospace"
FACE = 'fill="#fff" stroke="#000" stroke-width=".25" stroke-linejoin="round"'
TICK = 'stroke="#000" stroke-width=".2"'
LABEL = 'class="label" text-anchor="middle" dominant-baseline="central"'
"""Attributes, not a style sheet: a page whose policy forbids styles of its own shows the drawing too."""


def diagram_of(solid: Solid) -> str:
    """The page. A longer table makes the page longer, and what a printer fits onto its sheet smaller."""
    design, outline = solid.design, outline_of(solid.cut)
    parts: list[str] = []
    y = MARGIN + TEXT
    for place, heading in enumerate(design.headings or ("Design",)):
        size = 1.6 * TEXT if place == 0 else TEXT
        parts += [_text(MARGIN, y, line, size=size) for line in _lines(heading, WIDTH - 2 * MARGIN, size)[:1]]
        y += 1.5 * size
    radius = float(np.hypot(*outline.corners[:, :2].T).max())
    scale = min(VIEW / float(np.ptp(outline.corners, axis=0).max()), RING / radius)
    ring = scale * radius + 3
    middle = y + ring + 9
    left, right = WIDTH / 4 + 3, 3 * WIDTH / 4 - 3
    parts += _view(solid, outline, ABOVE, (left, middle), scale)
    parts += _view(solid, outline, BELOW, (right, middle), scale)
    parts += _wheel(design.wheel, (left, middle), ring, turn=1)
    parts += _wheel(design.wheel, (right, middle), ring, turn=-1)
    tall = scale * float(np.ptp(outline.corners[:, 2])) / 2
    y = middle + ring + 12
    parts += _view(solid, outline, FRONT, (left, y + tall), scale)
    parts += _view(solid, outline, END, (right, y + tall), scale)
    y += 2 * tall + 8
    lines = list(_figures(solid))
    for place, line in enumerate(lines):
        parts.append(_text(MARGIN + place % 3 * (WIDTH - 2 * MARGIN) / 3, y + place // 3 * ROW, line))
    y += (len(lines) + 2) // 3 * ROW + 2
    parts += [_text(x, y + ROW, title) for x, title in zip(COLUMNS, TITLES, strict=True)]
    y += ROW + 1.2
    parts.append(f'<line x1="{MARGIN}" y1="{_short(y)}" x2="{WIDTH - MARGIN}" y2="{_short(y)}" {TICK}/>')
    for number, tier in enumerate(design.tiers, 1):
        rows, y = _row(number, tier, y)
        parts += rows
    for footnote in design.footnotes:
        for line in _lines(footnote, WIDTH - 2 * MARGIN, TEXT):
            parts.append(_text(MARGIN, y + ROW, line))
            y += ROW
    height = max(HEIGHT, y + MARGIN)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:g}mm" height="{HEIGHT:g}mm" '
        f'viewBox="0 0 {WIDTH:g} {_short(height)}" font-family="{FONT}">'
        f'<title>{escape(design.title or "Design")}</title><rect width="100%" height="100%" fill="#fff"/>'
    )
    return "\n".join([head, *parts, "</svg>", ""])


def _view(
    solid: Solid, outline: DesignOutline, side: ViewSide, middle: tuple[float, float], scale: float
) -> Iterator[str]:
    """Faces with their names where there is room, about a middle on the page."""
    axes = np.array([side.right, side.up], np.float64).T
    seen = outline.corners @ axes
    # The design's axis is the middle of wheels; seen from beside, the stone's own middle.
    centre = np.zeros(2) if side in (ABOVE, BELOW) else (seen.min(axis=0) + seen.max(axis=0)) / 2
    yield f"<g><desc>{side.name}</desc>"
    faces = faces_seen(solid, outline, side)
    for face in faces:
        placed = ((face.corners - centre) * scale).tolist()
        points = " ".join(f"{_short(middle[0] + x)},{_short(middle[1] - y)}" for x, y in placed)
        yield f'<polygon points="{points}" {FACE}/>'
    for face in faces:
        yield from _label(face, centre, middle, scale)
    yield "</g>"


def _label(face: Face, centre: NDArray[np.float64], middle: tuple[float, float], scale: float) -> Iterator[str]:
    """Its name, its tier's number where there is no room for that, or nothing."""
    x, y = ((face.middle - centre) * scale).tolist()
    for text in (face.name, str(face.tier)):
        size = min(LARGEST_LABEL, 1.6 * face.room * scale / max(1.2, LETTER * len(text)))
        if text and size >= SMALLEST_LABEL:
            yield _text(middle[0] + x, middle[1] - y, text, size=size, label=True)
            return


def _wheel(wheel: Wheel, middle: tuple[float, float], radius: float, *, turn: int) -> Iterator[str]:
    """Ticks at the teeth, and numbers at some; `turn` is 1 seen from above, -1 from below."""
    teeth = abs(wheel.teeth)
    tick = next(step for step in range(1, teeth + 1) if teeth % step == 0 and teeth / step <= MOST_TICKS)
    label = next(step for step in range(tick, teeth + 1, tick) if teeth % step == 0 and teeth / step <= LABELS)
    for index in range(tick, teeth + 1, tick):
        azimuth = wheel.azimuth(index)
        x, y = turn * math.sin(azimuth), -math.cos(azimuth)
        end = radius + (2 if index % label == 0 else 1)
        yield (
            f'<line x1="{_short(middle[0] + radius * x)}" y1="{_short(middle[1] + radius * y)}" '
            f'x2="{_short(middle[0] + end * x)}" y2="{_short(middle[1] + end * y)}" {TICK}/>'
        )
        if index % label == 0:
            at = end + 2.4
            yield _text(middle[0] + at * x, middle[1] + at * y, str(index), size=2.4, label=True)


def _figures(solid: Solid) -> Iterator[str]:
    yield from (f"{name:15}{value}" for name, value in listing(proportions_of(solid)))
    design = solid.design
    offset = f", offset {design.wheel.offset:g}" if design.wheel.offset else ""
    yield f"{'wheel':15}{design.wheel.teeth}{offset}"
    yield f"{'symmetry':15}{design.fold}-fold{', mirror' if design.mirror else ''}"
    if design.refractive_index is not None:
        yield f"{'made for n':15}{design.refractive_index:g}"


def _row(number: int, tier: Tier, y: float) -> tuple[list[str], float]:
    """A tier of the table, and where the next begins."""
    below = tier.side in ("pavilion", "culet")
    angle = {"table": "table", "girdle": "90.00", "culet": "culet"}.get(tier.side, f"{tier.angle:.2f}")
    words = "  ".join(text for text in (indices_of(tier), tier.notes) if text)
    lines = _lines(words, WIDTH - MARGIN - COLUMNS[3], TEXT) or [""]
    cells = (str(number), tier.name[:18], ("-" if below and tier.angle else "") + angle)
    row = [_text(x, y + ROW, cell) for x, cell in zip(COLUMNS, cells, strict=False)]
    row += [_text(COLUMNS[3], y + ROW * (place + 1), line) for place, line in enumerate(lines) if line]
    return row, y + ROW * len(lines)


def _lines(text: str, width: float, size: float) -> list[str]:
    """The text in lines that fit; a word that does not is cut."""
    most = int(width / (LETTER * size))
    lines: list[str] = []
    for word in text.split(" "):
        if lines and len(lines[-1]) + 1 + len(word) <= most:
            lines[-1] += f" {word}"
        else:
            lines += [word[k : k + most] for k in range(0, len(word), most)]
    return lines


def _text(x: float, y: float, text: str, *, size: float = TEXT, label: bool = False) -> str:
    kind = f" {LABEL}" if label else ' xml:space="preserve"'
    return f'<text x="{_short(x)}" y="{_short(y)}" font-size="{_short(size)}"{kind}>{escape(text)}</text>'


def _short(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".")

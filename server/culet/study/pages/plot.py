"""Log-log plots as SVG: figures that can be read on screen, on paper and without colour."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

WIDTH, HEIGHT = 900, 470
LEFT, RIGHT, TOP, BOTTOM = 74, 280, 14, 52
LINE = 16
"""Of the legend, and of the frontier's names below it."""
COLOURS = ("#1b6ca8", "#c0392b", "#2e8540", "#8e44ad", "#b9770e", "#117a8b", "#7b4b2a", "#5d6d7e")
SHAPES = ("circle", "square", "up", "diamond", "down", "plus", "cross", "bar")

CLOSE = 18
"""Two numbers nearer than this would cover each other."""


class Mark(NamedTuple):
    """A point of a plot; both numbers above 0."""

    x: float
    y: float
    title: str = ""
    """Shown by a screen when pointed at."""
    name: str = ""
    """Told in the margin, if it is one of the frontier's."""


@dataclass(frozen=True)
class Series:
    """Marks of one kind."""

    name: str
    marks: Sequence[Mark]
    line: bool = False


def log_log(series: Sequence[Series], x_label: str, y_label: str, frontier: Sequence[Mark] = ()) -> str:
    """An inline SVG. `frontier` is drawn as a stair and numbered from 1, left to right; its names are in the margin."""
    shown = [Series(each.name, [m for m in each.marks if m.x > 0 and m.y > 0], each.line) for each in series]
    shown = [each for each in shown if each.marks]
    marks = [mark for each in shown for mark in each.marks] + [m for m in frontier if m.x > 0 and m.y > 0]
    if not marks:
        return "<p>Nothing to draw: no point has both figures above 0.</p>"
    frame = _Frame(_range([m.x for m in marks]), _range([m.y for m in marks]))
    about = html.escape(f"{y_label} over {x_label}")
    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{about}">',
        *_axes(frame, x_label, y_label),
    ]
    parts += _frontier(frame, [m for m in frontier if m.x > 0 and m.y > 0])
    for number, each in enumerate(shown):
        colour, shape = COLOURS[number % len(COLOURS)], SHAPES[number % len(SHAPES)]
        if each.line and len(each.marks) > 1:
            points = " ".join(f"{frame.x(m.x):.1f},{frame.y(m.y):.1f}" for m in each.marks)
            parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.2"/>')
        parts += [_mark(frame.x(m.x), frame.y(m.y), shape, colour, m.title) for m in each.marks]
        y = TOP + 10 + LINE * number
        parts.append(_mark(WIDTH - RIGHT + 18, y, shape, colour, ""))
        parts.append(f'<text x="{WIDTH - RIGHT + 28}" y="{y + 4}">{html.escape(each.name)}</text>')
    if frontier:
        parts += _frontier_legend(frontier, TOP + 10 + LINE * len(shown))
    return "".join([*parts, "</svg>"])


class _Frame:
    """From numbers to places on the page."""

    def __init__(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        self.x_range, self.y_range = x, y

    def x(self, value: float) -> float:
        low, high = map(math.log10, self.x_range)
        return LEFT + (math.log10(value) - low) / (high - low) * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        low, high = map(math.log10, self.y_range)
        return HEIGHT - BOTTOM - (math.log10(value) - low) / (high - low) * (HEIGHT - TOP - BOTTOM)


def _range(values: Sequence[float]) -> tuple[float, float]:
    low, high = math.log10(min(values)), math.log10(max(values))
    margin = max(0.05 * (high - low), 0.1)
    return 10 ** (low - margin), 10 ** (high + margin)


def _ticks(low: float, high: float) -> list[tuple[float, str]]:
    """Every power of ten, with 2 and 5 between where there are few; names for those that have room."""
    exponents = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    digits = (1, 2, 5) if len(exponents) <= 5 else (1,)
    every = math.ceil(len(exponents) / 8)
    return [
        (digit * 10.0**e, f"{digit * 10.0**e:g}" if e % every == 0 else "")
        for e in exponents
        for digit in digits
        if low <= digit * 10.0**e <= high
    ]


def _axes(frame: _Frame, x_label: str, y_label: str) -> list[str]:
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = []
    for value, name in _ticks(*frame.x_range):
        x = frame.x(value)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}" class="grid"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 18}" text-anchor="middle">{name}</text>')
    for value, name in _ticks(*frame.y_range):
        y = frame.y(value)
        parts.append(f'<line x1="{LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>')
        parts.append(f'<text x="{LEFT - 7}" y="{y + 4:.1f}" text-anchor="end">{name}</text>')
    parts.append(
        f'<rect x="{LEFT}" y="{TOP}" width="{right - LEFT}" height="{bottom - TOP}" fill="none" stroke="#444"/>'
    )
    middle_x, middle_y = (LEFT + right) / 2, (TOP + bottom) / 2
    parts.append(f'<text x="{middle_x}" y="{HEIGHT - 12}" text-anchor="middle">{html.escape(x_label)}</text>')
    parts.append(
        f'<text transform="translate(16 {middle_y}) rotate(-90)" text-anchor="middle">{html.escape(y_label)}</text>'
    )
    return parts


def _frontier(frame: _Frame, frontier: Sequence[Mark]) -> list[str]:
    if not frontier:
        return []
    path = [f"M{frame.x(frontier[0].x):.1f} {frame.y(frontier[0].y):.1f}"]
    path += [f"H{frame.x(m.x):.1f}V{frame.y(m.y):.1f}" for m in frontier[1:]]
    parts = [f'<path d="{"".join(path)}" class="frontier"/>']
    before = (-math.inf, -math.inf)
    for number, mark in enumerate(frontier, 1):
        x, y = frame.x(mark.x), frame.y(mark.y)
        if math.hypot(x - before[0], y - before[1]) < CLOSE:  # below it there is another's number
            parts.append(f'<text x="{x + 5:.1f}" y="{y - 7:.1f}" class="number">{number}</text>')
        else:
            parts.append(f'<text x="{x - 6:.1f}" y="{y + 14:.1f}" text-anchor="end" class="number">{number}</text>')
            before = (x, y)
    return parts


def _frontier_legend(frontier: Sequence[Mark], top: float) -> list[str]:
    left = WIDTH - RIGHT
    parts = [
        f'<line x1="{left + 10}" x2="{left + 26}" y1="{top}" y2="{top}" class="frontier"/>',
        f'<text x="{left + 28}" y="{top + 4}">Pareto frontier</text>',
    ]
    for number, mark in enumerate(frontier, 1):
        if mark.name:
            y = top + 6 + LINE * number
            parts.append(f'<text x="{left + 30}" y="{y}" text-anchor="end" class="number">{number}.</text>')
            parts.append(f'<text x="{left + 34}" y="{y}" class="name">{html.escape(mark.name)}</text>')
    return parts


def _mark(x: float, y: float, shape: str, colour: str, title: str) -> str:
    r = 4.2
    polygons = {
        "square": ((-r, -r), (r, -r), (r, r), (-r, r)),
        "up": ((0, -r - 1), (r + 1, r), (-r - 1, r)),
        "down": ((0, r + 1), (r + 1, -r), (-r - 1, -r)),
        "diamond": ((0, -r - 1.5), (r + 1.5, 0), (0, r + 1.5), (-r - 1.5, 0)),
    }
    strokes = {
        "plus": f"M{x - r - 1:.1f} {y:.1f}h{2 * r + 2}M{x:.1f} {y - r - 1:.1f}v{2 * r + 2}",
        "cross": f"M{x - r:.1f} {y - r:.1f}l{2 * r} {2 * r}m0 {-2 * r}l{-2 * r} {2 * r}",
        "bar": f"M{x - r - 1:.1f} {y:.1f}h{2 * r + 2}",
    }
    told = f"<title>{html.escape(title)}</title>" if title else ""
    if shape in polygons:
        points = " ".join(f"{x + a:.1f},{y + b:.1f}" for a, b in polygons[shape])
        return f'<polygon points="{points}" fill="{colour}" fill-opacity="0.75">{told}</polygon>'
    if shape in strokes:
        return f'<path d="{strokes[shape]}" stroke="{colour}" stroke-width="2" fill="none">{told}</path>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r}" fill="{colour}" fill-opacity="0.75">{told}</circle>'

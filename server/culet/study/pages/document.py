"""One HTML page that needs nothing else: style, tables, figures."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Sequence

from culet.study.report import Knob

WIDE = 8
"""Columns; a table with more is set smaller."""
SHORT = 48
"""Letters of a cell that is not broken into lines."""

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1c; background: #fff; max-width: 66rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; } h3 { font-size: 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; margin: 0.6rem 0 1.2rem; }
th, td { padding: 0.2rem 0.45rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
table.wide { font-size: 0.74rem; } table.wide :is(th, td) { padding: 0.2rem 0.3rem; }
td.short { white-space: nowrap; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
thead th { border-bottom: 1.5px solid #555; }
svg { width: 100%; height: auto; font: 12px system-ui, sans-serif; }
svg .grid { stroke: #e2e2e2; stroke-width: 0.7; }
svg .frontier { stroke: #111; stroke-width: 1.6; fill: none; stroke-dasharray: 5 3; }
svg .number { font-weight: 600; font-size: 11px; }
svg .name { font-size: 11px; }
code { font: 0.92em ui-monospace, monospace; }
figure { margin: 0.5rem 0; break-inside: avoid; }
figcaption { font-size: 0.85rem; color: #444; }
.pictures { display: grid; grid-template-columns: repeat(2, 1fr); gap: 0.8rem; }
.pictures img { width: 100%; image-rendering: auto; }
.bar { height: 10px; width: 14rem; }
@media print { body { margin: 0; padding: 0; max-width: none; font-size: 10pt; } h2 { break-after: avoid; }
  .scroll { overflow: visible; } table { font-size: 8pt; } table.wide { font-size: 5.8pt; } }
"""


def document(title: str, body: Iterable[str]) -> str:
    """The whole page."""
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{html.escape(title)}</title>\n'
        f"<style>{STYLE}</style>\n</head>\n<body>\n<h1>{html.escape(title)}</h1>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[Knob]]) -> str:
    """Numbers to the right, to three digits; None is a dash."""
    rows = [list(row) for row in rows]
    numeric = [any(_is_number(row[k]) for row in rows) for k in range(len(head))]
    shown = ["".join(_cell("th", name, number=number) for name, number in zip(head, numeric, strict=True))]
    lines = [
        "<tr>" + "".join(_cell("td", text(cell), number=n) for cell, n in zip(row, numeric, strict=True)) + "</tr>"
        for row in rows
    ]
    kind = " class=wide" if len(head) > WIDE else ""
    return (
        f'<div class="scroll"><table{kind}><thead><tr>{shown[0]}</tr></thead><tbody>'
        + "".join(lines)
        + "</tbody></table></div>"
    )


def paragraph(words: str) -> str:
    """Of plain text, with `code` between backticks."""
    return "<p>" + re.sub(r"`(.+?)`", r"<code>\1</code>", html.escape(words)) + "</p>"


def heading(words: str, level: int = 2) -> str:
    """A section begins."""
    return f"<h{level}>{html.escape(words)}</h{level}>"


def figure(content: str, caption: str) -> str:
    """Something drawn, and what it shows."""
    return f"<figure>{content}<figcaption>{html.escape(caption)}</figcaption></figure>"


def picture(source: str, caption: str) -> str:
    """An image from a data URL."""
    return figure(f'<img src="{source}" alt="{html.escape(caption)}">', caption)


def text(value: Knob) -> str:
    """As a table shows it."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.3g}"
    return value


def _is_number(value: Knob) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _cell(tag: str, words: str, *, number: bool) -> str:
    kind = " class=number" if number else " class=short" if len(words) <= SHORT else ""
    return f"<{tag}{kind}>{html.escape(words)}</{tag}>"

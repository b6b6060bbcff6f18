"""A report in short, as a Markdown table, and its place in a document."""

from __future__ import annotations

from pathlib import Path

from culet.errors import InputError
from culet.study.report import Report

BEGIN, END = "<!-- culet study headline: begin -->", "<!-- culet study headline: end -->"
"""What is between them is written by `culet study headline --into`."""


def headline_markdown(report: Report) -> str:
    """A table for a document."""
    facts = report.provenance
    on = ", ".join(str(facts[name]) for name in ("processor", "driver", "commit") if name in facts)
    rows = "".join(f"| {line.name} | {f'{line.value:.3g} {line.unit}'.strip()} |\n" for line in report.headlines)
    return f"| {report.study}, {_size(report)} | |\n|---|---|\n{rows}\nMeasured on {on}, {report.made[:10]}.\n"


def _size(report: Report) -> str:
    width, height = report.settings.get("width"), report.settings.get("height")
    return f"{width} x {height}" if width else "default stone"


def write_into(path: Path, text: str, marks: tuple[str, str] = (BEGIN, END)) -> None:
    """Put the text between the file's marks, in place of what is there; InputError if it has not just one pair."""
    first, last = marks
    try:
        before = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {path}: {error}") from error
    head, begin, rest = before.partition(first)
    _, end, tail = rest.partition(last)
    if not begin or not end or first in rest or last in tail:
        raise InputError(f"{path}: expected one line {first!r} and after it one line {last!r}")
    try:
        path.write_text(f"{head}{first}\n\n{text}\n{last}{tail}", encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}") from error

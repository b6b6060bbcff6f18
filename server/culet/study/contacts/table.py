"""All trials of several stones, kept as they are measured, and their table."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

from culet.study.contacts import extreme, heaps, one_stone, pairs
from culet.study.contacts.finding import Finding
from culet.study.findings.journal import PointJournal
from culet.study.findings.provenance import SIMULATION_STUDY, code_digest, commit, processor
from culet.study.report import Point

MARKS = "<!-- culet study contacts: begin -->", "<!-- culet study contacts: end -->"
"""What is between them in docs/explanation/simulation.md is written by `culet study contacts --into`."""

CASES = tuple(f"{case.name}: " for case in extreme.EXTREMES)
MEASURES = {
    "overlap at any time, R (at most)": "overlap",
    "at the end, R (at most)": "overlap at the end",
    "rise of energy, of that at the start (at most)": "rise of energy",
    "left at, R/s (at most)": "speed after a step",
}
"""What a column holds, and what the claims call it. Each case is finite and nothing falls through the floor, too."""

Trial = Callable[[], Iterator[Finding]]


def trials(*, quick: bool) -> dict[str, Trial]:
    """By name, the cheap ones first; quick: fewer drops and heaps."""
    found: dict[str, Trial] = {
        "one stone": partial(one_stone.findings, quick=quick),
        "pairs": pairs.findings,
        "extremes": extreme.findings,
        "starts in each other": extreme.spinning_starts,
    }
    for count in (12,) if quick else (12, 32, 64):
        found[f"cost of {count}"] = partial(heaps.costs, count)
        for seed in heaps.SEEDS[: 1 if quick else None]:
            found[f"heap of {count}, seed {seed}"] = partial(heaps.heaps, count, (seed,))
    for kind, count in heaps.THIN_HEAPS[: 1 if quick else None]:
        for seed in heaps.SEEDS[: 1 if quick else None]:
            found[f"heap of {count} {kind}, seed {seed}"] = partial(heaps.thin_heaps, kind, count, (seed,))
    return found


def measured(folder: Path, tell: Callable[[str], object], *, quick: bool, fresh: bool) -> list[Finding]:
    """Run what an earlier run has not left in the folder. InputError if the folder holds another study."""
    identity: dict[str, object] = {"study": "contacts", "code": code_digest(SIMULATION_STUDY), "quick": quick}
    found: list[Finding] = []
    with PointJournal(folder / "contacts.jsonl", identity, fresh=fresh) as journal:
        for name, trial in trials(quick=quick).items():
            if not any(point.group == name for point in journal.points.values()):
                journal.add(*(_point(name, finding) for finding in trial()))
            for point in journal.points.values():
                if point.group == name:
                    found.append(_finding(point))
                    tell(found[-1].row())
    return found


def written(findings: Sequence[Finding]) -> str:
    """Two tables in Markdown: the claims, of heaps of one size the worst seed's, and the extremes."""
    found = worst(findings)
    extremes = [finding for finding in found if finding.claim.startswith(CASES)]
    lines = ["| claim | measured | at most | held |", "|---|---|---|---|"]
    lines += [finding.row() for finding in found if finding not in extremes]
    lines += ["", f"| case | {' | '.join(MEASURES)} | held |", f"|---|{'---|' * len(MEASURES)}---|"]
    for case in extreme.EXTREMES:
        own = {
            finding.claim.removeprefix(f"{case.name}: "): finding
            for finding in extremes
            if finding.claim.startswith(f"{case.name}: ")
        }
        cells = [_cell(own.get(name)) for name in MEASURES.values()]
        held = all(finding.held for finding in own.values())
        lines.append(f"| {case.name} | {' | '.join(cells)} | {'yes' if held else '**no**'} |")
    lines += ["", f"Measured on {processor()}, {commit()}, {dt.datetime.now(dt.UTC):%Y-%m-%d}."]
    return "\n".join(lines) + "\n"


def _cell(finding: Finding | None) -> str:
    return "" if finding is None else f"{max(finding.value, 0):.1g} ({finding.limit:.2g})"


def worst(findings: Iterable[Finding]) -> list[Finding]:
    """Of those with the same claim, the one that is least well held."""
    found: dict[str, Finding] = {}
    for finding in findings:
        before = found.get(finding.claim)
        if before is None or not finding.held or finding.value > before.value:
            found[finding.claim] = finding
    return list(found.values())


def _point(trial: str, finding: Finding) -> Point:
    limits = {"limit": finding.limit, "least": finding.least, "unit": finding.unit}
    value = finding.value if finding.value == finding.value else None  # JSON has no NaN
    key = f"{trial}: {finding.claim}"
    return Point(key=key, group=trial, label=finding.claim, knobs=limits, figures={"value": value})


def _finding(point: Point) -> Finding:
    value, limit, least = point.figures["value"], point.knobs["limit"], point.knobs["least"]
    assert isinstance(limit, int | float)  # noqa: S101 - as _point wrote it
    assert least is None or isinstance(least, int | float)  # noqa: S101
    return Finding(point.label, float("nan") if value is None else value, float(limit), str(point.knobs["unit"]), least)

"""Two lines of `culet bench -o` side by side: has a change made frames slower, or less exact?

Times of two machines say nothing of the code. Then each scene's time is taken as a multiple of the first scene's, on
either side: a scene that has become dearer than the others is still seen.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

from culet.errors import InputError
from culet.study.findings.ratio import ratio, shown

FIGURES = ("seconds", "processor_seconds", "preparation_seconds", "segments", "cut", "rmse")
"""That are compared; all better if less."""
WORKED = 0.75
"""Part of a device's units that work at least while a frame is rendered on an idle machine."""
Cases = dict[str, dict[str, Any]]
"""By name: a scene's figures."""
TIMES = frozenset({"seconds", "processor_seconds", "preparation_seconds"})
CONDITIONS = ("processor", "device", "units", "width", "height")
"""What must be the same for times to be compared as they are."""


class CaseRatios(NamedTuple):
    """Of one scene."""

    name: str
    ratios: dict[str, float | None]
    """After / before by figure; None where one of them lacks it, infinite where something has come out of nothing."""


class Comparison(NamedTuple):
    """Of two lines."""

    cases: list[CaseRatios]
    relative: bool
    """Whether times are multiples of the first scene's, since the lines are of two machines or sizes."""
    remarks: list[str]


def compare_benches(before: dict[str, Any], after: dict[str, Any]) -> Comparison:
    """Ratios after / before of the scenes that both have."""
    old_facts, new_facts = _facts(before), _facts(after)
    remarks = [
        f"{name} differs: {shown(old_facts.get(name))}, then {shown(new_facts.get(name))}"
        for name in {**old_facts, **new_facts}
        if old_facts.get(name) != new_facts.get(name)
    ]
    relative = any(old_facts.get(name) != new_facts.get(name) for name in CONDITIONS)
    if relative:
        remarks.append("so times are compared as multiples of the first scene's on either side")
    old, new = ({case["name"]: case for case in record["cases"]} for record in (before, after))
    shared = [name for name in new if name in old]
    for words, names in (("before", [n for n in old if n not in new]), ("after", [n for n in new if n not in old])):
        if names:
            remarks.append(f"only {words}: {', '.join(names)}")
    sides = [
        (old, _units(before, old, shared, relative=relative)),
        (new, _units(after, new, shared, relative=relative)),
    ]
    cases = [CaseRatios(name, {figure: _ratio(sides, name, figure) for figure in FIGURES}) for name in shared]
    return Comparison(cases, relative, remarks)


def last_line(path: Path) -> dict[str, Any]:
    """What the last line of a file of `culet bench -o` holds; InputError for another file."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {path}: {error}") from error
    try:
        record: dict[str, Any] = json.loads([line for line in lines if line.strip()][-1])
        for case in record["cases"]:
            str(case["name"])
    except (ValueError, IndexError, KeyError, TypeError) as error:
        raise InputError(f"{path}: expected JSON lines of `culet bench -o`") from error
    return record


def _facts(record: dict[str, Any]) -> dict[str, object]:
    return {**(record.get("machine") or {}), **{name: record.get(name) for name in ("flags", "width", "height")}}


def _units(record: dict[str, Any], cases: Cases, shared: list[str], *, relative: bool) -> dict[str, float | None]:
    """What a figure of one side is a multiple of: segments of the pixels, `relative` times of the first scene's."""
    units: dict[str, float | None] = {"segments": record.get("width", 0) * record.get("height", 0)}
    return units | ({figure: cases[shared[0]].get(figure) for figure in TIMES} if relative and shared else {})


def _ratio(sides: list[tuple[Cases, dict[str, float | None]]], name: str, figure: str) -> float | None:
    values = []
    for cases, units in sides:
        value, unit = cases[name].get(figure), units.get(figure, 1.0)
        if value is None or not unit:
            return None
        values.append(value / unit)
    return ratio(*values)


def doubts(record: dict[str, Any]) -> list[str]:
    """Why a line should not be what others are compared with: of code that nobody else has, or of a busy machine."""
    found = []
    commit, units = str(record.get("commit")), record["machine"].get("units") or 1
    if commit.endswith("-dirty") or commit == "unknown":
        found.append(f"the code is of no commit ({commit})")
    wall, spent = (sum(case[figure] for case in record["cases"]) for figure in ("seconds", "processor_seconds"))
    if spent < WORKED * units * wall:
        found.append(
            f"the machine was busy with something else: {spent / wall:.2f} of {units} units worked on the frames"
        )
    return found

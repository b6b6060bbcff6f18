"""Two lines of `culet bench -o` side by side: has a change made frames slower, or less exact?

Times of two machines say nothing of the code. Then each scene's time is taken as a multiple of the first scene's, on
either side: a scene that has become dearer than the others is still seen.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

from culet.errors import InputError

FIGURES = ("seconds", "processor_seconds", "segments", "cut", "rmse")
"""That are compared; all better if less."""
TIMES = frozenset({"seconds", "processor_seconds"})
CONDITIONS = ("processor", "device", "units", "width", "height")
"""What must be the same for times to be compared as they are."""


class CaseRatios(NamedTuple):
    """Of one scene."""

    name: str
    ratios: dict[str, float | None]
    """After / before by figure; None where one of them lacks it."""


class Comparison(NamedTuple):
    """Of two lines."""

    cases: list[CaseRatios]
    relative: bool
    """Whether times are multiples of the first scene's, since the lines are of two machines or sizes."""
    remarks: list[str]


def compare(before: dict[str, Any], after: dict[str, Any]) -> Comparison:
    """Ratios after / before of the scenes that both have."""
    old_facts, new_facts = _facts(before), _facts(after)
    remarks = [
        f"{name} differs: {_shown(old_facts.get(name))}, then {_shown(new_facts.get(name))}"
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
    cases = [
        CaseRatios(name, {figure: _ratio(old, new, name, shared[0], figure, relative) for figure in FIGURES})
        for name in shared
    ]
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


def _ratio(
    old: dict[str, Any], new: dict[str, Any], name: str, first: str, figure: str, relative: bool
) -> float | None:
    sides = []
    for cases in (old, new):
        value, unit = cases[name].get(figure), cases[first].get(figure) if relative and figure in TIMES else 1.0
        if value is None or unit is None:
            return None
        sides.append(value / unit if unit else 0.0)
    return 1.0 if sides[0] == sides[1] else sides[1] / sides[0] if sides[0] else None


def _shown(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 160 else text[:157] + "..."

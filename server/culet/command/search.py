"""What `culet design optimise` takes and tells."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich.table import Table

from culet.batch.candidates import BRIGHTNESS, FIRE, Candidate, Candidates
from culet.batch.search import Range
from culet.errors import InputError
from culet.grading.metrics import GRADES, LIGHT_RETURN
from culet.scene.recut import LEAST_RATIO, MOST_RATIO

if TYPE_CHECKING:
    from rich.console import Console

KNOWN = tuple(name for name in GRADES if name != LIGHT_RETURN)
"""The weighted light return has views of its own, hundreds of them."""


def weights_of(texts: Sequence[str]) -> dict[str, float]:
    """By grades' names; InputError for what is no weight of one."""
    found: dict[str, float] = {}
    for text in texts:
        name, equals, said = (part.strip() for part in text.partition("="))
        if name not in KNOWN:
            raise InputError(f"weight: expected one of {', '.join(KNOWN)}; got {name!r:.40}", "weight")
        try:
            number = float(said) if equals else math.nan
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise InputError(f"weight: expected {name}=NUMBER, got {text!r:.40}", "weight")
        if name in found:
            raise InputError(f"weight: expected each grade once, got {name} more than once", "weight")
        found[name] = number
    return found


def range_of(option: str, text: str) -> Range:
    """Of FROM:TO; InputError that names the option."""
    try:
        least, most = (float(part) for part in text.split(":"))
    except ValueError:
        least = most = math.nan
    if not LEAST_RATIO <= least < most <= MOST_RATIO:
        raise InputError(
            f"{option}: expected FROM:TO within {LEAST_RATIO:g} to {MOST_RATIO:g}, got {text!r:.40}", option
        )
    return least, most


def print_front(console: Console, candidates: Candidates, weights: Mapping[str, float]) -> None:
    """From the brightest to the most fiery, the best by the weighted sum marked."""
    names = _names(weights)
    best, given = candidates.best(), candidates.found[0]
    table = Table("", "crown ratio", "pavilion ratio", *names, "sum", box=None)
    turned = any(each.angles for each in candidates.found)
    if turned:
        table.add_column("tiers at degrees", overflow="fold")
    front = candidates.front()
    marked = [*front] if best in front else [*front, best]
    for each in [given, *(one for one in marked if one is not given)]:
        of = ["as it is"] * (each is given) + ["largest sum"] * (each is best)
        values = (f"{each.grades[name].value:.2f}" for name in names)
        table.add_row(
            ", ".join(of), f"{each.crown_ratio:.4f}", f"{each.pavilion_ratio:.4f}", *values, f"{each.total:.2f}",
            *[angles_text(each)] * turned,
        )  # fmt: skip
    console.print(table)
    error = max(number.error for each in front for number in each.grades.values())
    console.print(
        f"{len(front)} designs that no other of {len(candidates.found)} beats in {BRIGHTNESS} and {FIRE} both; "
        f"standard errors up to {error:.2g}"
    )


def front_csv(candidates: Candidates, weights: Mapping[str, float]) -> bytes:
    """The same as a table, with standard errors."""
    names = _names(weights)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            "crown_ratio",
            "pavilion_ratio",
            *(part for name in names for part in (name, f"{name}_error")),
            "sum",
            "angles",
        ]
    )
    for each in candidates.front():
        numbers = [part for name in names for part in (each.grades[name].value, each.grades[name].error)]
        writer.writerow([each.crown_ratio, each.pavilion_ratio, *numbers, each.total, angles_text(each)])
    return text.getvalue().encode()


def angles_text(each: Candidate) -> str:
    """As `culet design convert --angle` takes each."""
    return " ".join(f"{tier}={degrees:g}" for tier, degrees in sorted(each.angles.items()))


def _names(weights: Mapping[str, float]) -> list[str]:
    return list(dict.fromkeys([BRIGHTNESS, FIRE, *weights]))

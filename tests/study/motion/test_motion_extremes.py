"""The extremes in docs/explanation/simulation.md: everything holds that must, what makes no sense is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from culet.study.motion.motion_extremes import EXTREMES, REFUSED, DropExtreme, DropRecord, recorded, refusal


@pytest.mark.parametrize("extreme", EXTREMES, ids=lambda extreme: extreme.name)
def test_what_must_hold_of_a_drop_holds_at_every_extreme(extreme: DropExtreme) -> None:
    found = recorded(extreme)
    assert found.held, found


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_sense_is_refused_with_a_reason(case: str) -> None:
    assert refusal(case)


def test_each_flaw_is_told() -> None:
    sound = DropRecord(fastest=1, bound=1)
    assert sound.held
    for flawed in (
        replace(sound, finite=False),
        replace(sound, gain=2e-6),
        replace(sound, depth=2e-4),
        replace(sound, fastest=2.0),
        replace(sound, exit_speed=0.2, exit_bound=0.1),
    ):
        assert not flawed.held


def test_the_page_shows_every_case() -> None:
    page = (Path(__file__).parents[3] / "docs" / "explanation" / "simulation.md").read_text(encoding="utf-8")
    for name in (*(extreme.name for extreme in EXTREMES), *REFUSED):
        assert f"| {name} |" in page

"""What several stones are held to: the trials of `culet study contacts`; `make validate`, `make soak` do long ones."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import struct
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

from culet.simulation.solver import library
from culet.simulation.solver.build import build
from culet.simulation.world import World
from culet.study.contacts import extreme, heaps, one_stone, pairs
from culet.study.contacts.extreme import EXTREMES, ContactExtreme
from culet.study.contacts.finding import Finding
from culet.study.contacts.worlds import advance

QUICK: dict[str, Callable[[], Iterator[Finding]]] = {
    "flight": one_stone.flight,
    "bounces": one_stone.bounces,
    "sliding": one_stone.sliding,
    "rest": lambda: one_stone.rest(5.0),
    "drops": lambda: one_stone.drops(20),
    "balancing": one_stone.balancing,
    "against one stone": lambda: one_stone.against_one_stone(4),
    "impacts": pairs.impacts,
    "cradle": pairs.cradle,
    "stack": pairs.stack,
    "heap": lambda: heaps.heaps(12, (1,)),
    "heap of needles": lambda: heaps.thin_heaps("needles 20 : 1", 12, (1,)),
    "starts in each other": lambda: extreme.spinning_starts((3, 4)),  # which gained energy by their turns once
}


def failures(findings: Iterable[Finding]) -> list[str]:
    return [finding.row() for finding in findings if not finding.held]


def digest(world: World) -> str:
    """Of every bit of the poses and velocities."""
    sha = hashlib.sha256()
    for state in world.state.bodies:
        sha.update(struct.pack("<13d", *state.position, *state.orientation, *state.velocity, *state.spin))
    return sha.hexdigest()


@pytest.mark.parametrize("trial", QUICK)
def test_several_stones_do_as_what_is_known_says(trial: str) -> None:
    assert failures(QUICK[trial]()) == []


@pytest.mark.parametrize("case", EXTREMES, ids=lambda case: case.name)
def test_what_must_hold_of_several_stones_holds_at_every_extreme(case: ContactExtreme) -> None:
    assert failures(case.findings()) == []


@pytest.mark.parametrize("case", [case.name for case in EXTREMES if case.rise is None])
def test_stones_that_start_in_an_overlap_leave_it_without_speed(case: str) -> None:
    assert extreme.leaving_speed(case).held


def test_a_finding_beyond_its_limits_is_not_held() -> None:
    sound = Finding("claim", 0.5, 1, least=0.1)
    assert sound.held
    for value in (1.1, 0.05, math.nan):
        assert not dataclasses.replace(sound, value=value).held


def test_the_page_shows_every_extreme() -> None:
    page = (Path(__file__).parents[2] / "docs" / "explanation" / "simulation.md").read_text(encoding="utf-8")
    for case in EXTREMES:
        assert f"| {case.name} |" in page


def test_snapshots_of_stones_that_lie_on_each_other_go_on_to_the_same_bits() -> None:
    """Of which points appear as corners now of the one, now of the other: those nearby have their impulses."""
    moving, other = (heaps.heap(8, 1, heaps.THIN["wafers 20 : 1"]()) for _ in range(2))
    advance(moving, 1)
    while not moving.settled and moving.state.time < 10:
        other.restore(moving.snapshot())
        for _ in range(5):
            moving.step()
            other.step()
            assert digest(other) == digest(moving)


def test_another_process_comes_to_the_same_bits() -> None:
    moving = heaps.heap(6, 2)
    advance(moving, 3)
    program = (
        "from culet.study.contacts import heaps, worlds\n"
        "from simulation.test_contacts import digest\n"
        "moving = heaps.heap(6, 2)\n"
        "worlds.advance(moving, 3)\n"
        "print(digest(moving))"
    )
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == digest(moving)


@pytest.mark.validation
def test_every_compiler_comes_to_the_same_bits(compiler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = heaps.heap(12, 2)
    advance(expected, 5)
    made = library.loaded(build(tmp_path, compiler))
    monkeypatch.setattr("culet.simulation.together.library", lambda: made)
    moving = heaps.heap(12, 2)
    advance(moving, 5)
    assert digest(moving) == digest(expected)


@pytest.mark.validation
@pytest.mark.parametrize(
    "trial", [one_stone.rest, one_stone.drops, one_stone.against_one_stone], ids=["rest", "drops", "against one stone"]
)
def test_one_stone_does_as_what_is_known_says_in_the_long_run(trial: Callable[[], Iterator[Finding]]) -> None:
    assert failures(trial()) == []


@pytest.mark.validation
def test_five_heaps_of_twelve_come_to_rest() -> None:
    assert failures(heaps.heaps(12)) == []


@pytest.mark.soak
@pytest.mark.parametrize("count", [32, 64])
def test_five_larger_heaps_come_to_rest(count: int) -> None:
    assert failures(heaps.heaps(count)) == []


@pytest.mark.soak
@pytest.mark.parametrize(("kind", "count"), heaps.THIN_HEAPS)
def test_five_heaps_of_needles_and_wafers_come_to_rest(kind: str, count: int) -> None:
    assert failures(heaps.thin_heaps(kind, count)) == []


@pytest.mark.soak
@pytest.mark.parametrize("count", [12, 32, 64])
def test_a_heap_costs_no_more_than_so_many_stones_alone(count: int) -> None:
    assert failures(heaps.costs(count)) == []

"""Stones inside each other are allowed, and told."""

from __future__ import annotations

from typing import Any

import pytest

from culet.geometry.load import shape_of
from culet.scene import PRESETS, Scene, StoneSettings
from culet.simulation.overlaps import MOST, overlaps
from culet.simulation.solver.polyhedron import polyhedron_of
from culet.simulation.staged import world_of
from culet.stage import Stage

FLAT = [1, 0, 0, 0]


def said(*stones: dict[str, Any]) -> list[str]:
    return overlaps(world_of(Stage.of(Scene.read({"stones": list(stones)}))))


def test_stones_that_overlap_are_named_with_how_deep() -> None:
    apart = {"orientation": FLAT, "position": [5, 0, 0]}
    (sentence,) = said(
        {"id": "a", "orientation": FLAT}, {"id": "b", "orientation": FLAT, "position": [1.5, -0.37, 0]}, apart
    )
    assert sentence.startswith("the stones 'a' and 'b' overlap by 0.")


@pytest.mark.parametrize(("gap", "told"), [(-0.1, True), (0.1, False)])
def test_a_large_stone_and_a_small_one_overlap_by_their_own_sizes(gap: float, told: bool) -> None:
    """In whatever order: the small one under the large one's table, which is beyond a ball of the small one's size."""
    table = float(shape_of(StoneSettings(), {}).vertices[:, 1].max())
    culet = -float(shape_of(StoneSettings(), {}).vertices[:, 1].min())
    large = {"id": "large", "orientation": FLAT, "scale": 4, "position": [0, 0, 0]}
    small = {"id": "small", "orientation": FLAT, "scale": 0.5, "position": [0, 4 * table + 0.5 * culet + gap, 0]}
    for stones in ((large, small), (small, large)):
        assert len(said(*stones)) == told


def test_stones_that_only_touch_are_not_told_of() -> None:
    for name in ("trio", "heap"):
        assert overlaps(world_of(Stage.of(PRESETS[name].scene))) == []
    assert said() == said({}) == []


def test_of_many_overlaps_some_are_named_and_the_rest_counted() -> None:
    sentences = said(*({"position": [0, number / 10, 0]} for number in range(12)))
    assert len(sentences) == MOST + 1
    assert sentences[-1] == f"{66 - MOST} more pairs of stones overlap"


def test_stones_of_too_many_edges_to_look_at_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    edges = len(polyhedron_of(Stage.of(Scene()).shapes[0]).edges)
    monkeypatch.setattr("culet.simulation.overlaps.EFFORT", 2 * edges**2)
    sentences = said(*({"position": [0, number / 10, 0]} for number in range(3)))
    assert len(sentences) == 3
    assert sentences[-1] == "1 more pairs of stones may overlap: they have too many edges to be looked at"

"""Taking back a removal, as far as the scene goes: what comes back, where, and by which name."""

from __future__ import annotations

import pytest

from culet.engine.session.removals import REMEMBERED, Removal, Removals, RemovedStone, removal_of, with_returned
from culet.errors import InputError, SceneError
from culet.scene import Scene
from culet.simulation.bodies import BodyState

SCENE = Scene.read(
    {
        "stones": [
            {"id": "ruby", "material": "ruby", "position": [0, 1, 0]},
            {"id": "glass", "material": "bk7", "position": [3, 1, 0]},
            {"id": "rutile", "material": "rutile", "position": [6, 1, 0], "mesh": "ab" * 16},
        ]
    }
)
MOVING = BodyState((3, 0.5, 0), (1, 0, 0, 0), (1, 2, 3), (4, 5, 6))


def without(*names: str, scene: Scene = SCENE) -> Scene:
    return scene.model_copy(update={"stones": tuple(stone for stone in scene.stones if stone.id not in names)})


@pytest.mark.parametrize("gone", [("ruby",), ("glass",), ("rutile",), ("ruby", "rutile"), ("ruby", "glass", "rutile")])
def test_what_was_removed_comes_back_to_its_place_with_all_its_settings(gone: tuple[str, ...]) -> None:
    left = without(*gone)
    scene, _ = with_returned(left, removal_of(SCENE, left, {}))
    assert scene == SCENE


def test_a_stone_comes_back_as_it_moved() -> None:
    left = without("glass")
    _, states = with_returned(left, removal_of(SCENE, left, {"glass": MOVING, "ruby": MOVING}))
    assert states == {"glass": MOVING}


def test_a_stone_whose_name_was_given_away_comes_back_by_another() -> None:
    left = without("glass")
    removal = removal_of(SCENE, left, {"glass": MOVING})
    other = SCENE.stones[1].model_copy(update={"material": "quartz"})
    taken = left.model_copy(update={"stones": (*left.stones, other)})
    scene, states = with_returned(taken, removal)
    assert [(stone.id, stone.material) for stone in scene.stones] == [
        ("ruby", "ruby"), ("glass-2", "bk7"), ("rutile", "rutile"), ("glass", "quartz"),
    ]  # fmt: skip
    assert list(states) == ["glass-2"]


def test_a_stone_does_not_come_back_among_too_many() -> None:
    left = without("glass")
    full = Scene.read({"stones": [{"position": [3 * number, 0, 0]} for number in range(64)]})
    with pytest.raises(SceneError, match="64"):
        with_returned(full, removal_of(SCENE, left, {}))


def test_the_last_removal_is_taken_back_first_and_none_twice() -> None:
    removals = Removals()
    for name in ("glass", "ruby"):
        removals.add(removal_of(SCENE, without(name), {}))
    assert [stone.settings.id for stone in removals.last.stones] == ["ruby"]
    removals.take_back()
    assert [stone.settings.id for stone in removals.last.stones] == ["glass"]
    removals.take_back()
    with pytest.raises(InputError, match="expected a removal to take back"):
        _ = removals.last


def test_an_event_that_removes_nothing_is_none_and_the_oldest_are_forgotten() -> None:
    removals = Removals()
    removals.add(removal_of(SCENE, SCENE, {}))
    assert len(removals) == 0
    for number in range(REMEMBERED + 5):
        removals.add(Removal((RemovedStone(number, SCENE.stones[0]),)))
    assert len(removals) == REMEMBERED
    assert removals.last.stones[0].place == REMEMBERED + 4


def test_meshes_of_stones_that_may_come_back_are_known() -> None:
    removals = Removals()
    removals.add(removal_of(SCENE, without("rutile", "ruby"), {}))
    assert removals.meshes() == {"ab" * 16}
    removals.clear()
    assert removals.meshes() == set()

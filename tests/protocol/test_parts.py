"""What changed in a scene, told and applied again."""

from __future__ import annotations

import copy
import json
import random
from typing import Any

import pytest

from culet_protocol.parts import changed_parts, with_parts

RUBY, GLASS = {"id": "ruby", "scale": 1}, {"id": "glass", "scale": 2}
SCENE: dict[str, Any] = {"version": 2, "camera": {"fov": 30}, "head": {"size": 1}, "stones": [RUBY, GLASS]}
CHANGES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "nothing": ({}, {}),
    "a part": ({"camera": {"fov": 20}}, {"camera": {"fov": 20}}),
    "a part that is none any more": ({"head": None}, {"head": None}),
    "one stone": ({"stones": [RUBY, GLASS | {"scale": 3}]}, {"stones.glass": GLASS | {"scale": 3}}),
    "a stone less": ({"stones": [GLASS]}, {"stones.ruby": None}),
    "a stone more": ({"stones": [RUBY, GLASS, {"id": "new"}]}, {"stones.new": {"id": "new"}}),
    "one for another": ({"stones": [GLASS, {"id": "new"}]}, {"stones.ruby": None, "stones.new": {"id": "new"}}),
    "no stones": ({"stones": []}, {"stones.ruby": None, "stones.glass": None}),
    "another order": ({"stones": [GLASS, RUBY]}, {"stones": [GLASS, RUBY]}),
    "a stone before the others": ({"stones": [{"id": "a"}, RUBY, GLASS]}, {"stones": [{"id": "a"}, RUBY, GLASS]}),
}


@pytest.mark.parametrize(("edit", "parts"), CHANGES.values(), ids=CHANGES.keys())
def test_a_change_is_told_by_the_parts_that_it_touched(edit: dict[str, Any], parts: dict[str, Any]) -> None:
    before, after = copy.deepcopy(SCENE), SCENE | edit
    assert changed_parts(before, after) == parts
    assert with_parts(before, parts) == after
    assert before == SCENE


def test_any_change_of_stones_is_understood_in_their_order() -> None:
    """Over random lists: some stones go, some change, some come, and now and then they change places."""
    chance = random.Random(11)  # noqa: S311 - a test's
    for _ in range(300):
        lists = [
            [{"id": name, "scale": chance.randrange(2)} for name in chance.sample("abcdef", chance.randrange(7))]
            for _ in range(2)
        ]
        before, after = ({"stones": stones} for stones in lists)
        assert with_parts(before, json.loads(json.dumps(changed_parts(before, after)))) == after


def test_what_did_not_change_is_the_same_object() -> None:
    after = with_parts(SCENE, {"stones.glass": {"id": "glass"}})
    assert after["camera"] is SCENE["camera"]
    assert after["stones"][0] is RUBY

"""Merge patches of a scene: the standard's examples, and what reaches a stone by its id."""

from __future__ import annotations

from typing import Any

import pytest

from culet.errors import SceneError
from culet.scene import Scene
from culet.scene.emitters import MOST_LAMPS, lamps
from culet.scene.patch import merge_patch, patched, read_patched, sharing

# RFC 7396, appendix A: every example.
EXAMPLES = [
    ({"a": "b"}, {"a": "c"}, {"a": "c"}),
    ({"a": "b"}, {"b": "c"}, {"a": "b", "b": "c"}),
    ({"a": "b"}, {"a": None}, {}),
    ({"a": "b", "b": "c"}, {"a": None}, {"b": "c"}),
    ({"a": ["b"]}, {"a": "c"}, {"a": "c"}),
    ({"a": "c"}, {"a": ["b"]}, {"a": ["b"]}),
    ({"a": {"b": "c"}}, {"a": {"b": "d", "c": None}}, {"a": {"b": "d"}}),
    ({"a": [{"b": "c"}]}, {"a": [1]}, {"a": [1]}),
    (["a", "b"], ["c", "d"], ["c", "d"]),
    ({"a": "b"}, ["c"], ["c"]),
    ({"a": "foo"}, None, None),
    ({"a": "foo"}, "bar", "bar"),
    ({"e": None}, {"a": 1}, {"e": None, "a": 1}),
    ([1, 2], {"a": "b", "c": None}, {"a": "b"}),
    ({}, {"a": {"bb": {"ccc": None}}}, {"a": {"bb": {}}}),
]


@pytest.mark.parametrize(("target", "patch", "expected"), EXAMPLES)
def test_the_examples_of_the_standard_hold(target: object, patch: object, expected: object) -> None:
    assert merge_patch(target, patch) == expected


def test_neither_argument_is_changed() -> None:
    target, patch = {"a": {"b": 1}}, {"a": {"c": 2, "b": None}}
    merge_patch(target, patch)
    assert (target, patch) == ({"a": {"b": 1}}, {"a": {"c": 2, "b": None}})


STUDIO = {"floor": {"kind": "none"}, "environment": {"kind": "studio", "ambient": [1]}}


@pytest.mark.parametrize(
    ("patch", "expected"),
    [
        ({"environment": {"kind": "light"}}, STUDIO | {"environment": {"kind": "light"}}),
        ({"environment": {"kind": "studio"}}, STUDIO),
        ({"environment": {"ambient": []}}, STUDIO | {"environment": {"kind": "studio", "ambient": []}}),
        ({"environment": {"kind": "half", "radiance": None}}, STUDIO | {"environment": {"kind": "half"}}),
    ],
)
def test_an_object_of_another_kind_takes_the_place_of_the_one_before(patch: object, expected: object) -> None:
    assert merge_patch(STUDIO, patch) == expected


THREE = Scene.read(
    {
        "stones": [
            {"id": "ruby", "material": "ruby", "position": [0, 0, 0]},
            {"id": "glass", "material": {"ior": [1.5, 1.5, 1.5]}, "position": [3, 0, 0]},
            {"id": "clear", "position": [6, 0, 0]},
        ]
    }
)
DOCUMENT = THREE.model_dump(mode="json")


def stones(patch: dict[str, Any]) -> dict[str, Any]:
    """By id, of the three after a patch."""
    return {stone.id: stone for stone in Scene.read(patched(DOCUMENT, {"stones": patch})).stones}


def test_a_patch_reaches_one_stone_by_its_id_and_leaves_the_others() -> None:
    after = stones({"ruby": {"material": "sapphire"}})
    assert list(after) == ["ruby", "glass", "clear"]
    assert after["ruby"] == THREE.stones[0].model_copy(update={"material": "sapphire"})
    assert (after["glass"], after["clear"]) == THREE.stones[1:]
    assert THREE.model_dump(mode="json") == DOCUMENT


def test_null_removes_a_stone() -> None:
    assert list(stones({"glass": None})) == ["ruby", "clear"]
    assert stones({"ruby": None, "glass": None, "clear": None}) == {}


def test_an_unknown_id_with_a_shape_adds_a_stone_after_the_others() -> None:
    after = stones({"new": {"cut": "brilliant", "scale": 0.5}, "ruby": {"scale": 2}})
    assert list(after) == ["ruby", "glass", "clear", "new"]
    assert (after["new"].scale, after["new"].material, after["ruby"].scale) == (0.5, "diamond", 2)
    assert stones({"m": {"mesh": "a1"}})["m"].mesh == "a1"


def test_a_list_takes_the_place_of_all_stones() -> None:
    after = Scene.read(patched(DOCUMENT, {"stones": [{"material": "quartz"}]})).stones
    assert [(stone.id, stone.material) for stone in after] == [("stone", "quartz")]


def test_null_for_all_stones_brings_the_default_one() -> None:
    assert Scene.read(patched(DOCUMENT, {"stones": None})).stones == Scene().stones


def test_a_material_of_another_form_is_not_mixed_with_the_one_before() -> None:
    after = stones({"glass": {"material": {"sellmeier": [[0.3306, 0.175], [4.3356, 0.106]]}}})
    assert after["glass"].material.sellmeier[0] == (0.3306, 0.175)


def test_null_gives_a_stone_the_default_of_a_field() -> None:
    heavy = patched(DOCUMENT, {"stones": {"ruby": {"mass": 7, "friction": 0.9}}})
    assert Scene.read(heavy).stones[0].mass == 7
    assert Scene.read(patched(heavy, {"stones": {"ruby": {"mass": None, "friction": None}}})).stones == THREE.stones


REFUSED = {
    "a stone that is not there": ({"rubi": {"material": "sapphire"}}, "stones.rubi", r"\(ruby, glass, clear\).*'rubi'"),
    "the removal of one that is not there": ({"rubi": None}, "stones.rubi", "expected the id of a stone"),
    "a shape that is null": ({"new": {"cut": None}}, "stones.new", "a new stone with its `cut` or `mesh`"),
    "a number": ({"ruby": 3}, "stones.ruby", "expected an object, or null; got 3"),
    "another id": ({"ruby": {"id": "red"}}, "stones.ruby.id", "cannot be changed; got 'red'"),
}


@pytest.mark.parametrize(("patch", "field", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_a_patch_that_reaches_no_stone_is_refused_by_name(patch: dict[str, Any], field: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as refusal:
        patched(DOCUMENT, {"stones": patch})
    assert refusal.value.field == field


def test_what_a_patch_makes_unusable_is_named_by_the_stones_id() -> None:
    with pytest.raises(SceneError, match=r"^stones\.glass\.scale: expected at most 100; got 1000000000\.0$") as refusal:
        read_patched(DOCUMENT, {"stones": {"glass": {"scale": 1e9}}})
    assert refusal.value.field == "stones.glass.scale"
    with pytest.raises(SceneError, match=r"^stones\.0\.scale: "):
        read_patched(DOCUMENT, {"stones": [{"scale": 0}]})
    with pytest.raises(SceneError, match=r"^camera\.fov_degrees: "):
        read_patched(DOCUMENT, {"stones": {"glass": {"scale": 2}}, "camera": {"fov_degrees": 0}})
    assert read_patched(DOCUMENT, {"stones": {"glass": {"scale": 2}}}).stones[1].scale == 2


def sky(document: dict[str, Any], **patch: Any) -> Scene:  # noqa: ANN401
    return Scene.read(patched(document, patch))


def test_another_sky_shows_no_lamps_but_those_that_the_patch_names() -> None:
    """A panorama has its own light; a studio that comes back has the atelier's; the bare skies only hide them."""
    default = Scene().model_dump(mode="json")
    image = sky(default, environment={"kind": "image"})
    assert image.emitters == ()
    assert sky(image.model_dump(mode="json"), environment={"kind": "studio"}).emitters == Scene().emitters
    own = sky(default, environment={"kind": "studio"}, emitters=default["emitters"][:2])
    light = sky(own.model_dump(mode="json"), environment={"kind": "light"})
    assert (light.emitters, light.shown_lamps) == (own.emitters, ())
    assert sky(light.model_dump(mode="json"), environment={"kind": "studio"}).shown_lamps == own.emitters
    sun = {"shape": "sun", "direction": [0, 1, 0], "colour": [1, 1, 1]}
    sunny = sky(default, environment={"kind": "gradient"}, emitters=[sun])
    assert [lamp.shape for lamp in sunny.shown_lamps] == ["sun"]


def test_point_lights_stay_under_any_sky() -> None:
    points = [{"shape": "point", "position": [0, 9, 0], "colour": [1, 1, 1]}]
    document = Scene(emitters=(*Scene().emitters[: MOST_LAMPS - 1],)).model_dump(mode="json")
    document["emitters"] += points
    for kind in ("constant", "dark", "image", "gradient"):
        scene = sky(document, environment={"kind": kind})
        assert len(scene.points) == 1
        assert bool(lamps(scene.emitters)) == (kind == "dark")


@pytest.mark.parametrize("patch", [{"radiance": [2, 2, 2]}, {"kind": "constant", "radiance": [2, 2, 2]}])
def test_a_sky_that_stays_of_its_kind_keeps_its_lamps(patch: dict[str, Any]) -> None:
    sun = {"shape": "sun", "direction": [0, 1, 0], "colour": [1, 1, 1]}
    sunny = Scene.read({"environment": {"kind": "constant"}, "emitters": [sun]})
    brighter = sky(sunny.model_dump(mode="json"), environment=patch)
    assert brighter.environment != sunny.environment
    assert brighter.emitters == sunny.emitters


def test_what_a_patch_leaves_as_it_was_is_kept_once() -> None:
    before = Scene.read({"stones": [{"id": "ruby"}, {"id": "glass", "position": [5, 0, 0]}]})
    patch = {"stones": {"ruby": {"scale": 2}}, "simulation": {"gravity": 1}}
    after = read_patched(before.model_dump(mode="json"), patch)
    shared = sharing(after, before)
    assert shared == after
    assert shared.stones[1] is before.stones[1]
    assert [name for name, value in shared if value is not getattr(before, name)] == ["stones", "simulation"]
    assert sharing(read_patched(before.model_dump(mode="json"), {}), before).stones is before.stones

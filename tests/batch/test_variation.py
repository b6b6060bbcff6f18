"""What a sweep varies: values from a text, and the scenes with them."""

from __future__ import annotations

import pytest

from culet.batch.variation import points_of, variation, varied
from culet.errors import SceneError
from culet.scene import Scene


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a=1:2:0.25", (1, 1.25, 1.5, 1.75, 2)),
        ("a=0:0.3:0.1", (0, 0.1, 0.2, 0.3)),  # though 3 x 0.1 is more than 0.3
        ("a=3:1:-1", (3, 2, 1)),
        ("a=1:1.9:0.5", (1, 1.5)),
        ("a=diamond,ruby", ("diamond", "ruby")),
        ("a=1, 2.5,null,true", (1, 2.5, None, True)),
    ],
)
def test_values_are_a_range_with_its_end_or_a_list(text: str, values: tuple[object, ...]) -> None:
    assert variation(text).values == values


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("crown", "expected FIELD=FROM:TO:STEP or FIELD=VALUE"),
        ("=1:2:1", "expected FIELD="),
        ("a=", "expected FIELD="),
        ("a=1:2", "expected three numbers"),
        ("a=1:2:x", "expected three numbers"),
        ("a=1:2:0", "a step other than 0"),
        ("a=1:inf:1", "expected finite numbers"),
        ("a=2:1:1", "expected 1 to 100000 values from FROM to TO; got 0"),
        ("a=0:1e9:1", "got 1000000001"),
        ("a=-1e308:1e308:1", "got inf"),
    ],
)
def test_a_text_that_says_no_values_is_refused(text: str, said: str) -> None:
    with pytest.raises(SceneError, match=said) as refused:
        variation(text)
    assert refused.value.field == "vary"


def test_what_is_no_number_of_json_is_a_word() -> None:
    assert variation("a=NaN,Infinity,1").values == ("NaN", "Infinity", 1), "a journal holds no NaN"


def test_all_combinations_are_points_the_last_field_changing_first() -> None:
    assert points_of([variation("a=1,2"), variation("b=x,y")]) == [(1, "x"), (1, "y"), (2, "x"), (2, "y")]
    with pytest.raises(SceneError, match="expected each field once, got a"):
        points_of([variation("a=1"), variation("a=2")])
    with pytest.raises(SceneError, match="at most 100000 points, got 1000000"):
        points_of([variation(f"{name}=1:100:1") for name in "abc"])


SCENE = Scene.read({"stones": [{"id": "ruby"}, {"id": "b", "cut": "oval", "position": [4, 0, 0]}]})


def test_a_field_is_of_the_scene_of_a_stone_by_its_id_or_of_the_first_stone() -> None:
    changes = {
        "camera.fov_degrees": 20, "stones.b.cut.length_to_width": 1.7, "cut.crown_degrees": 33, "material": "ruby",
        "stones.ruby.recut.crown_ratio": 1.1, "camera.position.1": 9,
    }  # fmt: skip
    scene = varied(SCENE, changes)
    first, second = scene.model_dump()["stones"]
    assert scene.camera.fov_degrees == 20
    assert scene.camera.position[1] == 9
    assert second["cut"]["length_to_width"] == 1.7
    assert (first["cut"]["crown_degrees"], first["cut"]["table_percent"], first["material"]) == (33, 53, "ruby")
    assert first["recut"]["crown_ratio"] == 1.1
    assert SCENE.stones[0].cut == "brilliant"


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("camera.fov", 20, "camera.fov: unknown field"),
        ("foo.bar", 1, "vary: foo.bar: the scene has no foo"),
        ("stones.c.scale", 1, "stones.c.scale: expected a number below 2 or an id, got 'c'"),
        ("camera.position.7", 1, "expected a number below 3"),
        ("millimetres.x", 1, "vary: millimetres.x: the scene has no millimetres"),
        ("scale", "large", "stones.0.scale: expected a number"),
    ],
)
def test_a_field_that_there_is_not_or_cannot_be_so_is_named(field: str, value: object, said: str) -> None:
    with pytest.raises(SceneError, match=said):
        varied(SCENE, {field: value})

import pytest

from culet.engine.session.merge_patch import merge_patch

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


STUDIO = {"floor": {"kind": "none"}, "environment": {"kind": "studio", "lamps": [1]}}


@pytest.mark.parametrize(
    ("patch", "expected"),
    [
        ({"environment": {"kind": "light"}}, STUDIO | {"environment": {"kind": "light"}}),
        ({"environment": {"kind": "studio"}}, STUDIO),
        ({"environment": {"lamps": []}}, STUDIO | {"environment": {"kind": "studio", "lamps": []}}),
        ({"environment": {"kind": "half", "radiance": None}}, STUDIO | {"environment": {"kind": "half"}}),
    ],
)
def test_an_object_of_another_kind_takes_the_place_of_the_one_before(patch: object, expected: object) -> None:
    assert merge_patch(STUDIO, patch) == expected

"""What a cache names a picture by."""

from __future__ import annotations

import pytest

from culet.gateway.answers import entity_tag as tags
from culet.gateway.answers.entity_tag import entity_tag, names
from culet.scene import Scene

RUBY = Scene.read({"stones": [{"material": "ruby"}]})


def test_a_tag_stands_for_the_scene_for_what_is_asked_and_for_the_version_that_draws_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = [entity_tag(Scene(), "64x36.png"), entity_tag(RUBY, "64x36.png"), entity_tag(Scene(), "64x36.webp")]
    assert entity_tag(Scene(), "64x36.png") == known[0]
    monkeypatch.setattr(tags, "__version__", "0.0.0")
    assert len({*known, entity_tag(Scene(), "64x36.png")}) == 4


@pytest.mark.parametrize(
    ("header", "named"),
    [
        (None, False),
        ("*", True),
        ('W/"a"', True),
        ('"a"', True),
        ('"b", W/"a"', True),
        ('W/"b"', False),
        ("a", False),
        ('"a', False),
    ],
)
def test_tags_are_compared_weakly(header: str | None, *, named: bool) -> None:
    assert names(header, 'W/"a"') is named

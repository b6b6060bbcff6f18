"""Cuts as a command line has them."""

from __future__ import annotations

import pytest

from culet.errors import SceneError
from culet.scene.cut_text import cut_from_text
from culet.scene.cuts import CUTS, TITLES, EmeraldCut, proportions, summary, usual_range


def test_a_text_names_a_cut_and_the_proportions_that_are_not_the_usual_ones() -> None:
    assert cut_from_text("emerald") == EmeraldCut()
    assert cut_from_text("emerald, length_to_width=1.6,crown_steps=2") == EmeraldCut(length_to_width=1.6, crown_steps=2)


@pytest.mark.parametrize(
    ("text", "field", "message"),
    [
        ("cabochon", "cut", "expected one of brilliant, .*, baguette; got 'cabochon'"),
        ("", "cut", "got ''"),
        ("oval,1.6", "cut", "expected proportion=number after oval, got '1.6'"),
        ("oval,length=1.6", "cut.length", "unknown field; did you mean `length_to_width`"),
        ("oval,length_to_width=0.5", "cut.length_to_width", "expected at least 1; got '0.5'"),
        ("oval,length_to_width=", "cut.length_to_width", "expected a number; got ''"),
        ("oval,length_to_width=nan", "cut.length_to_width", "finite number; got 'nan'"),
        ("princess,chevrons=2.5", "cut.chevrons", "whole number; got '2.5'"),
    ],
)
def test_what_is_no_cut_is_refused_with_its_proportion(text: str, field: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as refusal:
        cut_from_text(text)
    assert refusal.value.field == field


@pytest.mark.parametrize("name", CUTS)
def test_a_cut_is_told_by_name_and_its_usual_proportions_are_within_the_usual_ranges(name: str) -> None:
    cut = CUTS[name]()
    assert cut.name == name
    assert proportions(cut.name) == cut == proportions(cut)
    assert TITLES[name]
    assert summary(name).endswith(".")
    for proportion, value in cut.model_dump(exclude={"name"}).items():
        least, most = usual_range(cut, proportion)
        assert least <= value <= most

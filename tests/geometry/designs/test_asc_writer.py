"""Designs written as `.asc` and read back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.asc_writer import asc_of, planes_apart
from culet.geometry.designs.design import Design, Facet, FacetSide, Tier, Wheel, plane_of
from culet.geometry.designs.gem import read_gem
from geometry.designs.files import NAMES, design, gem_of

TEXT = ("Meet", "1,", "G", "n", "a", "12", "H", "F", "Fold", "girdle", "40.5°")
WORDS = some.lists(some.sampled_from(TEXT), max_size=30)
NUMBERS = some.floats(1e-3, 1, allow_subnormal=False)


@pytest.mark.parametrize("name", NAMES)
def test_a_design_is_read_back_equal(name: str) -> None:
    there = design(name)
    written, data, said = asc_of(there)
    back = read_asc(data)
    assert written is there
    assert said == []
    assert without_lines(back) == without_lines(there)


def without_lines(given: Design) -> Design:
    return replace(given, tiers=tuple(replace(tier, line=None) for tier in given.tiers))


@some.composite
def tiers(draw: some.DrawFn, wheel: Wheel) -> Tier:
    side: FacetSide = draw(some.sampled_from(["table", "crown", "girdle", "pavilion", "culet"]))
    match side:
        case "table" | "culet":
            angle = 0.0
        case "girdle":
            angle = 90.0
        case _:
            angle = draw(some.floats(0.01, 89.99))
    distance = draw(NUMBERS)
    count = 1 if angle == 0 else draw(some.integers(1, 12))
    first = draw(some.sampled_from(["", "G", "n", "1", "upper", "Ü"]))
    facets = []
    for place in range(count):
        index = draw(some.one_of(some.integers(1, 96).map(float), some.floats(-200, 200)))
        name = draw(some.sampled_from([first, "G", "7"])) if place and first else first
        facets.append(Facet(index, name, plane_of(side, angle, wheel.azimuth(index), distance)))
    return Tier(side, angle, distance, tuple(facets), " ".join(draw(WORDS)))


@some.composite
def designs(draw: some.DrawFn) -> Design:
    wheel = Wheel(draw(some.sampled_from([96, -96, 64, -77, 1])), draw(some.sampled_from([0.0, 48.0, 0.125])))
    title = " ".join(draw(WORDS))
    return Design(
        "asc", wheel, tuple(draw(some.lists(tiers(wheel), min_size=1, max_size=5))), draw(some.integers(1, 12)),
        draw(some.booleans()), draw(some.sampled_from([None, 1.54, 2.417])), (title, "second"), ("foot",),
    )  # fmt: skip


@settings(max_examples=50)
@given(designs())
def test_any_design_is_read_back_equal_to_the_last_bit(there: Design) -> None:
    """Names, notes and titles that look like records among them; lines stay short."""
    _, data, _ = asc_of(there)
    back = without_lines(read_asc(data))
    assert back.findings == ()
    assert back == there


def test_numbers_are_as_long_as_they_need_to_be() -> None:
    _, data, _ = asc_of(read_asc(b"g 96\na 41.5 0.612 3 9.25\na 0 0.123456789012 96\na 0 -1\n"))
    assert data.split(b"\r\n")[3:6] == [
        b"a 41.50000000 0.61200000 3 9.25", b"a 0.00000000 0.123456789012 96", b"a 0.00000000 -1.00000000 96",
    ]  # fmt: skip


def test_what_has_no_byte_in_windows_code_page_is_written_as_utf_8() -> None:
    _, data, _ = asc_of(read_asc("g 96\nH Звезда\na 0 1\na 0 -1\n".encode()))
    assert read_asc(data).title == "Звезда"


def test_an_origin_on_or_outside_a_facet_is_moved_inside_and_said() -> None:
    there = read_asc(b"g 96\na 0 2 n T\na -0.0 0 n C\na 90 1 24 n G 48 72 96\n")
    written, data, said = asc_of(there)
    assert said == ["The origin is moved by (0, 0, 1), since a facet of .asc cannot lie at it."]
    back = read_asc(data)
    assert planes_apart(written, back) < 1e-15
    assert back.planes()[:, 3] == pytest.approx(np.ones(6), abs=1e-15)
    assert [(tier.side, tier.name) for tier in back.tiers] == [("table", "T"), ("culet", "C"), ("girdle", "G")]


def test_facets_of_a_tier_that_lie_elsewhere_get_tiers_of_their_own() -> None:
    there = read_gem(gem_of(design("03_single_cut")))
    crown = there.tiers[1]
    x, y, z, d = crown.facets[0].plane
    lower = replace(crown.facets[0], plane=(x, y, z, d - 1e-3))
    odd = replace(there, tiers=(there.tiers[0], replace(crown, facets=(lower, *crown.facets[1:])), *there.tiers[2:]))
    _, data, _ = asc_of(odd)
    back = read_asc(data)
    assert [len(tier.facets) for tier in back.tiers] == [1, 7, 1, 8, 8]
    assert planes_apart(odd, back) < 1e-9

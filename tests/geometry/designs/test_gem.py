"""GemCad's binary: the design of its text, by planes alone, or refused by the byte."""

from __future__ import annotations

import struct
from dataclasses import replace

import pytest

from culet.errors import MeshError, TooLargeError
from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.asc_writer import asc_of, planes_apart
from culet.geometry.designs.gem import read_gem
from culet.geometry.designs.measures import proportions_of
from culet.geometry.designs.reader import read_design
from culet.geometry.designs.solid import Solid
from geometry.designs.files import NAMES, apart, design, gem_of


@pytest.mark.parametrize("name", NAMES)
def test_a_gem_has_the_planes_tiers_and_names_of_its_asc(name: str) -> None:
    text = design(name)
    binary = read_design(gem_of(text), "gem")
    assert apart(binary.planes(), text.planes()) < 1e-14  # measured 5e-16: n / d and back
    assert binary.findings == ()
    for one, other in zip(binary.tiers, text.tiers, strict=True):
        assert (one.side, one.notes) == (other.side, other.notes)
        assert (one.angle, one.distance) == pytest.approx((other.angle, other.distance), abs=1e-12)
        assert [facet.name for facet in one.facets] == [facet.name for facet in other.facets]
        if one.angle > 0:
            turned = [facet.index % abs(text.wheel.teeth) for facet in other.facets]
            assert [facet.index % abs(text.wheel.teeth) for facet in one.facets] == turned
    upright = [proportions_of(Solid(one)).girdle_percent for one in (binary, text)]
    assert upright[0] == (upright[1] if upright[1] is None else pytest.approx(upright[1], abs=1e-9))
    assert (binary.wheel, binary.fold, binary.mirror) == (text.wheel, text.fold, text.mirror)
    assert (binary.refractive_index, binary.title) == (text.refractive_index, text.title)


@pytest.mark.parametrize("name", ["02_round_tolkowsky", "06_oval_1.4", "13_chiral_negative_wheel"])
def test_a_gem_becomes_an_asc_of_whole_indices_and_the_same_planes(name: str) -> None:
    binary = read_gem(gem_of(design(name)))
    _, data, said = asc_of(binary)
    back = read_asc(data)
    assert said == []
    assert planes_apart(binary, back) < 1e-10  # measured 4e-16
    assert [len(tier.facets) for tier in back.tiers] == [len(tier.facets) for tier in binary.tiers]
    wanted = [facet.index % 96 for _, facet in design(name).facets() if facet.plane[2] not in (1, -1)]
    assert [facet.index % 96 for _, facet in back.facets() if facet.plane[2] not in (1, -1)] == wanted


def test_a_preform_and_stray_bytes_are_left_out_and_said() -> None:
    text = design("03_single_cut")
    found = read_gem(gem_of(text, preform=True) + b"more")
    assert apart(found.planes(), text.planes()) < 1e-14
    assert found.findings == (
        "The preform (25 facets) is left out: the stone is cut from it.",
        "4 bytes behind the footnotes left out.",
    )


def test_planes_decide_and_corners_elsewhere_are_said() -> None:
    """Some programs have written corners at n.v / d = 0.81."""
    text = design("03_single_cut")
    scaled = bytearray(gem_of(text))
    at = scaled.index(b"table\t") + len("table\t") + 4 + 16
    (z,) = struct.unpack_from("<d", scaled, at)
    struct.pack_into("<d", scaled, at, 0.81 * z)
    found = read_gem(bytes(scaled))
    assert apart(found.planes(), text.planes()) < 1e-14
    assert found.findings == ("Corners in the file lie up to 1.9e-01 off their facets; the facets' planes are taken.",)


def test_a_long_note_runs_over_the_footnotes() -> None:
    text = replace(design("03_single_cut"), footnotes=("one", "two", "three", "four"))
    assert read_gem(gem_of(text)).footnotes == text.footnotes


GOOD = gem_of(design("03_single_cut"))


@pytest.mark.parametrize("size", range(1, len(GOOD), 41))
def test_a_gem_that_is_cut_off_is_refused_at_its_end(size: int) -> None:
    with pytest.raises(MeshError, match=r"^\.gem: byte \d+: expected .*, got the end of the file"):
        read_design(GOOD[:size], "gem")


def changed(at: int, kind: str, value: float) -> bytes:
    data = bytearray(GOOD)
    struct.pack_into(kind, data, at % len(data), value)
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (changed(0, "<d", float("nan")), "byte 0: expected a facet's normal by its distance"),
        (changed(0, "<d", 1e300), "byte 0: expected a facet's normal by its distance"),
        (bytes(24) + GOOD[24:], "byte 0: expected a facet's normal by its distance"),
        (changed(35, "<i", 7), "byte 35: expected 1 before a corner or 0 behind the last, got 7"),
        (changed(GOOD.index(struct.pack("<d", -99999)) + 16, "<i", 0), "expected the teeth of an index wheel, 1 to"),
        (struct.pack("<d3idid8x", -99999, 1, 0, 96, 1.5, 32767, 0), "expected a design with facets, got none"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "byte 0: expected a facet's normal"),
    ],
)  # fmt: skip
def test_what_makes_no_gem_is_refused_by_its_byte(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=rf"^\.gem: .*{message}"):
        read_design(data, "gem")


def test_too_many_facets_are_refused() -> None:
    facet = struct.pack("<3diBi", 0.5, 0.5, 0.5, 1, 0, 0)
    with pytest.raises(TooLargeError, match="expected at most 2000 facets"):
        read_design(facet * 2001, "gem")


def test_an_index_of_refraction_that_is_none_is_left_out_and_said() -> None:
    at = GOOD.index(struct.pack("<d", -99999)) + 20
    found = read_gem(changed(at, "<d", 0.5))
    assert found.refractive_index is None
    assert found.findings == ("Expected a refractive index above 1, at most 10, got 0.5; left out.",)

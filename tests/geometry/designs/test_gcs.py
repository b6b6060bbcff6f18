"""Gem Cut Studio's XML: the design of GemCad's text, by normals, or refused by the line."""

from __future__ import annotations

import re

import pytest

from culet.errors import MeshError, TooLargeError
from culet.geometry.designs.asc_writer import asc_of
from culet.geometry.designs.gcs import read_gcs
from culet.geometry.designs.measures import proportions_of
from culet.geometry.designs.reader import read_design
from culet.geometry.designs.solid import Solid, shape_of_design
from geometry.designs.files import NAMES, apart, design, gcs_of

GOOD = gcs_of(design("03_single_cut"))


@pytest.mark.parametrize("name", NAMES)
def test_a_gcs_has_the_planes_tiers_and_names_of_its_asc(name: str) -> None:
    text = design(name)
    found = read_design(gcs_of(text), "gcs")
    assert apart(found.planes(), text.planes()) < 1e-12  # measured 3e-14, what the file's normals are off
    assert found.findings == ()
    for one, other in zip(found.tiers, text.tiers, strict=True):
        assert (one.side, one.name, one.notes) == (other.side, other.name, other.notes)
        assert one.angle == pytest.approx(other.angle, abs=1e-10)
    upright = [proportions_of(Solid(one)).girdle_percent for one in (found, text)]
    assert upright[0] == (upright[1] if upright[1] is None else pytest.approx(upright[1], abs=1e-9))
    assert (found.wheel.teeth, found.fold, found.mirror) == (abs(text.wheel.teeth), text.fold, True)
    assert (found.refractive_index, found.title) == (text.refractive_index, text.title)
    assert found.footnotes == ("cut & polish",)


def test_a_gcs_becomes_an_asc_of_whole_indices() -> None:
    _, data, said = asc_of(read_gcs(GOOD))
    assert said == []
    assert b"a -90.00000000 1.00000000 12 n girdle 24 36 48 60 72 84 96\r\n" in data


def test_hidden_tiers_and_bare_guides_are_not_cut_and_frost_is_said() -> None:
    data = gcs_of(design("03_single_cut"), {2: 'visible="false"', 3: 'frosting="0.5"', 4: 'guide="true"'})
    bare = re.sub(rb'(<tier [^>]*name="main".*?</tier>)', lambda tier: re.sub(rb"<vertex[^>]*>", b"", tier[0]), data,
                  flags=re.DOTALL)  # fmt: skip
    assert [tier.name for tier in read_gcs(data).tiers] == ["table", "girdle", "main"]
    found = read_gcs(bare)
    assert [tier.name for tier in found.tiers] == ["table", "girdle"]
    assert found.findings == (
        "Tier 2 (crown) is hidden; not cut.",
        "Tier 3 (girdle) is frosted; polished here.",
        "Tier 4 (main) is a guide without corners; not cut.",
    )


def test_normals_decide_not_labels_and_corners_not_a_wrong_depth() -> None:
    wanted = design("03_single_cut").planes()
    labels = re.sub(rb'index_angle="[^"]*"', b'index_angle="7"', GOOD)
    assert apart(read_gcs(labels).planes(), wanted) < 1e-12
    depths = read_gcs(re.sub(rb' depth="[^"]*"', b' depth="0.123"', GOOD))
    assert apart(depths.planes(), wanted) < 1e-12
    assert depths.findings == ("25 facets do not lie at their tier's depth; their corners are taken.",)
    without = re.sub(rb'n[xyz]="[^"]*" ?', b"", re.sub(rb' depth="[^"]*"', b"", GOOD))
    assert apart(read_gcs(without).planes(), wanted) < 1e-12


def test_a_file_that_was_edited_keeps_its_depths() -> None:
    """Its corners lie up to 1e-5 off the planes."""
    moved = re.sub(rb'(<vertex x=")(-?0\.\d{5})', rb"\g<1>\g<2>9", GOOD)
    found = read_gcs(moved)
    assert found.findings == ()
    assert apart(found.planes(), design("03_single_cut").planes()) < 1e-12


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "utf-16", "utf-8-sig"])
def test_the_declared_encoding_may_be_wrong(encoding: str) -> None:
    data = GOOD.decode().replace("cut &amp; polish", "40,5° &#xb0;").encode(encoding)
    assert read_gcs(data).footnotes == ("40,5° °",)


def test_what_is_not_understood_is_left_out_and_said() -> None:
    data = GOOD.replace(b"<render", b"<camera fov='3'><lens/></camera><render")
    assert read_gcs(data.replace(b'refractive_index="2.4175"', b'refractive_index="x"')).findings == (
        "Elements not understood and left out: camera, lens.",
        "Expected a refractive index above 1, at most 10, got 'x'; left out.",
    )


LINE = GOOD[: GOOD.index(b"<facet")].count(b"\n") + 1
"""Of the first facet."""


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"<html></html>", "line 1: expected the element GemCutStudio, got 'html'"),
        (b"GemCad 5.0\ng 96", "line 1, column 1: expected XML, got syntax error"),
        (GOOD[:-20], r"line \d+, column \d+: expected XML, got"),
        (GOOD.replace(b"<facet nx=", b"<facet nx='nan' q=", 1), rf"line {LINE}: expected nx, got 'nan'"),
        (GOOD.replace(b"<facet nx=", b"<facet q=", 1), rf"line {LINE}: expected nx, got ''"),
        (GOOD.replace(b"<vertex x=", b"<vertex x='1e300' q=", 1), rf"line {LINE + 1}: expected x from -1e\+09"),
        (GOOD.replace(b"<vertex ", b"<vertex><a ", 1), "expected a vertex with x, y and z"),
        (re.sub(rb'nx="[^"]*" ny="[^"]*" nz="[^"]*"', b'nx="0" ny="0" nz="0"', GOOD, count=1), "normal, got"),
        (GOOD.replace(b'gear="96"', b'gear="0"'), "expected a gear of a whole number of teeth, not 0"),
        (GOOD.replace(b'gear="96"', b'gear="9,6"'), "a decimal comma"),
        (re.sub(rb' depth="[^"]*"', b' depth="deep"', GOOD), r"Tier 1 \(table\): a depth, got 'deep'"),
        (re.sub(rb"<vertex[^>]*>| depth=\S*", b"", GOOD), "expected a depth or a facet's corners, got neither"),
        (b"<GemCutStudio/>", "expected a design with facets, got none"),
        (b"\0" * 50, "expected text, got a zero byte"),
    ],
)
def test_what_makes_no_gcs_is_refused_by_its_line(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=rf"^\.gcs: .*{message}"):
        read_design(data, "gcs")


BOMB = b'<!DOCTYPE GemCutStudio [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>\n'


@pytest.mark.parametrize("start", [BOMB, b'<!DOCTYPE GemCutStudio SYSTEM "file:///etc/passwd">'])
def test_a_document_type_is_refused_before_its_entities(start: bytes) -> None:
    with pytest.raises(MeshError, match=r"^\.gcs: line 1: expected XML without a document type"):
        read_design(start + b"<GemCutStudio><info title='&b;'/></GemCutStudio>", "gcs")


def test_too_deep_and_too_much_are_refused() -> None:
    with pytest.raises(TooLargeError, match="expected elements at most 16 deep"):
        read_design(b"<GemCutStudio>" + b"<a>" * 100_000, "gcs")
    facets = b"<facet nx='0' ny='0' nz='1'/>" * 2001
    with pytest.raises(TooLargeError, match="expected at most 2000 facets"):
        read_design(b"<GemCutStudio><tier depth='1'>" + facets, "gcs")


def test_a_gcs_is_the_stone_of_its_asc() -> None:
    one, other = shape_of_design(read_gcs(GOOD)), shape_of_design(design("03_single_cut"))
    assert abs(one.planes - other.planes).max() < 1e-12

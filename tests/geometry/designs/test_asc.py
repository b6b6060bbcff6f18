"""GemCad's text: what its records mean, in every dress that files have them in, and what is refused at which line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.errors import MeshError, TooLargeError
from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.design import Tier
from culet.geometry.designs.reader import read_design
from geometry.designs.files import apart, design, made

HEAD = "GemCad 5.0\ng 96 0.0\ny 8 y\nI 1.54\n"
CUBE = HEAD + "a 0 1 96 n T\na 90 1 24 n G 48 72 96 G Square\na -0.0 1 96 n C\nF end\n"


def tiers(*records: str) -> tuple[Tier, ...]:
    """Of a file with these records."""
    return read_asc((HEAD + "\n".join(records)).encode()).tiers


def test_a_facet_lies_at_its_angle_its_index_and_its_distance() -> None:
    """Index 0 toward +y, 24 of 96 clockwise from above toward +x: n = (sin a sin z, sin a cos z, +-cos a)."""
    (crown, pavilion) = tiers("a 30 0.5 24", "a -60 0.7 12")
    sine, cosine, half = 0.5, math.sqrt(3) / 2, math.sqrt(0.5)
    assert crown.facets[0].plane == pytest.approx((sine, 0, cosine, 0.5), abs=1e-15)
    assert pavilion.facets[0].plane == pytest.approx((cosine * half, cosine * half, -0.5, 0.7), abs=1e-15)
    assert (crown.side, crown.angle, pavilion.side, pavilion.angle) == ("crown", 30, "pavilion", 60)


@pytest.mark.parametrize(
    ("record", "side", "z"),
    [
        ("a 0 0.4 96", "table", 1),
        ("a 0.00 0.4", "table", 1),
        ("a 0 -0.4 96", "culet", -1),
        ("a -0.0 0.4 3 9", "culet", -1),
        ("a 90 0.4 96", "girdle", 0),
        ("a -90.000 0.4 96", "girdle", 0),
    ],
)
def test_level_and_upright_facets_are_told_apart_by_sign(record: str, side: str, z: int) -> None:
    (tier,) = tiers(record)
    assert tier.side == side
    assert len(tier.facets) == 1
    assert tier.facets[0].plane[2:] == (z, 0.4)


@pytest.mark.parametrize(
    "wheel", ["g 96 0.0", "g96 0.0", "96 0.0", "96", "g 64 3\ng 96 0", "g 96 96", "g -96 0.0\ng 96"]
)
def test_a_wheel_may_be_glued_bare_or_given_again(wheel: str) -> None:
    found = read_asc(f"{wheel}\na 30 0.5 24".encode())
    assert found.tiers[0].facets[0].plane == pytest.approx((0.5, 0, math.sqrt(0.75), 0.5), abs=1e-14)


def test_a_negative_wheel_counts_the_other_way_from_its_offset() -> None:
    found = read_asc(b"g -96 48\na 90 1 48 24 12")
    ways = [facet.plane[:2] for facet in found.tiers[0].facets]
    assert np.array(ways) == pytest.approx(np.array([(0, 1), (1, 0), (math.sqrt(0.5), -math.sqrt(0.5))]), abs=1e-15)


def test_a_design_of_a_chiral_wheel_is_not_its_mirror_image() -> None:
    """Its crown is turned by two teeth: read with the wheel's sign left out it is another stone."""
    signed = design("13_chiral_negative_wheel").planes()
    unsigned = read_asc(made("13_chiral_negative_wheel").replace(b"g -96", b"g 96")).planes()
    assert apart(signed, unsigned) > 0.05
    turns = [np.array([(c, s, 0, 0), (-s, c, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
             for c, s in ((math.cos(t), math.sin(t)) for t in np.arange(96) * 2 * math.pi / 96)]  # fmt: skip
    assert min(apart(signed, unsigned @ turn) for turn in turns) > 0.05


def test_the_same_stone_in_its_worst_dress_has_the_same_planes() -> None:
    quirks = design("14_quirks_of_02")
    assert apart(quirks.planes(), design("02_round_tolkowsky").planes()) < 2e-15  # measured 8e-16
    assert quirks.title == "Quirks: cut at 40.75\N{DEGREE SIGN}, wrapped, numeric names"
    assert quirks.findings == ()
    star = quirks.tiers[1]
    assert [facet.index for facet in star.facets] == [6, 18, -66, 42, 54, -30, 78, 90]
    assert [facet.name for facet in star.facets] == [*"111117", "1", "1"]
    assert star.notes == "Meet 1, 7"


@pytest.mark.parametrize(
    ("items", "names", "notes"),
    [
        ("24 n A 48", ["A", "A"], ""),
        ("24 48 n A", ["A", "A"], ""),
        ("24 n A 48 n B", ["A", "B"], ""),
        ("n A 24 48", ["A", "A"], ""),
        ("24 n G 48 G Meet G", ["G", "G"], "Meet G"),
        ("24 n 1 48 n 2 G to n 3 and 4", ["1", "2"], "to n 3 and 4"),
        ("24 48", ["", ""], ""),
        ("24\tn\tA\n 48", ["A", "A"], ""),
        ("24 n A\n48 G Meet\n 1, 2", ["A", "A"], "Meet 1, 2"),
        ("24\nn A 48\nG Level girdle\n a third line", ["A", "A"], "Level girdle a third line"),
        ("24 n A 48 n", ["A", "A"], ""),
    ],
)
def test_names_belong_to_the_index_before_them_and_notes_end_a_record(items: str, names: list[str], notes: str) -> None:
    (tier,) = tiers(f"a 30 0.5 {items}")
    assert [facet.name for facet in tier.facets] == names
    assert [facet.index for facet in tier.facets] == [24, 48]
    assert tier.notes == notes
    assert (tier.name, tier.line) == (names[0], 5)


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["ascii", "utf-8-sig", "utf-16", "utf-32"])
def test_lines_end_in_every_way_and_text_is_encoded_in_every_way(ending: str, encoding: str) -> None:
    found = read_asc(CUBE.replace("\n", ending).encode(encoding))
    assert found.planes().tolist() == read_asc(CUBE.encode()).planes().tolist()
    assert (len(found.tiers), found.fold, found.mirror, found.refractive_index) == (3, 8, True, 1.54)
    assert found.footnotes == ("end",)
    assert found.findings == ()


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
def test_a_degree_sign_may_be_one_byte_or_two(encoding: str) -> None:
    found = read_asc((HEAD + "H Pavillon 40,75°\na 0 1").encode(encoding) + b"\x1a")
    assert found.title == "Pavillon 40,75°"


def test_an_indented_record_is_a_record_and_an_indented_note_is_none() -> None:
    found = tiers("  a 30 0.5 24 G Cut", "  a girdle first", "  a 40 0.6 48", "  H Title")
    assert [(tier.angle, tier.notes) for tier in found] == [(30, "Cut a girdle first"), (40, "")]


def test_what_is_odd_is_taken_and_said_with_its_line() -> None:
    found = read_asc(b"g 96\ny many\nI nought\nwhat is this\na 30 -0.5 24 polish 48\na 40 0.6 n B\n?\nF f\n7 8\n")
    said = " ".join(found.findings)
    assert [len(tier.facets) for tier in found.tiers] == [2, 0]
    assert found.tiers[0].distance == 0.5
    assert (found.fold, found.refractive_index) == (1, None)
    for part in (
        "Line 2: expected a symmetry",
        "Line 3: expected a refractive index",
        "Line 4 and 2 more not understood and left out: 'what is this'",
        "Line 5: a sloping facet at the distance -0.5; taken as 0.5",
        "Line 5: expected an index, got 'polish'",
        "Line 6: a tier of 40 degrees without an index; it has no facets",
    ):
        assert part in said
    assert len(found.findings) == 6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("GemCad 5.0\na 30 0.5 24", "expected an index wheel, a line such as `g 96 0.0`, got none"),
        ("0.1 0.2 0.3\n0.4 0.5 0.6", "got none; line 1 is '0.1 0.2 0.3'"),
        ("g 0\n", "line 1: expected a whole number of teeth, not 0, got '0'"),
        ("g 96.5\n", "line 1: expected a whole number of teeth"),
        ("g 1e9\n", "line 1: expected the teeth of an index wheel from -3600 to 3600"),
        ("g\n", "line 1: expected the teeth of an index wheel, got nothing"),
        (HEAD + "a 30\n", "line 5: expected a tier's angle and distance, got '30'"),
        (HEAD + "\n\na 3o 0.5 24\n", "line 7: expected an angle in degrees, got '3o'"),
        (HEAD + "a 91 0.5 24\n", "line 5: expected an angle in degrees from -90 to 90, got '91'"),
        (HEAD + "a 41,5 0.5 24\n", "line 5: .*decimal point, got '41,5' with a decimal comma"),
        (HEAD + "a 30 nan 24\n", "line 5: expected a distance, got 'nan'"),
        (HEAD + "a 30 1e999 24\n", "line 5: expected a distance from -1e\\+09 to 1e\\+09, got '1e999'"),
        (HEAD + "a 30 1_0 24\n", "line 5: expected a distance, got '1_0'"),
        (HEAD + "a 30 0.5 24 1O\n", "line 5: expected an index, got '1O'"),
        (HEAD + "a 30 0.5 24\n 48 9e9\n", "line 5: expected an index from"),
        ("g 96\rH\0x", "line 2: expected text, got a zero byte"),
        ("", "the file is empty"),
        (HEAD, "expected a design with facets, got none"),
        ('{"stones": []}', "got none; line 1 is"),
    ],
)
def test_what_makes_no_design_is_refused_by_its_line(text: str, message: str) -> None:
    with pytest.raises(MeshError, match=rf"^\.asc: .*{message}" if not message.startswith("line") else message):
        read_design(text.encode(), "asc")


def test_a_wrong_mark_of_the_encoding_is_refused() -> None:
    with pytest.raises(MeshError, match="the byte order mark says UTF-8, but byte 7 is not"):
        read_asc(b"\xef\xbb\xbfg 96\xff")


def test_too_much_is_refused_before_it_is_built() -> None:
    with pytest.raises(TooLargeError, match=r"\.asc: line 5: expected at most 2000 facets, got 2001 or more"):
        read_design((HEAD + "a 30 0.5 " + "1 " * 2001).encode(), "asc")
    with pytest.raises(TooLargeError, match=r"\.asc: expected a design of at most 4194304 bytes, got 4194305"):
        read_design(b"g" * ((4 << 20) + 1), "asc")

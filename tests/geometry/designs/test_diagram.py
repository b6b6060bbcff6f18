"""Cutting diagrams: what each side shows, and the page."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.diagram import HEIGHT, WIDTH, diagram_of
from culet.geometry.designs.measures import outline_of
from culet.geometry.designs.solid import Solid
from culet.geometry.designs.views import ABOVE, BELOW, END, FRONT, ViewSide, faces_seen
from geometry.designs.files import NAMES, design

SVG = "{http://www.w3.org/2000/svg}"
SIDES = (ABOVE, BELOW, FRONT, END)


def area(corners: np.ndarray) -> float:
    """Of a polygon; positive if counter-clockwise."""
    x, y = corners.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


@pytest.mark.parametrize("side", SIDES, ids=lambda side: side.name)
@pytest.mark.parametrize("name", NAMES)
def test_the_faces_that_are_seen_cover_the_stones_outline_once(name: str, side: ViewSide) -> None:
    solid = Solid(design(name))
    outline = outline_of(solid.cut)
    faces = faces_seen(solid, outline, side)
    assert np.cross(side.right, side.up).tolist() == list(side.toward)
    hull = ConvexHull(outline.corners @ np.array([side.right, side.up]).T)
    areas = [area(face.corners) for face in faces]
    assert min(areas) > 0
    assert sum(areas) == pytest.approx(hull.volume, rel=1e-6)  # measured 2e-8: joined corners lie off planes


def test_what_is_up_and_what_is_right() -> None:
    """A box whose crown leans to index 24, the right from above and from the front, the left from below."""
    walls = "a 90 2 96 n N\na 90 1 24 n E 48 n S 72 n W\n"
    solid = Solid(read_asc(f"g 96\na 0 1 n T\n{walls}a 45 1.2 24 n R\na 0 -1 n B\n".encode()))
    outline = outline_of(solid.cut)
    seen = {side: {face.name: face for face in faces_seen(solid, outline, side)} for side in SIDES}
    assert {side: set(faces) for side, faces in seen.items()} == {
        ABOVE: {"T", "R"}, BELOW: {"B"}, FRONT: {"S"}, END: {"E", "R"},
    }  # fmt: skip
    assert seen[ABOVE]["R"].middle[0] > 0.5
    assert seen[ABOVE]["T"].middle[1] == pytest.approx(0.5)  # from -1 to 2, index 0 up
    assert seen[END]["R"].middle[1] > seen[END]["E"].middle[1]
    box = seen[FRONT]["S"].corners
    assert box[:, 0].max() == pytest.approx(1)
    right_of_top = box[np.isclose(box[:, 1], 1)][:, 0].max()
    assert right_of_top == pytest.approx(1.2 * math.sqrt(2) - 1)
    assert seen[BELOW]["B"].room == pytest.approx(1)


def parsed(name: str) -> ET.Element:
    return ET.fromstring(diagram_of(Solid(design(name))))  # noqa: S314 - our own


@pytest.mark.parametrize("name", NAMES)
def test_a_diagram_has_every_facet_tier_and_index_within_its_page(name: str) -> None:
    page, given = parsed(name), design(name)
    groups = {group.findtext(f"{SVG}desc"): group for group in page.iter(f"{SVG}g")}
    planes = given.planes()
    up, down = (len(groups[side].findall(f"{SVG}polygon")) for side in ("From above", "From below"))
    assert (up, down) == (int((planes[:, 2] > 0).sum()), int((planes[:, 2] < 0).sum()))
    width, height = (float(number) for number in page.attrib["viewBox"].split()[2:])
    assert width == WIDTH
    assert height >= HEIGHT
    for polygon in page.iter(f"{SVG}polygon"):
        points = np.array([[float(x) for x in pair.split(",")] for pair in polygon.attrib["points"].split()])
        assert points.min() > 0
        assert (points < (width, height)).all()
    for text in page.iter(f"{SVG}text"):
        assert 0 < float(text.attrib["x"]) < width
        assert 0 < float(text.attrib["y"]) < height
    words = " ".join(page.itertext()).split()
    for tier in given.tiers:
        assert tier.name[:18] in words or not tier.name
        if tier.angle > 0:
            assert all(f"{facet.index:g}" in words for facet in tier.facets)


def test_the_wheel_has_its_numbers_where_its_indices_lie() -> None:
    """From above index 24 is right of 96 on a wheel of 96, and right of 48 on one of -96 with the offset 48."""
    for name, up in (("02_round_tolkowsky", "96"), ("13_chiral_negative_wheel", "48")):
        labels = [text for text in parsed(name).findall(f"{SVG}text") if text.get("class") == "label"]
        places = {text.text: (float(text.attrib["x"]), float(text.attrib["y"])) for text in labels[: len(labels) // 2]}
        assert min(places, key=lambda number: places[number][1]) == up
        assert max(places, key=lambda number: places[number][0]) == "24"


@pytest.mark.parametrize("name", NAMES)
def test_the_two_wheels_lie_side_by_side(name: str) -> None:
    labels = [text for text in parsed(name).findall(f"{SVG}text") if text.get("class") == "label"]
    left, right = ([float(text.attrib["x"]) for text in half]
                   for half in (labels[: len(labels) // 2], labels[len(labels) // 2 :]))  # fmt: skip
    assert max(left) + 4 < min(right)


def test_a_long_table_makes_the_page_longer_and_the_print_stays_one_sheet() -> None:
    rows = [f"a {20 + k / 10} {1.5 + k / 100} {k + 1} n Z{k} G {'word ' * 30}" for k in range(90)]
    text = "\n".join(["g 96", "H <b> & more", "a 0 1", "a 0 -1", "a 90 1 24 48 72 96", *rows, "F " + "x" * 400])
    drawn = diagram_of(Solid(read_asc(text.encode())))
    page = ET.fromstring(drawn)  # noqa: S314 - our own
    assert float(page.attrib["viewBox"].split()[3]) > 2 * HEIGHT
    assert (page.attrib["width"], page.attrib["height"]) == ("210mm", "297mm")
    assert page.findtext(f"{SVG}title") == "<b> & more"
    assert max(len(found) for found in re.findall(r">([^<]+)</text>", drawn)) < 110


def test_a_design_without_words_is_drawn() -> None:
    bare = replace(design("11_briolette"), headings=(), refractive_index=None)
    assert "<title>Design</title>" in diagram_of(Solid(bare))

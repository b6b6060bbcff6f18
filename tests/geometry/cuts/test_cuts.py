"""Cuts against figures of an independent construction (check_values.json), and what all of them have in common."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from culet.errors import MeshError
from culet.geometry.brilliant import brilliant_planes
from culet.geometry.cuts.brilliants import brilliant_on
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cuts.outlines import ellipse
from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape
from culet.rendering.stones.facet_rows import facet_rows
from culet.scene.cuts import CUTS, AnyCut, BrilliantCut, EmeraldCut, HeartCut, OvalCut, TrillionCut, usual_range

CHECK_VALUES = json.loads(Path(__file__).with_name("check_values.json").read_text())
"""Of a program that was written without this one: half widths, z up; `normals_by_area` is the sum of area n_i^2."""
USUAL = {name: cut() for name, cut in CUTS.items()}
FACETS = {
    "brilliant": 73, "old-european": 74, "single": 25, "rose": 37, "portuguese": 161, "briolette": 108, "oval": 73,
    "cushion": 73, "pear": 64, "marquise": 91, "trillion": 55, "heart": 111, "princess": 45, "emerald": 57,
    "asscher": 57, "baguette": 25,
}  # fmt: skip


def areas(shape: Shape) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Of each facet, R^2."""
    a, b, c = (shape.vertices[shape.triangles[:, k]] for k in range(3))
    of_triangles = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return np.bincount(shape.facet_of_triangle, of_triangles, len(shape.planes)).astype(np.float64)


def euler(shape: Shape) -> int:
    """Of the triangles: 2 for a ball's surface. Each side has to be another triangle's, the other way round."""
    sides = [(int(t[k]), int(t[k - 2])) for t in shape.triangles for k in range(3)]
    assert len(set(sides)) == len(sides)
    assert {(b, a) for a, b in sides} == set(sides)
    return len(shape.vertices) - len(sides) // 2 + len(shape.triangles)


@pytest.mark.parametrize("known", CHECK_VALUES, ids=lambda known: f"{known['cut']} {known['proportions'] or ''}")
def test_a_cut_has_the_figures_of_an_independent_construction(known: dict[str, Any]) -> None:
    shape = shape_of_cut(CUTS[known["cut"]].model_validate(known["proportions"]))
    counts = len(shape.planes), len(shape.vertices), len(edges_of_facets(shape))
    assert counts == (known["facets"], known["corners"], known["edges"])
    length, height, width = np.ptp(shape.vertices, axis=0).tolist()
    radius = known["width"] / width
    assert np.array([length, height]) * radius == pytest.approx([known["length"], known["height"]], rel=1e-10, abs=0)
    assert shape.mass.volume * radius**3 == pytest.approx(known["volume"], rel=1e-10, abs=0)  # measured 3e-13
    own = areas(shape) * radius**2
    assert own.sum() == pytest.approx(known["surface"], rel=1e-10, abs=0)
    x, z, y = (own @ shape.planes[:, :3] ** 2).tolist()
    assert [x, y, z] == pytest.approx(known["normals_by_area"], rel=1e-10, abs=0)


def test_a_heart_has_the_volume_of_an_independent_construction() -> None:
    """1.400783607038813 where the heart is 1.98916063 wide and 1.81707735 long, stretched to 2 by 1.92."""
    shape = shape_of_cut(HeartCut())
    width, height, length = np.ptp(shape.vertices, axis=0).tolist()
    assert (length / width, height / width) == pytest.approx((0.96, 1.23737805 / 2), rel=1e-8, abs=0)
    volume = 1.400783607038813 * 2 * 1.92 / (1.98916063 * 1.81707735)
    assert shape.mass.volume * (2 / width) ** 3 == pytest.approx(volume, rel=1e-8, abs=0)


def test_the_brilliant_on_a_circle_is_the_round_brilliant() -> None:
    for cut in (BrilliantCut(), BrilliantCut(table_percent=61, star_percent=45, lower_half_percent=70)):
        general, closed = brilliant_on(ellipse(1), cut).intersection().planes, brilliant_planes(cut)
        closed = closed[:, [0, 2, 1, 3]] * [1, -1, 1, 1]
        assert KDTree(closed).query(general, p=np.inf)[0].max() < 1e-14  # measured 3e-15
        assert len(general) == len(closed)


@pytest.mark.parametrize("name", CUTS)
def test_a_cut_is_closed_has_its_facets_and_each_has_its_name_and_tier(name: str) -> None:
    shape = shape_of_cut(USUAL[name])
    assert euler(shape) == 2
    assert len(shape.planes) == len(shape.names) == FACETS[name]
    assert shape.findings == ()
    outside = shape.vertices @ shape.planes[:, :3].T - shape.planes[:, 3]
    assert (outside.max() < 1e-13) == shape.convex == (name != "heart")  # measured 2e-15; in the cleft 0.3
    assert areas(shape).min() > 1e-3 * areas(shape).max()
    tiers: dict[int, list[int]] = {}
    for facet, (tier, said) in enumerate(shape.names):
        assert said
        tiers.setdefault(tier, []).append(facet)
    assert sorted(tiers) == list(range(1, len(tiers) + 1))
    for members in tiers.values():
        assert len({shape.names[k].name for k in members}) == 1
        if shape.convex:
            assert np.ptp(shape.planes[members][:, [1, 3]], axis=0).max() < 1e-9


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("old-european", (9, 1, 0, 0, 2)),
        ("single", (3, 0, 0, 0, 1)),
        ("rose", (2, 4, 2, 0, 1)),
        ("portuguese", (20, 4, 0, 0, 1)),
        ("briolette", (13, 5, 0, 0, 0)),
        ("oval", (0, 16, 4, 0, 1)),
        ("cushion", (0, 16, 4, 0, 1)),
        ("pear", (0, 0, 8, 24, 4)),  # one mirror
        ("marquise", (0, 21, 4, 0, 1)),
        ("trillion", (0, 0, 6, 20, 5)),
        ("princess", (4, 4, 0, 0, 1)),
        ("emerald", (0, 7, 14, 0, 1)),
        ("asscher", (7, 7, 0, 0, 1)),
        ("baguette", (0, 0, 12, 0, 1)),
    ],
)
def test_the_symmetry_of_a_cut_is_found(name: str, kinds: tuple[int, ...]) -> None:
    """Rows of eights, fours, turned and mirrored twos, ones: what light is followed by."""
    assert tuple(np.diff([0, *facet_rows(shape_of_cut(USUAL[name])).ends]).tolist()) == kinds


@pytest.mark.parametrize("name", ["oval", "pear", "marquise", "emerald", "baguette", "heart"])
def test_length_to_width_is_that_of_the_stone(name: str) -> None:
    wide = np.ptp(shape_of_cut(CUTS[name].model_validate({"length_to_width": 1.05})).vertices, axis=0)
    length, width = (wide[2], wide[0]) if name == "heart" else (wide[0], wide[2])
    assert length / width == pytest.approx(1.05, rel=1e-12, abs=0)


@given(st.data())
@settings(max_examples=80)
def test_within_the_usual_ranges_there_is_a_cut_or_a_refusal_that_names_a_proportion(data: st.DataObject) -> None:
    kind = CUTS[data.draw(st.sampled_from(sorted(CUTS)))]
    usual = kind()
    said: dict[str, float] = {}
    for name in type(usual).model_fields:
        if name != "name":
            least, most = usual_range(usual, name)
            whole = isinstance(getattr(usual, name), int) and not isinstance(getattr(usual, name), bool)
            whole = whole and kind.model_fields[name].annotation is int
            said[name] = data.draw(st.integers(int(least), int(most)) if whole else st.floats(least, most))
    try:
        shape = shape_of_cut(kind.model_validate(said))
    except MeshError as refusal:
        assert refusal.field in said  # noqa: PT017 - either is right
        assert refusal.field in str(refusal)  # noqa: PT017
    else:
        assert shape.convex == (usual.name != "heart")
        assert euler(shape) == 2


def allowed_values(kind: type[AnyCut], name: str) -> st.SearchStrategy[float]:
    """All numbers that the schema lets through."""
    field = kind.model_fields[name]
    sides = ("gt", "ge", "lt", "le")
    said = {side: getattr(each, side) for each in field.metadata for side in sides if hasattr(each, side)}
    least, most = said.get("gt", said.get("ge")), said.get("lt", said.get("le"))
    assert least is not None
    assert most is not None
    if field.annotation is int:
        return st.integers(int(least) + ("gt" in said), int(most) - ("lt" in said))
    return st.floats(least, most, exclude_min="gt" in said, exclude_max="lt" in said)


@given(st.data())
@settings(max_examples=40)
def test_of_all_numbers_that_are_allowed_there_is_a_cut_or_a_refusal_that_names_a_proportion(
    data: st.DataObject,
) -> None:
    kind = CUTS[data.draw(st.sampled_from(sorted(CUTS)))]
    names = sorted(set(kind.model_fields) - {"name"})
    changed = data.draw(st.sets(st.sampled_from(names), min_size=1))
    said = {name: data.draw(allowed_values(kind, name)) for name in sorted(changed)}
    try:
        shape = shape_of_cut(kind.model_validate(said))
    except MeshError as refusal:
        assert refusal.field in names  # noqa: PT017 - either is right
        assert refusal.field in str(refusal)  # noqa: PT017
    else:
        assert shape.mass.volume > 0


@pytest.mark.parametrize(
    "cut",
    [HeartCut(lobe_percent=97), OvalCut(table_percent=5e-324), TrillionCut(bulge_percent=5e-324)],
    ids=lambda cut: cut.name,
)
def test_where_the_construction_has_no_answer_the_refusal_names_the_proportion(cut: AnyCut) -> None:
    (field,) = (name for name, value in cut if value != getattr(type(cut)(), name))
    with pytest.raises(MeshError, match=rf"{field} can be at (least|most) about") as refusal:
        shape_of_cut(cut)
    assert refusal.value.field == field


@pytest.mark.parametrize(
    ("cut", "field"),
    [
        (TrillionCut(table_percent=88), "table_percent"),
        (EmeraldCut(crown_steps=8), "crown_steps"),
        (EmeraldCut(pavilion_step_degrees=0), "pavilion_step_degrees"),
        (HeartCut(lobe_percent=51), "lobe_percent"),
        (HeartCut(lobe_percent=97), "lobe_percent"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.name,
)
def test_a_refusal_says_how_far_the_proportion_may_go(cut: AnyCut, field: str) -> None:
    with pytest.raises(MeshError, match=rf"{field} can be at (least|most) about") as refusal:
        shape_of_cut(cut)
    assert refusal.value.field == field
    limit, wanted = float(str(refusal.value).split("about ")[1].split(",")[0]), getattr(cut, field)
    if isinstance(wanted, int) and type(cut).model_fields[field].annotation is int:
        within, beyond = int(limit), int(limit) + (1 if wanted > limit else -1)
    else:
        usual = getattr(type(cut)(), field)
        within, beyond = limit + 0.01 * (usual - limit), limit + 0.01 * (wanted - usual)
        beyond = max(beyond, wanted) if wanted < usual else min(beyond, wanted)
    shape_of_cut(cut.model_copy(update={field: within}))
    with pytest.raises(MeshError):
        shape_of_cut(cut.model_copy(update={field: beyond}))


def test_where_two_proportions_are_wrong_the_refusal_names_both() -> None:
    with pytest.raises(MeshError, match=r"would be one with crown_steps 3 \(got 8\), pavilion_steps 3 \(got 8\)"):
        shape_of_cut(EmeraldCut(crown_steps=8, pavilion_steps=8, pavilion_step_degrees=12))

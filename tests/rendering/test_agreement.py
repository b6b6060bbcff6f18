"""One kernel text in eight shapes: packets of 1, 4, 8 and 16 lanes, in single and in double precision.

They agree to rounding but where rounding is decisive: a ray meets an edge of the stone or of the checker and takes the
other side, or leaves the stone at the critical angle, where the slope of the reflectance is infinite. Those pixels are
counted, and bounded by number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from conftest import RendererOf
from culet.rendering.features import Features, Geometry
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.legacy import legacy
from pictures import compared
from rendering.views import BARE, radiance, take


@dataclass(frozen=True)
class Case:
    scene: dict[str, Any]
    decided: float
    """Largest part of the pixels where rounding may decide, some three times what was measured."""


CASES = {
    "default": Case({}, decided=0.008),  # measured 0.0026
    "checker with shadows": Case({"floor": {"kind": "matte"}}, decided=0.006),  # 0.0022
    "sky only": Case(
        {**BARE, "environment": {"kind": "gradient"}, "optics": {"cutoff": 1e-3}}, decided=0.002
    ),  # 5.6e-4
    "mirrors and absorption": Case(  # 0.0090; the classic stone shows more lamps in fewer pixels
        {"walls": {"kind": "mirror"}, "stones": [{"material": "classic", "absorption": [0.02, 0.3, 1]}]}, decided=0.025
    ),
    "one index, inside": Case(  # 0.0065
        {
            "stones": [{"material": {"ior": [2.4, 2.4, 2.4]}, "position": [0, 0, 0]}],
            "camera": {"position": [0.1, 0, 0.1], "target": [0, 0, -1], "fov_degrees": 90},
        },
        decided=0.02,
    ),
}
CASE = pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
SIZE = 160, 90
GENERAL = Features()
"""One program for all cases, which holds every kind of scene."""
SHAPES = Geometry.HULL, Geometry.MESH
ROUNDING = 1e-4
"""Radiance; lamps have up to 11, and their soft edges make ten of an error of one."""


def general(renderer: Renderer, case: Case) -> DevicePicture:
    return take(renderer, legacy(case.scene), size=SIZE, features=GENERAL)


@pytest.mark.validation  # by which others are judged, in four lanes
@CASE
@pytest.mark.parametrize("lanes", [1, 4, 8])
def test_every_width_of_packet_gives_the_same_picture_in_double_precision(
    renderer_of: RendererOf, case: Case, lanes: int
) -> None:
    """The same operations on the same numbers; only the order in which a pixel's light is summed differs."""
    wide, narrow = (radiance(general(renderer_of(n, np.float64), case)) for n in (16, lanes))
    with compared(narrow, wide):
        assert narrow == pytest.approx(wide, abs=4e-15)  # measured 8.9e-16


@CASE
@pytest.mark.parametrize("lanes", [1, 4, 8])
def test_every_width_of_packet_gives_the_same_picture_in_single_precision(
    renderer_of: RendererOf, case: Case, lanes: int
) -> None:
    """The compiler may round one width otherwise than another: it decided 2 pixels of 14,400 differently."""
    wide, narrow = (radiance(general(renderer_of(n, np.float32), case)) for n in (16, lanes))
    difference = abs(narrow - wide).max(axis=-1)
    with compared(narrow, wide):
        assert (difference > 1e-6).sum() <= 6
        assert np.median(difference) < 1e-7  # measured 1.5e-8


@CASE
def test_single_precision_agrees_with_double_but_where_rounding_decides(
    renderer: Renderer, exact: Renderer, case: Case
) -> None:
    single, double = (general(r, case) for r in (renderer, exact))
    difference = radiance(single) - radiance(double)
    decided = abs(difference).max(axis=-1) > ROUNDING
    with compared(radiance(single), radiance(double)):
        assert decided.mean() < case.decided
        assert np.median(abs(difference)) < 1e-7  # measured 4.6e-8
        assert abs(difference[~decided].mean()) < 5e-7  # measured 1.5e-7
        assert abs(difference.mean()) < 2e-4  # measured 6.2e-5: one pixel that a lamp lights or not
    # measured 8.0e-4: one pixel whose chain goes on to its 64th bounce instead of its 5th is 5e-4
    assert single.segments() == pytest.approx(double.segments(), rel=2e-3)


def test_where_rounding_decides_it_is_as_likely_brighter_as_darker(renderer: Renderer, exact: Renderer) -> None:
    """64 samples of a small picture: enough rays near edges to see a bias, if there were one."""
    scene = legacy(CASES["sky only"].scene)
    difference = radiance(take(renderer, scene, samples=64)) - radiance(take(exact, scene, samples=64))
    brighter, darker = (difference > 2e-6).sum(), (difference < -2e-6).sum()
    assert brighter + darker > 50  # measured 37 + 43 = 80
    assert abs(int(brighter) - int(darker)) < 4 * np.sqrt(brighter + darker)  # standard deviations of a fair coin
    assert abs(difference.mean()) < 1e-6  # measured 1.8e-7


@CASE
def test_half_spaces_and_triangles_are_the_same_stone(renderer: Renderer, exact: Renderer, case: Case) -> None:
    """The convex stone as the intersection of its facets, and as triangles in a tree."""
    for used, tolerance, decided, rel in ((exact, 1e-9, 0, 0), (renderer, ROUNDING, case.decided, 4e-3)):
        hull, mesh = (take(used, legacy(case.scene), size=SIZE, features=Features(kind)) for kind in SHAPES)
        difference = radiance(mesh) - radiance(hull)
        # measured 0 in double precision; 50, 45, 8, 48 and 97 of 14,400 in single
        with compared(radiance(mesh), radiance(hull)):
            assert (abs(difference).max(axis=-1) > tolerance).mean() <= decided
            assert abs(difference.mean()) < 2e-4  # measured 5.7e-5
        assert mesh.segments() == pytest.approx(hull.segments(), rel=rel)  # measured 1.2e-3

"""Under a uniform sky of radiance 1 a clear stone cannot be seen: what is missing was cut, and is counted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from pictures import compared
from rendering.views import BARE, UPRIGHT, radiance, take, without_stone
from shared.stones import prism

FURNACE: dict[str, Any] = {**BARE, "environment": {"kind": "constant"}}
VIEWS: dict[str, dict[str, Any]] = {
    "default": {},
    "into the table": {"stones": [UPRIGHT], "camera": {"position": [0, 4, 0.01], "target": [0, 0, 0]}},
    "up into the culet": {"stones": [UPRIGHT], "camera": {"position": [0.3, -4, 0], "target": [0, 0, 0]}},
    "along the girdle": {"stones": [UPRIGHT], "camera": {"position": [3, 0.1, 0], "target": [0, 0.1, 0]}},
    "inside": {
        "stones": [UPRIGHT],
        "camera": {"position": [0.1, 0.05, 0.05], "target": [1, 0, 0.3], "fov_degrees": 120},
    },
    "one index": {"stones": [{"material": {"ior": [2.4, 2.4, 2.4]}}]},
    "schlick": {"optics": {"fresnel": "schlick"}},
    "four bounces": {"optics": {"max_bounces": 4}},
    "coarse": {"optics": {"cutoff": 0.3}},
    "fine": {"optics": {"cutoff": 1e-6, "max_bounces": 65536}},
}


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS.keys())
def test_all_light_is_seen_or_counted_as_cut(renderer: Renderer, exact: Renderer, view: dict[str, Any]) -> None:
    """R + T + lost = 1 for every pixel: the mean of the channels and the weight cut from them."""
    for used, tolerance in ((renderer, 5e-7), (exact, 2e-15)):  # measured 2.0e-7, one index; 4.4e-16
        picture = take(used, legacy({**FURNACE, **view}))
        seen, cut = radiance(picture), picture.cut_map().astype(float)
        assert seen.max() <= 1 + tolerance
        assert cut.min() >= 0
        with compared(seen.mean(axis=-1) + cut, 1):
            assert seen.mean(axis=-1) + cut == pytest.approx(1, abs=tolerance)
        assert (cut > 0).mean() > 0.1  # the stone is in the picture


def test_a_finer_cut_off_misses_less(renderer: Renderer) -> None:
    """The mean that is missing falls about as the cut-off does, and its bound with it."""
    missing = [take(renderer, legacy({**FURNACE, "optics": {"cutoff": c}})).cut() for c in (1e-1, 1e-2, 1e-3, 1e-4)]
    ratios = np.divide(missing[:-1], missing[1:])
    assert ratios.min() > 5
    assert missing[-1] < 1e-5


def test_a_coloured_furnace_keeps_its_colour(exact: Renderer) -> None:
    colour = [0.2, 0.5, 3]
    scene = {
        **FURNACE,
        "environment": {"kind": "constant", "radiance": colour},
        "optics": {"cutoff": 1e-9, "max_bounces": 65536},
    }
    # measured 3.0e-9, the cut-off
    assert radiance(take(exact, legacy(scene))) == pytest.approx(np.broadcast_to(colour, (54, 96, 3)), abs=1e-8)


def test_a_stone_of_plain_facets_is_no_more_visible_than_a_brilliant(renderer: Renderer) -> None:
    """In a regular prism chains meet the same few angles again and again; many are totally reflected for long."""
    picture = take(renderer, legacy({**FURNACE, "stones": [{"orientation": [0.9, 0.1, 0.4, 0.2]}]}), prism(60))
    assert radiance(picture).mean(axis=-1) + picture.cut_map() == pytest.approx(1, abs=3e-7)  # measured 7.4e-8


INDEX_ONE = {"material": {"ior": [1, 1, 1]}}
ROOMS: dict[str, dict[str, Any]] = {
    "sky": {"floor": {"kind": "none"}},
    "mirror": {"floor": {"kind": "mirror"}},
    "checker": {"floor": {"kind": "matte"}},
    "mirrors all round": {"floor": {"kind": "mirror"}, "walls": {"kind": "mirror"}},
}


@pytest.mark.parametrize("room", ROOMS.values(), ids=ROOMS.keys())
def test_a_stone_of_index_one_cannot_be_seen(exact: Renderer, room: dict[str, Any]) -> None:
    """Without lights, for it would still cast its shadow."""
    scene = legacy({"stones": [INDEX_ONE], "emitters": [], "environment": {"kind": "gradient"}, **room})
    difference = abs(radiance(take(exact, scene)) - radiance(take(exact, without_stone(scene)))).max(axis=-1)
    assert (difference > 1e-12).sum() == 0

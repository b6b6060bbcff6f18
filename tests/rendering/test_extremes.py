"""Views, materials and settings at the ends of what a scene allows: finite, never negative, nothing out of nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from pictures import compared
from rendering.views import BARE, UPRIGHT, radiance, take
from shared.extremes import GLOW, SCENES, THIN_STONES, looking

SIZE = 64, 36
EVEN: dict[str, Any] = {"environment": {"kind": "gradient", "bottom": [1, 1, 1], "top": [1, 1, 1]}, "emitters": []}
"""As `GLOW`, in the same programs as the gradient that shows which way light came."""


@pytest.mark.parametrize("extreme", SCENES.values(), ids=SCENES.keys())
def test_no_light_comes_out_of_nothing(renderer: Renderer, exact: Renderer, extreme: dict[str, Any]) -> None:
    """Between 0 and 1 under a sky of 1, whatever the view; finite in both precisions."""
    for used, tolerance in ((renderer, 2e-7), (exact, 5e-16)):  # measured 0 and 0
        picture = take(used, legacy({**EVEN, **extreme}), size=SIZE)
        pixels, cut = radiance(picture), picture.cut_map()
        assert np.isfinite(pixels).all()
        assert np.isfinite(cut).all()
        assert pixels.min() >= 0
        assert cut.min() >= 0
        assert pixels.max() <= 1 + tolerance


@pytest.mark.parametrize("extreme", SCENES.values(), ids=SCENES.keys())
def test_single_precision_sees_what_double_sees(renderer: Renderer, exact: Renderer, extreme: dict[str, Any]) -> None:
    """On the whole: the mean under a gradient, where a wrong facet shows."""
    scene = legacy({**extreme, "emitters": [], "environment": {"kind": "gradient"}})
    single, double = (radiance(take(used, scene, size=SIZE)).mean() for used in (renderer, exact))
    # Measured 1.8e-3, the cells of a floor 1e8 R away, which the sky lights; 7e-5 the others.
    assert single == pytest.approx(double, abs=2.5e-3 if extreme is SCENES["stone far away"] else 1e-3)


@pytest.mark.parametrize("camera", [{}, {"position": [0, 0.5, 0], "target": [1, 0, 0]}], ids=["outside", "inside"])
def test_the_reports_estimator_is_finite_though_it_makes_light(renderer: Renderer, camera: dict[str, Any]) -> None:
    """Each total reflection inside adds the sky once more without taking anything away: by design, as published. Under
    a sky of 1 its 12 meetings may show up to 12; measured 4.4."""
    optics = {"estimator": "classic", "fresnel": "schlick", "max_bounces": 12}
    pixels = radiance(take(renderer, legacy({**GLOW, "camera": camera, "optics": optics}), size=SIZE))
    assert np.isfinite(pixels).all()
    assert pixels.min() >= 0
    assert 1 < pixels.max() <= 12


def test_a_stone_looks_the_same_from_far_and_from_farther(exact: Renderer, renderer: Renderer) -> None:
    """At 4e4 and 1.2e5 radii the perspective is gone: a third of the angle from three times as far is the same view."""
    far, farther = (
        legacy({**BARE, "environment": {"kind": "gradient"}, "stones": [{"position": [0, 0, 0]}],
                    "optics": {"cutoff": 1e-3}, **looking([0, 3 * d, 4 * d], [0, 0, 0], fov_degrees=angle)})
        for d, angle in ((8e3, 0.003), (2.4e4, 0.001))
    )  # fmt: skip
    for used in (exact, renderer):
        near, away = radiance(take(used, far)), radiance(take(used, farther))
        assert np.ptp(near) > 0.3  # the stone is in view
        with compared(near, away):
            assert (abs(near - away).max(axis=-1) > 1e-3).mean() < 0.02  # measured 0.0095
    assert (
        abs(radiance(take(renderer, farther)) - radiance(take(exact, farther))).max(axis=-1) > 1e-3
    ).mean() < 0.001  # measured 1.9e-4


@pytest.mark.parametrize("stone", THIN_STONES.values(), ids=THIN_STONES.keys())
def test_thin_stones_lose_and_gain_no_light(renderer: Renderer, exact: Renderer, stone: Shape) -> None:
    """The furnace on shapes of 1000 : 1 and more: all light is seen or counted."""
    camera = looking([0.8, 1.5, 2.5], [0, 0, 0], fov_degrees=40)
    for used, tolerance in ((renderer, 3e-7), (exact, 1e-15)):  # measured 9.4e-8 and 2.3e-16
        for turned in ([1, 0, 0, 0], [0.9, 0.1, -0.3, 0.2]):
            scene = legacy({**BARE, **GLOW, "stones": [{**UPRIGHT, "orientation": turned}], **camera})
            picture = take(used, scene, stone)
            assert picture.segments() > 0
            assert radiance(picture).mean(axis=-1) + picture.cut_map() == pytest.approx(1, abs=tolerance)


def test_a_picture_of_many_samples_stays_finite(renderer: Renderer) -> None:
    """Sums of bright light in single precision, at the largest radiance that a scene allows."""
    sky = {"kind": "constant", "radiance": [1e6, 1e6, 1e6]}
    picture = take(renderer, legacy({**BARE, "environment": sky}), size=(16, 9), samples=256)
    pixels = radiance(picture)
    assert pixels.mean(axis=-1) / 1e6 + picture.cut_map() == pytest.approx(1, abs=1e-6)  # measured 2.7e-7
    assert (picture.rgb() >= 254).all()

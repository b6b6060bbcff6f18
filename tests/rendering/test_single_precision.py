"""Single precision against double: where pixels differ, the picture is steep, and it is brighter as often as darker."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from culet.study.renderer.precision import FARTHER, PERTURBATION, SCENES, SIZE, is_step, judge

MOST = {
    "legacy default": (0.002, 0.02),  # measured 0.00155, 0.016
    "matte floor, lights": (0.002, 0.02),  # 0.00142, 0.014
    "matte floor, no lights": (0.002, 0.02),  # 0.00141, 0.013
    "stone alone, gradient": (0.0003, 0.006),  # 0.00012, 0.005
    "stone alone, half": (0.0003, 0.006),  # 0.00012, 0.005
    "mirrors all around, absorption": (0.005, 0.11),  # 0.0032, 0.092
    "from inside": (0.005, 0.09),  # 0.0029, 0.083
}
"""Parts of the pixels that may differ by more than 1e-4, and that shaking everything may move by as much. What explains
the former would explain few others: pixels that differ are not found by shaking everything."""


def assert_explained(renderer: Renderer, exact: Renderer, name: str, size: tuple[int, int]) -> None:
    found = judge(renderer, exact, legacy(SCENES[name]), size, FARTHER.get(name, PERTURBATION))
    most_decided, most_moved = MOST[name]
    assert 0 < found.decided < most_decided * found.pixels
    assert found.unexplained == 0, found
    assert abs(found.mean) < 3 * found.sigma  # measured 1.7 at most
    assert found.moved < most_moved


def test_every_pixel_that_differs_is_where_the_picture_is_steep(renderer: Renderer, exact: Renderer) -> None:
    assert_explained(renderer, exact, "legacy default", (160, 90))


LIKE_OTHERS = "legacy default", "matte floor, no lights", "stone alone, gradient"
"""What they show, smaller pictures or scenes with more in them show too."""


@pytest.mark.validation
@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.soak] * (n in LIKE_OTHERS)) for n in SCENES])
def test_every_pixel_that_differs_at_full_size_is_where_the_picture_is_steep(
    renderer: Renderer, exact: Renderer, name: str
) -> None:
    assert_explained(renderer, exact, name, SIZE)


def test_steps_are_told_from_slopes() -> None:
    """A step, a straight slope, and the root that the transmittance is about the critical angle."""
    place = np.random.default_rng(0).uniform(-1, 1, 33)
    values = np.stack([place > 0.3, place, np.sqrt(np.maximum(place, 0))], axis=1)
    assert is_step(np.repeat(values[..., None], 3, axis=2).astype(float)).tolist() == [True, False, False]


def test_the_page_shows_every_scene() -> None:
    page = (Path(__file__).parents[2] / "docs" / "explanation" / "accuracy.md").read_text(encoding="utf-8")
    for name in SCENES:
        assert f"| {name} |" in page

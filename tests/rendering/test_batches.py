"""Samples that are drawn together are those that are drawn one by one, in other packets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from conftest import RendererOf
from culet.rendering.features import features_of
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.rendering.pace import KernelPace
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.legacy import legacy
from culet.scene.model import Scene
from culet.stage import Stage
from pictures import compared
from rendering.views import BARE, radiance

SIZE = 53, 27
"""Of single samples two tiles, of batches up to 45, of which some are not full."""
SAMPLES = 32
"""Of which the later half may be drawn together."""
LEVELS = pytest.mark.parametrize("level", [1, 2])

KINDS: dict[str, dict[str, Any]] = {
    "default": {},
    "mirrors, absorption": {
        "walls": {"kind": "mirror"}, "floor": {"kind": "mirror"}, "stones": [{"absorption": [0.1, 0.3, 0.2]}],
    },
    "wavelengths": {"optics": {"bands": 8}, "stones": [{"absorption": [0.1, 0.3, 0.2]}]},
    "classic": {"optics": {"estimator": "classic"}},
    "inside": {"camera": {"position": [0, 0.3, 0.2], "target": [0, 0, 0]}},
    "empty": {"stones": []},
    "a tent, a studio floor, a backdrop": {
        "sampling": {"filter": "tent"}, "floor": {"kind": "studio"}, "backdrop": {"kind": "gradient"},
    },
    "two materials, wavelengths": {
        "optics": {"bands": 6, "cutoff": 1e-5},
        "stones": [
            {"id": "a", "position": [-1.2, 0.5, 0], "absorption": [0.1, 0.3, 0.2]},
            {"id": "b", "position": [1.2, 0.5, 0], "scale": 0.8, "material": "sapphire"},
        ],
    },
}  # fmt: skip

BY_ORDER = {"two materials, wavelengths": 2e-6}
"""What differs where light comes back to stones, since a pixel that has lost more cuts later: measured 3.7e-7."""


def drawn(
    renderer: Renderer, scene: Scene, *levels: int, size: tuple[int, int] = SIZE, special: bool = False
) -> tuple[DevicePicture, list[int]]:
    """A picture that may be drawn in batches of these levels, and how many samples there were each time. `special`: by
    the program that has what the scene needs alone."""
    stage = Stage.of(scene)
    picture = renderer.picture(stage, *size, effort=None, features=features_of(stage) if special else None)
    counts = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("culet.rendering.renderer.LEVELS", levels)
        while picture.samples < SAMPLES:
            for _ in picture.refine_until(Target(SAMPLES), math.inf, pause=lambda: True):
                pass
            counts.append(picture.samples)
    return picture, counts


@LEVELS
@pytest.mark.parametrize("kind", KINDS)
def test_they_have_the_same_light(exact: Renderer, kind: str, level: int) -> None:
    scene, most = legacy(KINDS[kind]), BY_ORDER.get(kind, 1e-12)
    (alone, one_by_one), (together, counts) = drawn(exact, scene), drawn(exact, scene, level)
    assert one_by_one == list(range(1, SAMPLES + 1))
    assert counts == {1: [1, 2, 3, *range(4, 33, 4)], 2: [*range(1, 17), 32]}[level]
    with compared(radiance(together), radiance(alone)):
        assert radiance(together) == pytest.approx(radiance(alone), abs=most)
    assert together.cut_map() == pytest.approx(alone.cut_map(), abs=most)
    assert together.error_estimate() == pytest.approx(alone.error_estimate(), rel=1e3 * most)
    assert together.shown_error() == pytest.approx(
        alone.shown_error(), rel=1e-3
    )  # what is shown is of single precision


@LEVELS
@pytest.mark.parametrize("lanes", [1, 8, 16])  # and 4 above
def test_in_packets_of_any_width(renderer_of: RendererOf, lanes: int, level: int) -> None:
    """What differs by sample is looked up by lane, in each width in its own way."""
    scene = legacy({**BARE, "emitters": [], "environment": {"kind": "gradient"}, "optics": {"bands": 8}})
    renderer, special = renderer_of(lanes, np.float32), lanes != 16  # whose general program other tests need too
    (alone, _), (together, _) = (drawn(renderer, scene, *levels, special=special) for levels in ((), (level,)))
    with compared(radiance(together), radiance(alone)):
        assert radiance(together) == pytest.approx(radiance(alone), abs=3e-6)


@LEVELS
def test_of_several_stones_in_packets_of_sixteen(renderer_of: RendererOf, level: int) -> None:
    """Where the processor looks numbers up by stone and by sample in one go."""
    renderer, scene = renderer_of(16, np.float32), legacy(KINDS["two materials, wavelengths"])
    (alone, _), (together, _) = drawn(renderer, scene), drawn(renderer, scene, level)
    with compared(radiance(together), radiance(alone)):
        assert radiance(together) == pytest.approx(radiance(alone), abs=3e-6), "measured 6.6e-7"


def test_chance_and_fireflies_have_each_sample_by_itself(renderer: Renderer) -> None:
    """Chance is drawn by tile; and of all samples of a pixel the brightest is told."""
    for part in ({"optics": {"end": "roulette"}}, {"film": {"fireflies": "hide"}}):
        assert drawn(renderer, legacy(part), 2, 1)[1] == list(range(1, SAMPLES + 1))


def test_of_a_large_picture_fewer_are_drawn_together(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("culet.rendering.renderer.LARGEST_BATCH", 15 * SIZE[0] * SIZE[1])
    assert drawn(renderer, legacy({"stones": []}), 2, 1)[1] == [1, 2, 3, *range(4, 33, 4)]


def test_what_is_drawn_together_does_not_depend_on_when_it_is_to_be_seen(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or a busy machine would have another picture, by the order of sums."""
    monkeypatch.setattr("culet.rendering.renderer.SOON", -math.inf)
    monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: 500)
    scene = legacy({"optics": {"bands": 8}})
    undisturbed, counts = drawn(renderer, scene, 2, 1)
    for overdue in (lambda _: True, lambda seconds: seconds > 0):  # ever since it was seen; soon after it was
        picture, looks, seen = renderer.picture(Stage.of(scene), *SIZE, effort=LightEffort.RESTING), 0, [0]
        while picture.samples < SAMPLES:
            for _ in picture.refine_until(Target(SAMPLES), 1.0, due=overdue):
                pass
            looks += picture.under_way
            seen += [picture.samples] if picture.samples > seen[-1] else []
        assert seen[1:] == counts
        assert looks > len(counts) or not overdue(0), "it was left amid batches"
        assert picture.linear().tobytes() == undisturbed.linear().tobytes()


def test_a_batch_under_way_is_shown_where_its_tiles_are_done(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what is shown at last is the picture with all of it."""
    monkeypatch.setattr("culet.rendering.renderer.SOON", -math.inf)
    scene, size = legacy(BARE), (40, 190)  # four tiles of single samples
    picture = renderer.picture(Stage.of(scene), *size, effort=LightEffort.RESTING)
    picture.refine(SAMPLES // 2)
    before = over = picture.rgb()
    monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: 500)
    launches, changed = 0, []

    def due(seconds: float) -> bool:
        return launches % 4 == 3 and seconds == 0

    while picture.samples < SAMPLES:
        for _ in picture.refine_until(Target(SAMPLES), 1.0, due=due):
            launches += 1
        launches += 1
        if picture.under_way:
            *_, over = picture.overlaid(over)
            changed.append((over != before).any(axis=-1).mean())
    assert len(changed) > 2
    assert changed == sorted(changed)
    assert changed[-1] > 0
    final = picture.rgb()
    assert ((over == final).all(axis=-1) | (over == before).all(axis=-1)).all()  # as it was, or with all sixteen
    whole, _ = drawn(renderer, scene, size=size)
    assert abs(final.astype(int) - whole.rgb()).max() <= 1
    assert picture.cut() == pytest.approx(float(whole.cut()), rel=0.1)  # of the last sample alone

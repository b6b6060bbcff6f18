"""Wavelengths by themselves: three indices first, then a spectrum where a stone disperses, and never a step back."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any
from weakref import ref

import numpy as np
import pytest

from culet.rendering.chains import AUTO_BANDS, band_count, bands_seen, first_sample, is_spectral
from culet.rendering.features import features_of
from culet.rendering.film.target import Target
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.stage import Stage
from culet.study.renderer.resting import as_shown
from pictures import compared
from rendering.views import Array

SIZE = (96, 54)
SCENE = Scene.read({"optics": {"bands": "auto"}})


def with_bands(bands: int | str, scene: Scene = SCENE) -> Stage:
    return Stage.of(scene.model_copy(update={"optics": scene.optics.model_copy(update={"bands": bands})}))


def linear(renderer: Renderer, stage: Stage, samples: int) -> Array:
    picture = renderer.picture(stage, *SIZE)
    picture.refine(samples)
    return np.asarray(picture.linear(), np.float64)


def test_the_first_sample_is_the_one_of_three_indices_to_the_last_bit(renderer: Renderer) -> None:
    auto, three = linear(renderer, with_bands("auto"), 1), linear(renderer, with_bands(3), 1)
    with compared(auto, three):
        assert auto.tobytes() == three.tobytes()


def test_every_later_sample_is_the_spectral_one_of_its_number(renderer: Renderer) -> None:
    """All samples count alike: what three indices lack of the spectrum goes as one over their number."""
    three, spectral = with_bands(3), with_bands(AUTO_BANDS)
    parts = [linear(renderer, three, 1), -linear(renderer, spectral, 1), 5 * linear(renderer, spectral, 5)]
    auto, expected = linear(renderer, with_bands("auto"), 5), sum(parts) / 5
    with compared(auto, expected):
        assert auto == pytest.approx(expected, abs=2e-5)  # measured 2e-6
    assert abs(auto - linear(renderer, three, 5)).max() > 0.01


def test_no_picture_at_rest_is_worse_than_the_one_before_it(renderer: Renderer) -> None:
    """Against sixteen wavelengths, as shown: 0.0735 of one sample, 0.0595, 0.0424, 0.0271, 0.0185 of sixteen. Between
    them some numbers of samples are luckier than others, as of three indices alone: by 1.035 at most."""
    film = SCENE.film
    converged = as_shown(linear(renderer, with_bands(16), 200), film)
    picture, errors = renderer.picture(Stage.of(SCENE), *SIZE), list[float]()
    for _ in range(16):
        picture.refine()
        shown = as_shown(np.asarray(picture.linear(), np.float64), film)
        errors.append(math.sqrt(np.mean(np.square(shown - converged))))
    assert all(after < 0.9 * before for before, after in pairwise(errors[count - 1] for count in (1, 2, 4, 8, 16)))
    assert all(after < 1.04 * before for before, after in pairwise(errors))
    assert errors[-1] < 0.35 * errors[0]


@pytest.mark.parametrize(
    "flat",
    [
        {"stones": [{"material": {"ior": [1.5, 1.5, 1.5]}}]},
        {"stones": []},
        {"optics": {"estimator": "classic"}},
    ],
    ids=["one index", "no stone", "the classic estimator"],
)
def test_where_nothing_disperses_it_is_three_indices_to_the_last_bit(
    renderer: Renderer, flat: dict[str, object]
) -> None:
    three = Scene.read(flat)
    auto = three.model_copy(update={"optics": three.optics.model_copy(update={"bands": "auto"})})
    stage = Stage.of(auto)
    assert not is_spectral(auto)
    assert first_sample(stage) is stage
    assert features_of(stage) == features_of(Stage.of(three))
    assert linear(renderer, stage, 3).tobytes() == linear(renderer, Stage.of(three), 3).tobytes()


def test_one_stone_that_disperses_is_enough() -> None:
    glass = {"id": "glass", "material": {"ior": [1.5, 1.5, 1.5]}, "position": [4, 0, 0]}
    scene = Scene.read({"stones": [glass, {"id": "diamond"}], "optics": {"bands": "auto"}})
    assert band_count(scene) == AUTO_BANDS


def test_a_picture_tells_how_many_wavelengths_its_last_sample_had() -> None:
    assert [bands_seen(SCENE, samples) for samples in (0, 1, 2, 50)] == [3, 3, AUTO_BANDS, AUTO_BANDS]
    eight = with_bands(8).scene
    assert [bands_seen(eight, samples) for samples in (1, 2)] == [8, 8]


def test_it_begins_anew_with_three_indices(renderer: Renderer) -> None:
    picture = renderer.picture(Stage.of(SCENE), *SIZE)
    picture.refine(3)
    picture.begin_anew()
    picture.refine()
    assert np.asarray(picture.linear(), np.float64).tobytes() == linear(renderer, with_bands(3), 1).tobytes()


def test_what_the_first_sample_reads_leaves_the_device_after_it(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or an uploaded mesh would be there twice while the picture lasts."""
    made: list[ref[Inputs]] = []

    class Noted(Inputs):
        def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - as the real one's
            super().__init__(*arguments)
            made.append(ref(self))

    def kept() -> list[bool]:
        return [each() is not None for each in made]

    monkeypatch.setattr("culet.rendering.renderer.Inputs", Noted)
    picture = renderer.picture(Stage.of(SCENE), *SIZE)
    picture.refine()
    assert kept() == [True]
    picture.refine(2)
    assert kept() == [False, True]
    assert picture.program is not None
    picture.begin_anew()
    picture.refine(2)
    assert kept() == [False, True, False]


def test_its_error_is_estimated_as_of_any_picture(renderer: Renderer) -> None:
    """Though the first comparison is of three indices with a spectrum. Measured 1.05."""
    picture = renderer.picture(Stage.of(SCENE), *SIZE)
    for _ in picture.refine_until(Target(16), math.inf):
        pass
    converged = as_shown(linear(renderer, with_bands(16), 200), SCENE.film)
    true = math.sqrt(np.mean(np.square(as_shown(np.asarray(picture.linear(), np.float64), SCENE.film) - converged)))
    assert picture.shown_error() / true == pytest.approx(1, abs=0.5)

"""Fireflies are told from fire, left out on the screen alone, and only where somebody asks for that."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

from culet.rendering.cut_out import CuttingRenderer
from culet.rendering.film.fireflies import LEAST_SAMPLES, RATIO
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import Scene, preset
from culet.scene.optics import Optics
from culet.stage import Stage

SIZE = (192, 108)
FIRE = preset("fire").model_copy(update={"optics": Optics(bands="auto")})


def hiding(scene: Scene, **film: str) -> Stage:
    return Stage.of(scene.model_copy(update={"film": scene.film.model_copy(update={"fireflies": "hide", **film})}))


def refined(renderer: Renderer, stage: Stage, samples: int) -> DevicePicture:
    picture = renderer.picture(stage, *SIZE)
    picture.refine(samples)
    return picture


def shown_sums(renderer: Renderer, luminances: list[float], exposure: float = 1) -> NDArray[Any]:
    """(4,) the sum that is shown of a pixel with grey samples of these luminances, one after the other."""
    device, real = renderer.device, renderer.variant.real
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
    run = cl.Buffer(device.context, flags, hostbuf=np.zeros(4, real))
    fireflies = renderer.fireflies(1, exposure)
    for number, luminance in enumerate(luminances):
        cl.enqueue_copy(device.queue, fireflies.sample, np.full(4, luminance, real))
        fireflies.collect(run, add=number > 0, sample=number)
    sums = np.empty(4, real)
    cl.enqueue_copy(device.queue, sums, fireflies.left_out(run, run, len(luminances), both=False))
    return sums


@pytest.mark.parametrize("place", [0, 3, 9])
def test_a_sample_that_stands_alone_is_left_out_and_the_others_stand_for_it(renderer: Renderer, place: int) -> None:
    samples = [0.5] * 10
    samples[place] = 1.01 * RATIO * 0.5
    sums = shown_sums(renderer, samples)
    assert sums[:3] == pytest.approx(10 * 0.5, rel=1e-5)
    assert sums[3] == pytest.approx(sum(samples)), "the fourth number is no colour"


@pytest.mark.parametrize(
    ("samples", "exposure"),
    [
        ([0.5] * 9 + [0.99 * RATIO * 0.5], 1.0),
        ([0.5] * 8 + [80.0, 80.0], 1.0),
        ([0.0] * 9 + [0.19], 1.0),
        ([0.0] * (LEAST_SAMPLES - 2) + [80.0], 1.0),
        ([0.0] * 9 + [1.9], 0.1),
    ],
    ids=["not so bright", "two of them", "too faint to be seen", "too few samples", "too faint on that film"],
)
def test_fire_stays(renderer: Renderer, samples: list[float], exposure: float) -> None:
    assert shown_sums(renderer, samples, exposure)[:3] == pytest.approx(sum(samples), rel=1e-5)


def test_radiance_keeps_every_sample_to_the_last_bit(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    """And so do the errors that are estimated. Of 20736 pixels 121 are shown otherwise, darker. Samples are drawn one
    by one in both, as where fireflies are hidden, so that they are added in the same order."""
    monkeypatch.setattr("culet.rendering.renderer.LEVELS", ())
    kept, hidden = (refined(renderer, stage, 16) for stage in (Stage.of(FIRE), hiding(FIRE)))
    assert kept.linear().tobytes() == hidden.linear().tobytes()
    assert kept.error_estimate() == hidden.error_estimate()
    darker = kept.rgb().astype(int) - hidden.rgb()
    changed = np.abs(darker).max(axis=-1) > 3
    assert 20 < changed.sum() < 400
    assert darker[changed].mean() > 0


def test_the_fire_of_a_diamond_stays(renderer: Renderer) -> None:
    """What is bright in the converged picture is, after 64 samples, as bright with fireflies hidden as with them."""
    bright = refined(renderer, Stage.of(FIRE), 128).rgb().max(axis=-1) > 204
    kept, hidden = (refined(renderer, stage, 64).rgb().astype(float) for stage in (Stage.of(FIRE), hiding(FIRE)))
    assert hidden[bright].mean() == pytest.approx(kept[bright].mean(), rel=1e-2)  # measured 4e-3
    assert (np.abs(kept - hidden).max(axis=-1) > 3).mean() < 0.005  # measured 0.0016


def test_it_begins_anew_without_what_was_bright_before(renderer: Renderer) -> None:
    picture = refined(renderer, hiding(FIRE), 16)
    picture.begin_anew()
    picture.refine(16)
    assert (picture.rgb() == refined(renderer, hiding(FIRE), 16).rgb()).all()


def test_a_still_in_front_of_nothing_keeps_them() -> None:
    stages = (Stage.of(FIRE.model_copy(update={"film": FIRE.film.model_copy(update={"background": "transparent"})})),)
    renderer = CuttingRenderer()
    shown = []
    for stage in (*stages, hiding(FIRE, background="transparent")):
        picture = renderer.cut_out(stage, 48, 27)
        picture.refine(LEAST_SAMPLES)
        shown.append(picture.rgb().tobytes())
    assert shown[0] == shown[1]

"""Seconds to reach an error, from curves that are known; and Mitsuba 3 on the same picture."""

from __future__ import annotations

import math
import sys
from importlib import invalidate_caches
from importlib.machinery import PathFinder
from pathlib import Path

import numpy as np
import pytest

from culet.rendering.opencl.device import Device
from culet.study.renderer import race
from culet.study.renderer.knobs import base_knobs
from culet.study.renderer.mitsuba import find_llvm, gradient_sky
from culet.study.renderer.race import mitsuba_missing, race_shot, results, run_mitsuba
from culet.study.renderer.reference import make_reference, reference_knobs
from culet.study.renderer.renderers import Renderers
from culet.study.report import Point


def curve(name: str, times: list[float], errors: list[float]) -> list[Point]:
    return [
        Point(
            key=f"{name} {n}",
            group="race",
            label="",
            knobs={"renderer": name, "samples": n},
            figures={"race_seconds": time, "race_rmse": error},
        )
        for n, (time, error) in enumerate(zip(times, errors, strict=True))
    ]


def test_each_renderer_has_its_own_times() -> None:
    noise = curve("noise", [1, 4, 16], [0.08, 0.04, 0.02])
    biased = curve("biased", [1, 2, 4, 8], [0.1, 0.06, 0.05, 0.05])
    first, second = results([*noise, *biased], targets=(0.02, 0.01))
    assert first.seconds == {"0.02": pytest.approx(16), "0.01": pytest.approx(64)}
    assert first.extrapolated == ("0.01",)
    assert second.seconds == {"0.02": None, "0.01": None}
    assert "0.05" in second.note


def test_the_sky_is_linear_in_height() -> None:
    sky = gradient_sky(180)
    assert sky.shape == (180, 360, 3)
    assert sky[0, 0, 0] == pytest.approx(1, abs=1e-4)
    assert sky[45, 0, 0] == pytest.approx(0.5 * (1 + math.cos(math.radians(45.5))))
    assert sky[-1, 0, 0] == pytest.approx(0, abs=1e-4)


def test_the_newest_llvm_that_is_new_enough_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Debian's names: 16 carries its version after a hyphen, 19 after `.so.`; a link without one says nothing."""
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    folder = tmp_path / "x86_64-linux-gnu"
    folder.mkdir()
    for name in ("libLLVM-14.so.1", "libLLVM-15.so"):
        (folder / name).touch()
    assert find_llvm((tmp_path,)) is None
    (tmp_path / "llvm-16" / "lib").mkdir(parents=True)
    (tmp_path / "llvm-16" / "lib" / "libLLVM-16.so.1").touch()
    assert str(find_llvm((tmp_path,))).endswith("libLLVM-16.so.1")
    for name in ("libLLVM.so.19.1", "libLLVM.so"):
        (folder / name).touch()
    assert str(find_llvm((tmp_path,))).endswith("libLLVM.so.19.1")
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/elsewhere/libLLVM.so")
    assert find_llvm((tmp_path,)) == "/elsewhere/libLLVM.so"


def test_a_package_that_is_not_there_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "mitsuba", raising=False)
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    monkeypatch.setattr(sys, "meta_path", [PathFinder])  # an editable install would find it elsewhere
    assert mitsuba_missing()
    (tmp_path / "mitsuba.py").touch()
    invalidate_caches()
    assert not mitsuba_missing()


@pytest.mark.validation
@pytest.mark.skipif(mitsuba_missing(), reason="Mitsuba 3 is not installed: pip install -e '.[validation]'")
def test_mitsuba_sees_the_same_stone(device: Device) -> None:
    """The race is fair only if both come to the same picture: what they are apart is the noise of 128 samples."""
    frame = race_shot(64, 36)
    picture = Renderers(device).picture(base_knobs(frame.stage, device.lanes), frame)
    picture.refine(256)
    runs, words = run_mitsuba(frame, picture.linear().astype(np.float64), 128, 0.01)
    assert words == ""
    (independent,), (spread,) = runs
    assert (independent.knobs["samples"], spread.knobs["samples"]) == (128, 132)  # 11 x 12
    assert max(point.figures["race_rmse"] or 1 for point in (independent, spread)) < 0.012  # measured 0.0077, 0.0051


FIRST = '{"variant": "v", "sampler": "independent", "samples": 16, "seconds": 1, "processor_seconds": 2, "rmse": 0.1}'
ENDED = '{"ended": "independent"}'
SECOND = FIRST.replace("independent", "multijitter")


@pytest.mark.parametrize("lines", [(FIRST, ENDED), (FIRST, ENDED, SECOND)])
def test_a_sampler_that_did_not_come_to_its_end_takes_no_part_and_is_named(lines: tuple[str, ...]) -> None:
    program = f"import sys; print({chr(10).join(lines)!r}); sys.exit('the second one fell over')"
    runs, words = run_mitsuba(race_shot(4, 4), np.zeros((4, 4, 3)), 16, 0.01, command=(sys.executable, "-c", program))
    assert [point.key for points in runs for point in points] == ["race Mitsuba 3, independent samples=16"]
    assert words.startswith("Mitsuba 3, multijitter: no whole run")
    assert words.endswith("the second one fell over")


def test_a_process_that_does_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(race, "PATIENCE", 0.0)
    program = f"import time; print({ENDED!r}, flush=True); time.sleep(600)"
    runs, words = run_mitsuba(race_shot(4, 4), np.zeros((4, 4, 3)), 16, 0.05, command=(sys.executable, "-c", program))
    assert len(runs) <= 1
    assert words.endswith("not done after 1 s")


def test_the_races_reference_shares_no_sample_with_culets(device: Device, tmp_path: Path) -> None:
    """Samples 2 and 3 are what is left of 0 to 3 without 0 and 1."""
    frame = race_shot(16, 9)
    knobs = reference_knobs(base_knobs(frame.stage, device.lanes), "model", 1)
    renderers = Renderers(device)
    whole = make_reference(renderers, frame, knobs, 4, lambda _part: None, steps=True, cache=tmp_path)
    rest = whole.after(2)
    assert rest.samples == 2
    assert (rest.image + whole.images[2]) / 2 == pytest.approx(whole.image)
    assert rest.error == pytest.approx(whole.error * 2**0.75)
    assert np.abs(rest.image - whole.images[2]).max() > 0.01

"""Seconds to reach an error, from curves that are known; and Mitsuba 3 on the same picture."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

from culet.rendering.device import Device
from culet.study.knobs import base_knobs
from culet.study.mitsuba import find_llvm, gradient_sky
from culet.study.race import mitsuba_missing, race_frame, results, run_mitsuba
from culet.study.renderers import Renderers
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


def test_a_package_that_is_not_there_is_missing() -> None:
    assert mitsuba_missing() == (importlib.util.find_spec("mitsuba") is None)


@pytest.mark.validation
@pytest.mark.skipif(mitsuba_missing(), reason="Mitsuba 3 is not installed: pip install -e '.[validation]'")
def test_mitsuba_sees_the_same_stone(device: Device) -> None:
    """The race is fair only if both come to the same picture; 256 samples of noise of 0.25 are an RMSE of 0.016."""
    frame = race_frame(64, 36)
    picture = Renderers(device).picture(base_knobs(frame.subject.scene, frame.subject.stone, device.lanes), frame)
    picture.refine(256)
    points, words = run_mitsuba(frame, picture.linear().astype(np.float64), 128, 0.01)
    assert words == ""
    names = {point.knobs["renderer"]: point.figures["race_rmse"] or 1 for point in points}
    assert len(names) == 2  # independent, multijitter
    assert max(names.values()) < 0.02  # measured MMM

"""Why no device works, in words that help."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import OrderedDict
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from culet.errors import DeviceError, InputError
from culet.rendering.opencl.device import open_device, open_in_advance, remedy
from culet.rendering.opencl.driver_package import BY_SYSTEM, how_to_install
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from shared.stages import staged

CACHES = [
    ({"XDG_CACHE_HOME": "/proc/none"}, "/proc/none/pocl/kcache"),
    ({"POCL_CACHE_DIR": "/proc/none"}, "/proc/none"),
    ({"HOME": "/proc/none"}, "/proc/none/.cache/pocl/kcache"),
]
"""Where PoCL may not write, and the folder that it wants."""


def without_ours() -> dict[str, str]:
    """The environment, but for what says where a cache is or which device is meant."""
    return {name: value for name, value in os.environ.items() if not name.startswith(("POCL_", "XDG_", "CULET_"))}


def complaint(**environment: str) -> str | None:
    """Of a process of its own, since a driver looks at its environment once; none if a device opens."""
    opened = "from culet.rendering.opencl.device import open_device; open_device()"
    done = subprocess.run(
        [sys.executable, "-c", opened], env=without_ours() | environment, capture_output=True, text=True, check=False
    )
    return done.stderr.strip().rpartition("\n")[2] if done.returncode else None


@pytest.fixture
def clean(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    for name in set(os.environ) - set(without_ours()):
        monkeypatch.delenv(name)
    return monkeypatch


@pytest.mark.parametrize(("environment", "folder"), CACHES)
@pytest.mark.parametrize("found", [[], ["a device that fails"]])
def test_a_cache_that_cannot_be_written_is_the_first_suspect(
    clean: pytest.MonkeyPatch, environment: dict[str, str], folder: str, found: list[str]
) -> None:
    for name, value in environment.items():
        clean.setenv(name, value)
    assert remedy(found).startswith(f"PoCL cannot write to its cache {folder} (No such file or directory)")
    assert "POCL_CACHE_DIR" in remedy(found)


def test_only_where_there_is_no_device_a_driver_is_to_be_installed(clean: pytest.MonkeyPatch, tmp_path: Path) -> None:
    clean.setenv("POCL_CACHE_DIR", str(tmp_path))
    assert how_to_install() in remedy([])
    assert how_to_install() not in remedy(["a device that fails"])
    assert "CULET_DEVICE" in remedy(["a device that fails"])


@pytest.mark.parametrize(("environment", "folder"), CACHES)
def test_a_process_that_finds_no_device_says_why(environment: dict[str, str], folder: str) -> None:
    """PoCL 3.1 offers none without a cache."""
    found = complaint(**environment)
    if found is None:
        pytest.skip(f"this driver does without {folder}")
    assert "no OpenCL device works" in found
    assert f"PoCL cannot write to its cache {folder}" in found


def test_a_device_that_is_not_there_is_named() -> None:
    found = complaint(CULET_DEVICE="abacus")
    assert found is not None
    assert "none matches CULET_DEVICE='abacus'" in found


def test_a_sky_that_nobody_can_write_to_is_read_where_it_is(renderer: Renderer) -> None:
    """Of the device that is the processor; another array is copied, so that a picture shows what it was begun with."""
    device = replace(renderer.device, panoramas=OrderedDict())  # not full of other tests' skies
    fixed, free = (np.full((4, 8, 3), 0.5, np.float32) for _ in range(2))
    fixed.flags.writeable = False
    device.panorama(fixed)
    assert device.panorama_bytes() == (0 if device.shares_memory else fixed.nbytes)
    device.panorama(free)
    assert device.panorama_bytes() == (free.nbytes if device.shares_memory else fixed.nbytes + free.nbytes)
    for pixels in (fixed, free):
        assert device.panorama(pixels) is device.panorama(pixels)
        device.forget(pixels)
    assert device.panorama_bytes() == 0


@pytest.mark.parametrize("value", [np.nan, np.inf, -0.5])
def test_a_panorama_that_no_file_may_have_is_refused_as_from_a_file(renderer: Renderer, value: float) -> None:
    pixels = np.full((4, 8, 3), 0.5, np.float32)
    pixels[1, 2, 0] = value
    scene = Scene.read({"environment": {"kind": "image", "image": "mine"}})
    with pytest.raises(InputError, match="panorama: expected radiance that is finite and not below 0"):
        renderer.picture(staged(scene, panorama=pixels), 8, 8)
    with pytest.raises(InputError, match=r"panorama: expected an array of \(height, width, 3\), got \(4, 8\)"):
        renderer.picture(staged(scene, panorama=pixels[..., 0]), 8, 8)


@pytest.mark.parametrize(
    ("release", "conda", "command"),
    [
        ({"ID": "debian"}, "", "apt-get install pocl-opencl-icd"),
        ({"ID": "linuxmint", "ID_LIKE": "ubuntu debian"}, "", "apt-get install pocl-opencl-icd"),
        ({"ID": "fedora"}, "", "dnf install pocl"),
        ({"ID": "rocky", "ID_LIKE": "rhel centos fedora"}, "", "dnf install pocl"),
        ({"ID": "debian"}, "/opt/conda", "conda install conda-forge::pocl"),
    ],
)
def test_the_package_is_named_that_brings_a_driver_here(
    monkeypatch: pytest.MonkeyPatch, release: dict[str, str], conda: str, command: str
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("platform.freedesktop_os_release", lambda: release)
    monkeypatch.setenv("CONDA_PREFIX", conda)
    assert how_to_install() == command


def test_where_the_system_is_not_known_all_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CONDA_PREFIX", raising=False)
    monkeypatch.setattr("platform.freedesktop_os_release", lambda: {"ID": "plan9"})
    monkeypatch.setattr("sys.platform", "linux")
    assert all(command in how_to_install() for command in BY_SYSTEM.values())
    monkeypatch.setattr("sys.platform", "darwin")
    assert how_to_install() == "brew install pocl"


def test_what_was_opened_in_advance_is_what_is_opened_and_its_refusal_comes_then(
    clean: pytest.MonkeyPatch,
) -> None:
    open_in_advance()
    first = open_device()
    assert open_device() is not first
    clean.setenv("CULET_DEVICE", "no such device")
    open_in_advance()
    with pytest.raises(DeviceError, match="no such device"):
        open_device()

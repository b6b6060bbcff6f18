"""What tests of all parts share: the default stone, device and renderers; and what a worker takes at once."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.opencl.device import Device, open_device
from culet.rendering.renderer import Renderer
from culet.scene.stone import StoneSettings

RendererOf = Callable[[int, type[np.floating[Any]]], Renderer]

LONG_FIRST = (
    "tests/validation/", "tests/e2e/", "tests/test_cli.py", "tests/service/", "tests/rendering/", "tests/documents/",
    "tests/study/", "tests/simulation/", "tests/engine/", "tests/gateway/", "tests/hostile/", "tests/geometry/",
)  # fmt: skip
"""What takes long is handed out first, by what its name begins with, so that the workers end together."""


REST_SAMPLES = "16"
"""A picture at rest is final with so many in the servers that tests start: tests wait for many of them."""


SPECIAL_PROGRAMS = "off"
"""Engines that tests start render by the general programs: of each kind of scene that is shown, another one would be
compiled in the background, which no test waits for. Those that are about that say `--special-programs`."""


def pytest_configure(config: pytest.Config) -> None:
    """What every process is told that a test starts; that no example has a time, which other work would exceed, and
    that examples are the same in every run: new ones are tried by `pytest --hypothesis-profile explore`."""
    settings.register_profile("culet", deadline=None, derandomize=True)
    settings.register_profile("explore", deadline=None, derandomize=False, database=None)
    settings.load_profile("culet")
    os.environ.setdefault("CULET_REST_SAMPLES", REST_SAMPLES)
    if config.getoption("markexpr") != "soak":  # which has goals in seconds
        os.environ.setdefault("CULET_SPECIAL_PROGRAMS", SPECIAL_PROGRAMS)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """In a worker, what takes long comes first."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: next((n for n, name in enumerate(LONG_FIRST) if item.nodeid.startswith(name)), 99))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> object:  # noqa: ANN401 - xdist has no types
    """For all of `pytest --numprocesses`."""
    from work_units import ByFile

    return ByFile(config, log)


@pytest.fixture(scope="session")
def brilliant() -> Shape:
    """The default cut."""
    return shape_of(StoneSettings(), {})


@pytest.fixture(scope="session")
def device() -> Device:
    return open_device()


@pytest.fixture(scope="session")
def renderer_of(device: Device) -> RendererOf:
    """The renderer with that many lanes, in that precision. It renders by the general programs, of which a few serve
    all tests; that special ones show the same is tried in `rendering/test_features.py`."""

    made: dict[tuple[int, type[np.floating[Any]]], Renderer] = {}

    def of(lanes: int, real: type[np.floating[Any]]) -> Renderer:
        if (lanes, real) not in made:
            made[lanes, real] = Renderer(device, lanes=lanes, real=real, special_programs=False)
        return made[lanes, real]

    return of


@pytest.fixture(scope="session")
def renderer(renderer_of: RendererOf, device: Device) -> Renderer:
    """As the server uses it until a special program is compiled: single precision, packets as wide as the device likes
    them."""
    return renderer_of(device.lanes, np.float32)


@pytest.fixture(scope="session")
def exact(renderer_of: RendererOf) -> Renderer:
    """Double precision, by which single precision is judged."""
    return renderer_of(4, np.float64)

"""The kernels' sources: each stands alone, and none warns."""

from __future__ import annotations

import re
from dataclasses import replace
from importlib.resources import files
from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import culet_kernels
from culet.rendering.device import Device
from culet.rendering.features import ESTIMATOR, FRESNEL, SKY, SURFACE, Features, Geometry
from culet.rendering.program import FLAGS, Variant, build

FIXED = [
    Features(
        Geometry.HULL, SURFACE["mirror"], SURFACE["none"], -1, SKY["studio"], dispersion=1, absorption=0,
        fresnel=FRESNEL["exact"], camera_inside=0,
    ),
    Features(
        Geometry.MESH, SURFACE["matte"], SURFACE["mirror"], 0, SKY["half"], dispersion=0, absorption=-1,
        fresnel=FRESNEL["schlick"], camera_inside=1,
    ),
    Features(
        Geometry.EMPTY, SURFACE["none"], SURFACE["none"], 0, SKY["constant"], dispersion=0, absorption=0,
        fresnel=FRESNEL["exact"], camera_inside=0,
    ),
]  # fmt: skip
PROGRAMS = {
    "general hull": Features(Geometry.HULL),
    "general mesh": Features(Geometry.MESH),
    "general empty": Features(Geometry.EMPTY),
    **{
        f"fixed {features.geometry.name.lower()}": features
        for features in FIXED
        if isinstance(features.geometry, Geometry)
    },
}


@pytest.mark.parametrize("name", culet_kernels.NAMES)
@pytest.mark.parametrize("lanes", [1, 4, 8, 16])
@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_every_source_compiles_by_itself_without_a_warning(
    device: Device, name: str, lanes: int, real: type[np.floating[Any]]
) -> None:
    """A file includes what it needs, and every feature has a default."""
    build(device, name, [*Variant(lanes=lanes, real=real).options, "-Werror"])


@pytest.mark.parametrize("features", PROGRAMS.values(), ids=PROGRAMS.keys())
@pytest.mark.parametrize("lanes", [1, 16])
@pytest.mark.parametrize("estimator", ESTIMATOR.values(), ids=ESTIMATOR.keys())
def test_programs_with_features_fixed_compile_without_a_warning(
    device: Device, features: Features, lanes: int, estimator: int
) -> None:
    options = replace(features, estimator=estimator).options
    build(device, "render.cl", [*Variant(lanes=lanes).options, *options, "-Werror"])


def test_a_warning_would_be_an_error(device: Device) -> None:
    """What the tests above rely on: this compiler does warn, and does obey -Werror."""
    with pytest.raises(cl.RuntimeError, match="implicit conversion"):
        cl.Program(device.context, "__kernel void f(__global int *a) { *a = 1.5f; }").build([*FLAGS, "-Werror"])


@pytest.mark.parametrize("name", culet_kernels.NAMES)
def test_joined_sources_keep_each_line_under_its_name_and_number(name: str) -> None:
    """So that the compiler's messages point at the source as it is written."""
    written = {each: files("culet_kernels").joinpath(each).read_text().splitlines() for each in culet_kernels.NAMES}
    file, number, met = name, 1, set()
    for line in culet_kernels.source(name).splitlines():
        marker = re.fullmatch(r'#line (\d+) "(\w+\.cl)"', line)
        if marker:
            number, file = int(marker[1]), marker[2]
            continue
        assert line == written[file][number - 1], f"{file}:{number}"
        met.add(file)
        number += 1
    assert name in met

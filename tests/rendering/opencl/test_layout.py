"""Structs and arguments as the host reads them from the kernels' text, against what their compiler makes of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import culet_kernels
from culet.rendering.chains import GROUPS
from culet.rendering.opencl.device import Device
from culet.rendering.opencl.layout import arguments, constants, in_order, struct
from culet.rendering.programs.build import FLAGS, Variant
from culet.scene.emitters import MOST_LAMPS

PROBE = """
#define PLACE(field) (int)((__private char *)&p.field - (__private char *)&p)
__kernel void probe(__global int *out) {{
  {name} p;
  {body}
}}
"""


def numbers(device: Device, name: str, expressions: list[str], real: type[np.floating[Any]]) -> list[int]:
    """What the kernels' compiler says that these are."""
    body = "\n  ".join(f"out[{i}] = {expression};" for i, expression in enumerate(expressions))
    source = culet_kernels.source("parameters.cl") + PROBE.format(name=name, body=body)
    kernel = cl.Kernel(cl.Program(device.context, source).build([*FLAGS, *Variant(real=real).options]), "probe")
    out = np.empty(len(expressions), np.int32)
    buffer = cl.Buffer(device.context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    kernel(device.queue, (1,), None, buffer)
    cl.enqueue_copy(device.queue, out, buffer)
    return [int(number) for number in out]


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("name", ["parameters_t", "chain_t"])
def test_every_field_lies_where_the_kernels_have_it(device: Device, name: str, real: type[np.floating[Any]]) -> None:
    host = struct(name, real)
    assert host.fields is not None
    names = list(host.fields)
    places = [f"PLACE({field})" for field in names]
    sizes = [f"(int)sizeof(p.{field})" for field in names]
    found = numbers(device, name, [*places, *sizes, "(int)sizeof(p)"], real)
    offsets = [host.fields[field][1] for field in names]
    lengths = [host.fields[field][0].itemsize for field in names]
    assert found == [*offsets, *lengths, host.itemsize]


def test_a_scene_may_have_as_many_lamps_as_the_kernels_hold() -> None:
    assert constants("parameters.cl")["MAX_LAMPS"] == MOST_LAMPS


def test_pixels_take_wavelengths_by_squares_of_four() -> None:
    assert GROUPS == 4


def test_arguments_are_told_by_name_and_a_wrong_one_is_refused() -> None:
    given: dict[str, object] = {argument.name: 0 for argument in arguments()}
    values = in_order(given)
    names = [argument.name for argument in arguments()]
    assert names[0] == "scene"
    assert values[names.index("jitter")] is given["jitter"]  # a buffer
    assert isinstance(values[names.index("steps")], np.int32)
    with pytest.raises(TypeError, match="expected the arguments"):
        in_order({**given, "scenes": 0})
    with pytest.raises(TypeError, match="expected the arguments"):
        in_order(dict.fromkeys(names[1:], 0))

"""The scene's quantities as the kernels read them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest

import culet_kernels
from culet.rendering.device import Device
from culet.rendering.parameters import MAX_LAMPS, MAX_LIGHTS, MAX_SURFACES, layout
from culet.rendering.program import FLAGS, Variant

PROBE = """
#define PLACE(field) (int)((__private char *)&p.field - (__private char *)&p)
__kernel void probe(__global int *out) {{
  parameters_t p;
  {body}
}}
"""


def numbers(device: Device, expressions: list[str], real: type[np.floating[Any]]) -> list[int]:
    """What the kernels' compiler says that these are."""
    body = "\n  ".join(f"out[{i}] = {expression};" for i, expression in enumerate(expressions))
    source = culet_kernels.source("parameters.cl") + PROBE.format(body=body)
    kernel = cl.Kernel(cl.Program(device.context, source).build([*FLAGS, *Variant(real=real).options]), "probe")
    out = np.empty(len(expressions), np.int32)
    buffer = cl.Buffer(device.context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    kernel(device.queue, (1,), None, buffer)
    cl.enqueue_copy(device.queue, out, buffer)
    return [int(number) for number in out]


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_the_struct_is_laid_out_as_the_kernels_have_it(device: Device, real: type[np.floating[Any]]) -> None:
    """Every field's place and size, and the whole; so no field is missing on either side."""
    host = layout(real)
    assert host.fields is not None
    names = list(host.fields)
    places = numbers(device, [f"PLACE({name})" for name in names], real)
    sizes = numbers(device, [f"(int)sizeof(p.{name})" for name in names], real)
    assert dict(zip(names, places, strict=True)) == {name: host.fields[name][1] for name in names}
    assert dict(zip(names, sizes, strict=True)) == {name: host.fields[name][0].itemsize for name in names}
    assert numbers(device, ["(int)sizeof(p)"], real) == [host.itemsize]
    ends = [place + size for place, size in zip(places, sizes, strict=True)]
    assert max(np.subtract([*places[1:], host.itemsize], ends)) < 8  # padding: no forgotten double


def test_the_limits_are_the_kernels(device: Device) -> None:
    names = ["MAX_LIGHTS", "MAX_LAMPS", "MAX_SURFACES"]
    assert numbers(device, names, np.float32) == [MAX_LIGHTS, MAX_LAMPS, MAX_SURFACES]

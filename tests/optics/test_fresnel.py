"""fresnel.cl by itself, in a kernel of a few lines, against the closed forms and published numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

import culet_kernels
from culet.rendering.opencl.device import Device
from culet.rendering.programs.build import FLAGS
from optics.closed_forms import DIAMOND, fresnel

PROBE = """
__kernel void probe(__global const real *cosines, real eta, __global real *out) {
  const size_t i = get_global_id(0), count = get_global_size(0);
  const real inside = cosine_in_stone(cosines[i], eta), squared = squared_cosine_in_air(cosines[i], eta);
  out[i] = inside;
  out[i + count] = squared;
  out[i + 2 * count] = reflectance(EXACT, cosines[i], inside, eta);
  out[i + 3 * count] = reflectance(EXACT, sqrt(fmax(squared, (real)0)), cosines[i], eta);
  out[i + 4 * count] = reflectance(SCHLICK, cosines[i], inside, eta);
}
"""
DEGREES = np.arange(0, 90, 0.5)
SINGLE, DOUBLE = np.float32, np.float64
TOLERANCE = {SINGLE: 2e-7, DOUBLE: 6e-16}
PRECISIONS = pytest.mark.parametrize("real", [SINGLE, DOUBLE])


def probe(
    device: Device, real: type[np.floating[Any]], cosines: NDArray[np.float64], eta: float
) -> NDArray[np.float64]:
    """Rows: cosine in the stone, squared cosine in air, reflectance entering, leaving, and Schlick's entering."""
    options = ["-DLANES=1", f"-DREAL={'double' if real is DOUBLE else 'float'}"]
    source = culet_kernels.source("fresnel.cl") + PROBE
    kernel = cl.Kernel(cl.Program(device.context, source).build([*FLAGS, *options]), "probe")
    given, out = cosines.astype(real), np.empty((5, len(cosines)), real)
    flags = cl.mem_flags
    cosine_buffer = cl.Buffer(device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=given)
    target = cl.Buffer(device.context, flags.WRITE_ONLY, out.nbytes)
    kernel(device.queue, given.shape, None, cosine_buffer, real(eta), target)
    cl.enqueue_copy(device.queue, out, target)
    return out.astype(np.float64)


@PRECISIONS
@pytest.mark.parametrize("eta", [1.0, 1.5, 1.7, DIAMOND, 10.0])
def test_snell_holds_on_both_sides(device: Device, real: type[np.floating[Any]], eta: float) -> None:
    angles = np.radians(DEGREES)
    inside, squared, *_ = probe(device, real, np.cos(angles), eta)
    # measured 9.0e-8 and 8.1e-8; 2.8e-16 and 3.9e-16 in double precision
    assert inside**2 == pytest.approx(1 - (np.sin(angles) / eta) ** 2, abs=TOLERANCE[real])
    assert squared == pytest.approx(1 - (eta * np.sin(angles)) ** 2, abs=eta**2 * TOLERANCE[real])


@PRECISIONS
@pytest.mark.parametrize("eta", [1.5, DIAMOND])
def test_reflectance_is_fresnels_from_either_side(device: Device, real: type[np.floating[Any]], eta: float) -> None:
    angles = np.radians(DEGREES)
    _, squared, entering, leaving, _ = probe(device, real, np.cos(angles), eta)
    expected = [fresnel(math.sin(a), 1, eta) for a in angles]
    assert entering == pytest.approx(expected, abs=4e-7 if real is SINGLE else 3e-14)  # measured 1.9e-7 and 1.4e-14
    below = squared > 1e-3  # at the critical angle itself the slope is infinite
    expected = [fresnel(math.sin(a), eta, 1) for a in angles]
    # measured 1.2e-6 and 2.3e-15
    assert leaving[below] == pytest.approx(np.array(expected)[below], abs=2.4e-6 if real is SINGLE else 5e-15)
    assert leaving[squared <= 0] == pytest.approx(1, abs=TOLERANCE[real])


@PRECISIONS
def test_diamond_is_as_published(device: Device, real: type[np.floating[Any]]) -> None:
    """R = .172038 at normal incidence, critical angle 24.43 degrees, Brewster 67.53 degrees."""
    cosines = np.cos(np.radians([0, 24.42, 24.44, 67.53]))
    inside, squared, entering, _, schlick = probe(device, real, cosines, DIAMOND)
    assert entering[0] == pytest.approx(0.172038, abs=6e-7)
    assert schlick[0] == pytest.approx(0.172038, abs=6e-7)
    assert squared[1] > 0 > squared[2]
    # At Brewster's angle refracted and reflected light are at right angles, and only one polarisation is reflected.
    assert math.degrees(math.acos(inside[3])) == pytest.approx(90 - 67.53, abs=0.005)
    r_s = math.cos(2 * math.radians(67.53))
    assert entering[3] == pytest.approx(r_s**2 / 2, abs=1e-4)  # 0.25085; two decimals of the angle are worth 6e-5


@PRECISIONS
def test_schlicks_reflectance_is_his_equation_24(device: Device, real: type[np.floating[Any]]) -> None:
    """With the cosine in air. For diamond it departs from Fresnel's by up to 0.0755, near 80 degrees; by none at 0."""
    cosines = np.linspace(0.001, 1, 1000)
    _, _, entering, _, schlick = probe(device, real, cosines, DIAMOND)
    at_normal = ((DIAMOND - 1) / (DIAMOND + 1)) ** 2
    assert schlick == pytest.approx(at_normal + (1 - at_normal) * (1 - cosines) ** 5, abs=TOLERANCE[real])
    assert abs(schlick - entering)[-1] < TOLERANCE[real]
    assert abs(schlick - entering).max() == pytest.approx(0.0755, abs=5e-5)

"""Light maps by photons, against closed forms: what is taken away, what comes through, and that nothing is lost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.emitters.light_map import MapFrame, frame_of
from culet.rendering.emitters.ray import LightRay
from culet.rendering.light.beams import Beams
from culet.rendering.light.photons import PhotonMaps, Photons
from culet.rendering.opencl.device import Device
from culet.scene import Scene
from optics.closed_forms import fresnel
from shared.stages import staged
from shared.stones import prism, ring, slab

UPRIGHT = {"orientation": [1, 0, 0, 0], "position": [0, 0, 0]}
SLANTED = (-4 / math.sqrt(68), 6 / math.sqrt(68), 4 / math.sqrt(68))


@pytest.fixture(scope="module")
def photons(device: Device) -> Photons:
    return Photons(device)


def sun(towards: tuple[float, float, float] = SLANTED) -> LightRay:
    return LightRay((1.0, 1.0, 1.0), towards=towards)


def lamp(position: tuple[float, float, float] = (-4.0, 6.0, 4.0)) -> LightRay:
    return LightRay((1.0, 1.0, 1.0), position=position)


def shot(
    device: Device,
    photons: Photons,
    shape: Shape | None,
    rays: Sequence[LightRay],
    *,
    stones: Sequence[dict[str, Any]] = ({},),
    count: int = 60_000,
    number: int = 0,
    **scene: object,
) -> tuple[PhotonMaps, MapFrame, NDArray[np.float32]]:
    """Maps of a pass."""
    given = {
        "floor": {"kind": "matte"},
        "environment": {"kind": "constant", "radiance": [0, 0, 0]},
        "emitters": [{"shape": "point", "position": [-4, 6, 4], "colour": [1, 1, 1]}],  # or nothing needs a map
        **scene,
    }
    stage = staged(Scene.read({**given, "stones": list(stones)}), shape)
    frame = frame_of(stage)
    maps = photons.maps(stage, frame)
    target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    for _ in maps.pieces(target, rays, number=number, photons=count):
        pass
    made = np.empty(frame.shape, np.float32)
    cl.enqueue_copy(device.queue, made, target)
    return maps, frame, made


def balance(maps: PhotonMaps) -> float:
    """What went where, over what came: 0 if nothing is lost or made."""
    figures, shooting = maps.figures, maps.shooting
    assert figures is not None
    assert shooting is not None
    return float(shooting.landed + shooting.elsewhere + shooting.outside + figures.cut) / figures.incident


@pytest.mark.parametrize("ray", [sun(), lamp()], ids=["parallel", "point"])
def test_a_stone_of_index_1_changes_nothing(device: Device, photons: Photons, ray: LightRay) -> None:
    glass = {"material": {"ior": [1, 1, 1]}}
    maps, _, made = shot(device, photons, None, [ray], stones=[glass])
    assert maps.figures is not None
    assert maps.figures.incident > 2.8
    assert made.std() < 1e-3 * np.float32(0.73)  # measured 4e-4: roundings move some photons from cell to cell
    assert abs(balance(maps)) < 1e-6


def test_the_shadow_takes_all_of_the_light_that_meets_the_stone(device: Device, photons: Photons) -> None:
    """Under a plate of area 2 w^2 in vertical light what passes is (1 - R) / (1 + R), so that the map has 2R / (1 + R)
    less than the room without it."""
    ior, half_height = 2.0, 0.05
    width = math.sqrt((1 - half_height**2) / 2)
    maps, frame, made = shot(
        device, photons, slab(half_height), [sun((0, 1, 0))], stones=[{**UPRIGHT, "material": {"ior": [ior] * 3}}]
    )
    reflectance = fresnel(0, 1, ior)
    taken = 2 * reflectance / (1 + reflectance)
    assert maps.figures is not None
    assert maps.figures.incident == pytest.approx(4 * width**2, rel=2e-3)
    middle = np.abs(frame.texels(0, 0)[0]) < 0.5
    assert made[0, 0][np.ix_(middle, middle)].mean() == pytest.approx(-taken, rel=0.01)
    for level in range(2):
        assert made[0, level].sum() * frame.texel_area(level) / 3 == pytest.approx(-4 * width**2 * taken, rel=0.01)


def test_a_slab_moves_slanted_light_sideways(device: Device, photons: Photons) -> None:
    """By h tan t' on its way through a plate of thickness h, where Snell's law has t'."""
    ior, half_height, angle = 1.5, 0.2, math.radians(40)
    towards = (math.sin(angle), math.cos(angle), 0.0)
    _, frame, made = shot(
        device, photons, slab(half_height), [sun(towards)], stones=[{**UPRIGHT, "material": {"ior": [ior] * 3}}],
        optics={"max_bounces": 1},
    )  # fmt: skip
    width, inside = math.sqrt((1 - half_height**2) / 2), math.asin(math.sin(angle) / ior)
    u, v = frame.texels(0, 0)
    row = made[0, 0][np.abs(v) < 0.3].mean(axis=0)[:, 1]
    # The edge between what has come in by the top and what has come in by a side, which does not leave below.
    edge = width - 2 * half_height * math.tan(inside) - (1 - half_height) * math.tan(angle)
    through = math.cos(angle) * (1 - fresnel(math.sin(angle), 1, ior)) ** 2
    assert row[(u > edge - 0.4) & (u < edge - 0.03)].mean() == pytest.approx(through - math.cos(angle), abs=3e-3)
    dark = (u > edge + 0.03) & (u < edge + 2 * half_height * math.tan(inside) - 0.03)
    assert row[dark].mean() == pytest.approx(-math.cos(angle), abs=3e-3)
    near = np.abs(u - edge) < 0.1
    crossed = np.interp(0.5 * through - math.cos(angle), row[near][::-1], u[near][::-1])
    assert crossed == pytest.approx(edge, abs=u[1] - u[0])


def test_a_prism_sends_each_index_where_snells_law_says(device: Device, photons: Photons) -> None:
    """Level light through both slanted sides of an apex of 40 degrees: of each channel, what passes by the apex lands
    farthest, and where it does follows from two refractions."""
    indices, half, shape = (1.5, 1.6, 1.7), math.radians(20), prism(40)
    maps, frame, made = shot(
        device, photons, shape, [sun((-1, 0, 0))], stones=[{**UPRIGHT, "material": {"ior": list(indices)}}],
        count=200_000, optics={"max_bounces": 1},
    )  # fmt: skip
    assert maps.figures is not None
    u, v = frame.texels(0, 1)
    rows = made[0, 1][np.abs(v) < 0.3].mean(axis=0)
    height = 1 + float(shape.planes[0, 3]) / math.sin(half)  # of the apex above the floor
    for channel, index in enumerate(indices):
        turned = math.asin(index * math.sin(2 * half - math.asin(math.sin(half) / index))) - half
        farthest = height / math.tan(turned)
        lit = rows[:, channel] > 0.3 * rows[:, channel].max()
        assert u[lit].max() == pytest.approx(farthest, abs=2 * (u[1] - u[0]))


def test_triangles_light_the_floor_as_half_spaces_do(device: Device, photons: Photons, brilliant: Shape) -> None:
    by_planes = shot(device, photons, brilliant, [sun()])
    by_triangles = shot(device, photons, replace(brilliant, convex=False), [sun()])
    for _, frame, made in (by_planes, by_triangles):
        assert made.shape == frame.shape
    difference = by_planes[2][0, 1] - by_triangles[2][0, 1]
    assert np.abs(difference).mean() < 0.02 * np.abs(by_planes[2][0, 1]).mean()
    for maps, _, _ in (by_planes, by_triangles):
        assert abs(balance(maps)) < 1e-3


@pytest.mark.parametrize("bands", [3, 8])
def test_no_light_is_lost_in_a_ring_and_between_stones(device: Device, photons: Photons, bands: int) -> None:
    """What lands, leaves and is cut is what came; to what roulette leaves to chance."""
    stones: list[dict[str, Any]] = [
        {"id": "a", "position": [-0.9, 0, 0]},
        {"id": "b", "position": [0.9, 0.1, 0.2], "scale": 0.8},
    ]
    maps, _, made = shot(
        device, photons, ring(), [sun(), lamp()], stones=stones, count=20_000, optics={"bands": bands},
        walls={"kind": "matte"},
    )  # fmt: skip
    assert np.isfinite(made).all()
    assert abs(balance(maps)) < 2e-3
    assert maps.shooting is not None
    assert maps.shooting.overflown == 0


def test_shade_behind_two_stones_is_counted_once(device: Device, photons: Photons) -> None:
    """Light that passes one stone's circle and meets the other one first is the other one's."""
    glass = {"material": {"ior": [1, 1, 1]}, **UPRIGHT}
    stones: list[dict[str, Any]] = [
        {"id": "a", **glass, "position": [0, 0, 0]},
        {"id": "b", **glass, "position": [0, 2.5, 0]},
    ]
    maps, _, _ = shot(device, photons, None, [sun((0, 1, 0))], stones=stones)
    alone, _, _ = shot(device, photons, None, [sun((0, 1, 0))], stones=stones[:1])
    assert maps.figures is not None
    assert alone.figures is not None
    assert maps.figures.incident == pytest.approx(alone.figures.incident, rel=2e-3)


def test_light_below_a_floor_that_a_stone_reaches_through_does_not_come_back(device: Device, photons: Photons) -> None:
    maps, _, made = shot(device, photons, None, [sun()], stones=[{"position": [0, -1.0, 0]}])
    assert np.isfinite(made).all()
    assert abs(balance(maps)) < 1e-3


BLOCK = 16
"""Texels on each side of what is compared as a whole: footprints are hardly wider."""
PASSES = 12


@pytest.mark.parametrize(("ray", "stone"), [(sun(), {}), (lamp(), {"orientation": [0.6, 0.48, 0.64, 0]})])
def test_photons_and_beams_agree_within_noise(
    device: Device, photons: Photons, ray: LightRay, stone: dict[str, Any]
) -> None:
    """By a Z-test of blocks: the spread of passes tells the noise of their mean."""
    made = np.array(
        [shot(device, photons, None, [ray], stones=[stone], number=number, count=40_000)[2] for number in range(PASSES)]
    )
    maps, frame, exact = shot(device, photons, None, [ray], stones=[stone], count=1)
    target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    figures = Beams(device).make(maps.stage, [ray], frame, target, cutoff=1e-6)
    cl.enqueue_copy(device.queue, exact, target)
    side = 512 // BLOCK
    by_photons = made[:, 0].reshape(PASSES, 2, side, BLOCK, side, BLOCK, 3).mean((3, 5))
    by_beams = exact[0].reshape(2, side, BLOCK, side, BLOCK, 3).mean((2, 4))
    spread = by_photons.std(axis=0, ddof=1) / math.sqrt(PASSES)
    difference = by_photons.mean(axis=0) - by_beams
    certain = np.hypot(spread, 2e-3)  # what footprints carry from block to block; the beams' cut-off
    assert (difference / certain).std() < 1.3  # measured 0.47 and 0.92
    assert np.sqrt((difference**2).mean()) < 0.02 * np.sqrt((by_beams**2).mean())  # measured 0.006 and 0.016
    # Photons have what beams cut: a part of that would land on the map.
    missing = (by_photons.mean(axis=0) - by_beams).mean(axis=(1, 2, 3)) * [(2 * half) ** 2 for half in frame.halves]
    noise = 1e-3 * figures.incident
    assert (missing > -noise).all()
    assert (missing < figures.cut + figures.unresolved + noise).all()

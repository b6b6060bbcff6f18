"""Facets by symmetry: rows stand for each of them once, and light leaves where it does by the facets themselves."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
import trimesh
from numpy.typing import NDArray

import culet_kernels
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.geometry.symmetry import SAME
from culet.rendering.opencl.device import Device, Real
from culet.rendering.programs.build import FLAGS, Variant
from culet.rendering.renderer import Renderer
from culet.rendering.stones.facet_rows import FacetRows, facet_rows
from culet.scene.legacy import legacy
from rendering.views import Array
from shared.stages import staged
from shared.stones import ball, box, brilliant, step_cut

SIGNS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
KINDS = {
    "eights": [(s, t, exchanged) for s, t in SIGNS for exchanged in (False, True)],
    "fours": [(s, t, False) for s, t in SIGNS],
    "turned twos": [(1, 1, False), (-1, -1, False)],
    "mirrored twos": [(1, 1, False), (-1, 1, False)],
    "ones": [(1, 1, False)],
}
"""Signs of x and z by which a row of each kind is its facets, and whether x and z are exchanged before."""


def turned(shape: Shape, seed: int = 3) -> Shape:
    """The same in another orientation."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    return shape_from_half_spaces("turned", np.column_stack([shape.planes[:, :3] @ turn.T, shape.planes[:, 3]]))


def pear() -> Shape:
    """Facets at random, and their images in one mirror."""
    half = np.random.default_rng(5).normal(size=(12, 3))
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    normals = np.concatenate([half, half * [1, 1, -1]])
    return turned(shape_from_half_spaces("pear", np.column_stack([normals, np.full(24, 0.8)])))


def from_file() -> Shape:
    """A turned brilliant as a file in single precision has it."""
    shape = turned(brilliant(), 4)
    surface = trimesh.Trimesh(shape.vertices, shape.triangles, process=False)
    file = surface.export(file_type="stl")
    assert isinstance(file, bytes)
    return shape_from_mesh(file, "stl", name="brilliant")


SHAPES: dict[str, Callable[[], Shape]] = {
    "brilliant": brilliant,
    "turned brilliant": lambda: turned(brilliant()),
    "brilliant from a file": from_file,
    "step cut": lambda: turned(step_cut()),
    "pear": pear,
    "box": box(0.5, 0.6, 0.7),
    "needle": box(1, 0.02, 0.02),
    "ball": ball(30),
}


def facets_of(rows: FacetRows) -> Array:
    """(N, 4) all that the rows stand for, in the shape's axes."""
    found = []
    for (first, last), ways in zip(zip((0, *rows.ends), rows.ends, strict=False), KINDS.values(), strict=True):
        for x, y, z, w in rows.rows[first:last]:
            normals = [(s * z, y, t * x) if exchanged else (s * x, y, t * z) for s, t, exchanged in ways]
            found += [(*(rows.axes @ normal), w) for normal in normals]
    return np.array(found)


@pytest.mark.parametrize("name", SHAPES)
def test_rows_stand_for_each_facet_and_nothing_else(name: str) -> None:
    shape = SHAPES[name]()
    rows = facet_rows(shape)
    apart = np.abs(facets_of(rows)[:, None] - rows.planes).max(axis=2)
    assert apart.min(axis=0).max() < 1e-12
    assert apart.min(axis=1).max() < 1e-12
    assert np.abs(rows.planes - shape.planes).max() < SAME
    assert np.linalg.norm(rows.rows[:, :3], axis=1) == pytest.approx(1, abs=1e-11)
    assert rows.axes.T @ rows.axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(rows.axes) == pytest.approx(1)


@pytest.mark.parametrize(
    ("name", "ends"),
    [
        # 73 facets: eight times eight, and the star's on axes and diagonals; the table
        ("brilliant", (9, 10, 10, 10, 11)),
        ("turned brilliant", (9, 10, 10, 10, 11)),
        ("brilliant from a file", (9, 10, 10, 10, 11)),
        ("pear", (0, 0, 0, 12, 12)),
        ("ball", (0, 0, 0, 0, 30)),
    ],
)
def test_symmetry_is_found_whatever_the_axes(name: str, ends: tuple[int, ...]) -> None:
    assert facet_rows(SHAPES[name]()).ends == ends


def exits(device: Device, shape: Shape, real: Real, lanes: int, rays: Array) -> tuple[Array, Array, Array]:
    """By facets and by rows, of (N, 6) rays inside: t (N, 2) and outward normals (N, 2, 3), and whether each hits."""
    rows = facet_rows(shape)
    text = culet_kernels.source("facet_rows.cl") + Path(__file__).with_name("exits.cl").read_text(encoding="utf-8")
    kernel = cl.Kernel(cl.Program(device.context, text).build([*FLAGS, *Variant(lanes, real).options]), "exits")
    out = np.zeros((len(rays) // lanes, 2, 5, lanes), real)
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR

    def upload(array: NDArray[Any]) -> cl.Buffer:
        return cl.Buffer(device.context, flags, hostbuf=np.ascontiguousarray(array))

    turn = np.kron(np.eye(2), rows.axes)
    result = upload(out)
    kernel(
        device.queue, (len(out),), (1,),
        upload(np.column_stack([rows.planes[:, :3] @ rows.axes, rows.planes[:, 3]]).astype(real)),
        np.int32(len(rows.planes)), upload(rows.data(real).astype(real)), upload(np.array(rows.ends, np.int32)),
        upload((rays @ turn).reshape(-1, lanes, 6).transpose(0, 2, 1).astype(real)), result,
    )  # fmt: skip
    cl.enqueue_copy(device.queue, out, result)
    found = out.transpose(0, 3, 1, 2).reshape(len(rays), 2, 5).astype(float)
    return found[..., 0], found[..., 1:4], found[..., 4] != 0


@pytest.mark.parametrize(("real", "lanes"), [*product((np.float32, np.float64), (1, 4, 8, 16))])
def test_light_leaves_where_it_does_by_the_facets(device: Device, real: Real, lanes: int) -> None:
    """From points inside and on facets, in directions all around. Where two facets are as near, either will do."""
    random = np.random.default_rng(1)
    for name, make in SHAPES.items():
        shape = make()
        corners = shape.vertices[random.integers(len(shape.vertices), size=(1600, 4))]
        inside = np.einsum("nk,nkx->nx", random.dirichlet(np.ones(4), 1600), corners)
        directions = random.normal(size=(1600, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        on_facets = exits(device, shape, np.float64, 8, np.hstack([inside, directions]))
        starts = np.concatenate([inside[:800], (inside + on_facets[0][:, :1] * directions)[800:]])
        towards = np.concatenate([directions[:800], -directions[800:]])
        t, normals, hits = exits(device, shape, real, lanes, np.hstack([starts, towards]))
        assert hits.all(), name
        rounding = 5e-6 if real is np.float32 else 2e-14  # measured 1.0e-6, 3.6e-15
        assert np.abs(t[:, 0] - t[:, 1]).max() < rounding, name
        other = np.abs(normals[:, 0] - normals[:, 1]).max(axis=1) > 1e-5
        assert other.mean() < 0.004, name  # at edges; measured 0.0019 in box and needle, next to none elsewhere


def test_symmetry_is_looked_for_before_a_picture_is_begun(renderer: Renderer) -> None:
    """It takes longer than a frame of a moving stone may."""
    stage = staged(legacy({}), turned(brilliant(), seed=71))
    renderer.make_ready(staged(legacy({})))  # all else is there
    assert not renderer.is_ready(stage)
    renderer.make_ready(stage)
    assert renderer.is_ready(stage)

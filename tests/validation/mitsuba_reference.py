"""Pictures of dielectric stones alone under a panorama, by Mitsuba 3: another program, another method.

Mitsuba's path tracer follows one random path at a time, where culet follows all parts of the light; it meets triangles
with another intersector, and its polarised variants carry full Mueller matrices. Its dielectric has one index. The
panorama is given to it with twice as many rows, so that both programs' bilinear lookups are one function.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from culet.geometry.shape import Shape
from culet.scene import Scene, StoneSettings

Array = NDArray[np.float64]

mitsuba: Any = pytest.importorskip(
    "mitsuba", reason="the comparison needs Mitsuba 3, which is not installed: pip install -e '.[validation]'"
)

drjit: Any = pytest.importorskip("drjit")  # which Mitsuba needs

BY_LANES = {False: "llvm_ad_rgb", True: "llvm_ad_spectral_polarized"}
"""Unpolarised and polarised: many paths at a time, compiled by LLVM, in 0.4 and 0.25 of the others' processor time."""
ONE_BY_ONE = {False: "scalar_rgb", True: "scalar_spectral_polarized"}
"""Of the same integrators, where there is no LLVM. The spectral one is the only scalar one that is polarised."""
LUMINANCE, SQUARED_LUMINANCE = 4, 7
"""Channels of the `moment` integrator's picture: the Y of X, Y, Z, and that of their squares."""
LONGEST = 256
"""Segments of a path: as good as endless, what is left after them is below 1e-6 of the light in these scenes."""


def variants() -> dict[bool, str]:
    """By whether light is polarised. `make validate` brings the LLVM that Dr.Jit needs, where it may."""
    return BY_LANES if drjit.has_backend(drjit.JitBackend.LLVM) else ONE_BY_ONE


@dataclass(frozen=True, eq=False)
class Reference:
    """A picture with its uncertainty."""

    mean: Array
    """(height, width) radiance."""
    variance: Array
    """(height, width) of the mean, from the samples' own spread."""
    samples: int


def twice_as_high(panorama: NDArray[np.float32]) -> NDArray[np.float32]:
    """A grey panorama (h, 2h) of culet's, as (2h + 1, 2h, 3) for Mitsuba.

    In both, columns have their centres at half numbers. culet's rows do too, but the first row of Mitsuba's `envmap`
    is the zenith itself and its last the nadir (Mitsuba 3.9). On a lattice of half the pitch every row's centre is a
    row of Mitsuba's, and so is every middle between two: a bilinear function is the same on a part of its cell. At a
    pole culet looks across to the other half of the row.
    """
    height, width = panorama.shape
    over_pole = np.vstack([np.roll(panorama[:1], width // 2, 1), panorama, np.roll(panorama[-1:], width // 2, 1)])
    fine = np.empty((2 * height + 1, width), np.float32)
    fine[0::2] = (over_pole[:-1] + over_pole[1:]) / 2
    fine[1::2] = panorama
    return np.repeat(fine[..., None], 3, axis=-1)


def reference(
    scene: Scene,
    shapes: Sequence[Shape],
    etas: Sequence[float],
    panorama: NDArray[np.float32],
    size: tuple[int, int],
    samples: int,
    seed: int = 0,
    *,
    polarised: bool = False,
) -> Reference:
    """The scene's camera looking at its stones, of these shapes and indices, under a grey panorama (h, 2h)."""
    mitsuba.set_variant(variants()[polarised])
    camera = scene.camera
    view = mitsuba.ScalarTransform4f().look_at(origin=camera.position, target=camera.target, up=camera.up)
    described = {
        "type": "scene",
        "integrator": {"type": "moment", "nested": {"type": "path", "max_depth": LONGEST, "rr_depth": LONGEST}},
        "sensor": {
            "type": "perspective", "fov_axis": "y", "fov": camera.fov_degrees, "to_world": view,
            "film": {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
        "sky": {"type": "envmap", "bitmap": mitsuba.Bitmap(twice_as_high(panorama))},
    }  # fmt: skip
    for number, (stone, shape, eta) in enumerate(zip(scene.stones, shapes, etas, strict=True)):
        described[f"stone {number}"] = _mesh(_placed(stone, shape), eta)
    moments = np.array(mitsuba.render(mitsuba.load_dict(described), spp=samples, seed=seed), np.float64)
    mean = moments[..., LUMINANCE]
    spread = np.maximum(moments[..., SQUARED_LUMINANCE] - mean**2, 0)
    return Reference(mean, spread / (samples - 1), samples)


def _placed(stone: StoneSettings, shape: Shape) -> trimesh.Trimesh:
    """Where, how turned and how large the scene has it. By scipy's rotation, whose quaternion begins with x."""
    w, x, y, z = stone.orientation
    vertices = Rotation.from_quat((x, y, z, w)).apply(stone.scale * shape.vertices) + stone.position
    return trimesh.Trimesh(vertices, shape.triangles, process=False)


def _mesh(stone: trimesh.Trimesh, eta: float) -> Any:  # noqa: ANN401 - Mitsuba is not typed
    """Flat triangles of glass."""
    properties = mitsuba.Properties()
    properties["glass"] = mitsuba.load_dict({"type": "dielectric", "int_ior": eta, "ext_ior": 1.0})
    properties["face_normals"] = True
    mesh = mitsuba.Mesh("stone", len(stone.vertices), len(stone.faces), props=properties)
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = stone.vertices.ravel().astype(np.float32)
    parameters["faces"] = stone.faces.ravel().astype(np.uint32)
    parameters.update()
    return mesh

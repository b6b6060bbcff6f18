"""The light that a stone throws on a floor, by Mitsuba 3's particle tracer: another program, another method.

A lamp that has the stone's silhouette shines in one direction; a pinhole between stone and floor looks straight down,
so that the image of the floor is the floor, scaled. The floor's albedo is next to none: what goes from the floor to the
stone and back, which culet leaves out, is not wanted here. With another albedo it is measured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from culet.geometry.shape import Shape
from culet.rendering.stones.placed_stone import PlacedStone
from culet.scene.room import FLOOR_Y
from validation.mitsuba_reference import Array, mitsuba

EYE = -0.2
"""R: height of the pinhole."""
LAMP_DISTANCE = 6.0
"""R from the stone's middle, against the light."""
LONGEST = 400
SEED = 1_000_003
"""Apart from run to run: Mitsuba gives each part of a run the next seed."""
DIM = 1e-3
"""Albedo of a floor that gives nothing back."""


@dataclass(frozen=True, eq=False)
class Particles:
    """Irradiance over that of a surface that faces the light, run by run."""

    runs: Array
    """(runs, rows, columns): row by z from below, column by x."""


def particles(
    stone: PlacedStone, eta: float, towards: Array, *, half: float, size: int, samples: int, runs: int,
    albedo: float = DIM,
) -> Particles:  # fmt: skip
    """The floor within `half` R of the origin, in `size` by `size` cells, under parallel light of 1 from `towards`."""
    mitsuba.set_variant("scalar_rgb")
    corners = stone.centre + stone.scale * (stone.shape.vertices @ stone.rotation.T)
    transform = mitsuba.ScalarTransform4f()
    scene = mitsuba.load_dict({
        "type": "scene",
        "integrator": {"type": "ptracer", "max_depth": LONGEST, "rr_depth": LONGEST, "hide_emitters": True},
        "sensor": {
            "type": "perspective", "fov": 2 * math.degrees(math.atan(half / (EYE - FLOOR_Y))), "near_clip": 0.01,
            "to_world": transform.look_at(origin=[0, EYE, 0], target=[0, FLOOR_Y, 0], up=[0, 0, -1]),
            "film": {
                "type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"},
                "pixel_format": "luminance",
            },
            "sampler": {"type": "independent"},
        },
        "floor": {
            "type": "rectangle",
            "to_world": transform.translate([0, FLOOR_Y, 0]).rotate([1, 0, 0], -90).scale(60),
            "bsdf": {"type": "diffuse", "reflectance": albedo},
        },
        "lamp": _lamp(corners, towards),
        "stone": _glass(corners, stone.shape, eta),
    })  # fmt: skip
    found = [
        np.array(mitsuba.render(scene, spp=samples, seed=SEED * (run + 1)), np.float64)[..., 0] * math.pi / albedo
        for run in range(runs)
    ]
    return Particles(np.array(found))


def _lamp(corners: Array, towards: Array) -> Any:  # noqa: ANN401 - Mitsuba is not typed
    """The outline of the stone as the light sees it, which shines straight at it."""
    way = -towards / np.linalg.norm(towards)
    across = np.cross(way, np.eye(3)[np.abs(way).argmin()])
    across /= np.linalg.norm(across)
    up = np.cross(way, across)  # across x up is the light's way
    outline = np.column_stack([corners @ across, corners @ up])
    ring = outline[ConvexHull(outline).vertices]  # counter-clockwise
    depth = float(corners.mean(axis=0) @ way) - LAMP_DISTANCE
    places = ring[:, :1] * across + ring[:, 1:] * up + depth * way
    fan = [(0, i, i + 1) for i in range(1, len(places) - 1)]
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict({"type": "diffuse", "reflectance": 0.0})
    properties["emitter"] = mitsuba.load_dict({"type": "directionalarea", "radiance": 1.0})
    return _flat("lamp", places, np.array(fan), properties)


def _glass(corners: Array, shape: Shape, eta: float) -> Any:  # noqa: ANN401
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict({"type": "dielectric", "int_ior": eta, "ext_ior": 1.0})
    return _flat("stone", corners, shape.triangles, properties)


def _flat(name: str, places: Array, triangles: Any, properties: Any) -> Any:  # noqa: ANN401
    properties["face_normals"] = True
    flat = trimesh.Trimesh(places, triangles, process=False)
    mesh = mitsuba.Mesh(name, len(flat.vertices), len(flat.faces), props=properties)
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = flat.vertices.ravel().astype(np.float32)
    parameters["faces"] = flat.faces.ravel().astype(np.uint32)
    parameters.update()
    return mesh

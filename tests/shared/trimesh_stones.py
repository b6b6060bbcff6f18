"""Stones made by trimesh alone, so that the simulation's tests do not lean on culet's own geometry."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache

import numpy as np
import trimesh

from culet.geometry.shape import MassProperties, Shape


def by_trimesh(name: str, mesh: trimesh.Trimesh) -> Shape:
    """Centred at its centre of mass, scaled to circumradius 1, planes of coplanar triangles merged."""
    centred = mesh.vertices - mesh.center_mass
    mesh = trimesh.Trimesh(centred / np.linalg.norm(centred, axis=1).max(), mesh.faces)
    normals = mesh.face_normals
    offsets = (normals * mesh.triangles[:, 0]).sum(axis=1)
    planes, facet_of_triangle = np.unique(np.c_[normals, offsets].round(9) + 0.0, axis=0, return_inverse=True)
    return Shape(
        name=name,
        vertices=np.asarray(mesh.vertices, np.float64),
        triangles=np.asarray(mesh.faces, np.int32),
        facet_of_triangle=facet_of_triangle.astype(np.int32),
        planes=planes,
        convex=bool(mesh.is_convex),
        mass=MassProperties(float(mesh.volume), np.asarray(mesh.moment_inertia / mesh.volume, np.float64)),
    )


@cache
def box() -> Shape:
    """Half edges 6/7, 3/7, 2/7: three different moments of inertia, 13/147, 40/147 and 45/147."""
    return by_trimesh("box", trimesh.creation.box((12 / 7, 6 / 7, 4 / 7)))


@cache
def exact_box() -> Shape:
    """Corners and tensor in closed form: trimesh's sums may round differently on another processor."""
    corners = np.array(list(itertools.product((-6 / 7, 6 / 7), (-3 / 7, 3 / 7), (-2 / 7, 2 / 7))))
    return replace(box(), vertices=corners, mass=MassProperties(box().mass.volume, np.diag([13, 40, 45]) / 147))


@cache
def double_cone() -> Shape:
    """A flat crown above a deep pavilion, 16-sided, axis y: the outline of a brilliant."""
    angles = np.arange(16) * (2 * np.pi / 16)
    girdle = np.c_[np.cos(angles), np.zeros(16), np.sin(angles)]
    hull = trimesh.convex.convex_hull(np.vstack([girdle, [[0, 0.35, 0], [0, -0.86, 0]]]))
    return by_trimesh("double cone", hull)


@cache
def ring() -> Shape:
    """A torus: not convex, and hollow where its centre of mass is."""
    return by_trimesh("ring", trimesh.creation.torus(0.7, 0.3, major_sections=16, minor_sections=8))


@cache
def ball() -> Shape:
    """A polyhedron of 2562 vertices: rolls like a sphere as far as it is one."""
    return by_trimesh("ball", trimesh.creation.icosphere(4))

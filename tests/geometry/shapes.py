"""Solids as polygons, and mesh files of them written by hand."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray

from culet.geometry.shape import Shape

Polygons = Sequence[Sequence[int]]
Points = NDArray[np.float64]


def cube() -> tuple[Points, Polygons]:
    """Side 2 about the origin, six quads wound outward."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
    return corners, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def prism(outline: Points, height: float) -> tuple[Points, Polygons]:
    """Over a counter-clockwise outline (N, 2) in x and y, from z = -height / 2 to height / 2; its ends are N-gons."""
    n = len(outline)
    corners = np.vstack([np.column_stack([outline, np.full(n, z)]) for z in (-height / 2, height / 2)])
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    return corners, [list(range(n))[::-1], list(range(n, 2 * n)), *sides]


def star_outline(points: int = 5, inner: float = 0.4) -> Points:
    """Outer radius 1."""
    angle = np.arange(2 * points) * math.pi / points
    radius = np.where(np.arange(2 * points) % 2, inner, 1.0)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def fans(polygons: Polygons) -> NDArray[np.int64]:
    """Triangles from each polygon's first corner, as mesh readers make them."""
    return np.array([(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)], np.int64)


def obj(corners: Points, polygons: Polygons) -> bytes:
    """Polygons kept, all digits kept."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
    lines += ["f " + " ".join(str(k + 1) for k in polygon) for polygon in polygons]
    return "\n".join([*lines, ""]).encode()


def off(corners: Points, polygons: Polygons) -> bytes:
    """Polygons kept, all digits kept."""
    lines = ["OFF", f"{len(corners)} {len(polygons)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
    lines += [" ".join(map(str, (len(p), *p))) for p in polygons]
    return "\n".join([*lines, ""]).encode()


def binary_ply(corners: Points, polygons: Polygons, *, big_endian: bool = False) -> bytes:
    """Double precision, each face a list of its own length."""
    order, name = (">", "big") if big_endian else ("<", "little")
    header = (
        f"ply\nformat binary_{name}_endian 1.0\nelement vertex {len(corners)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(polygons)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = [struct.pack(order + "3d", *corner) for corner in corners.tolist()]
    rows += [struct.pack(f"{order}B{len(p)}i", len(p), *p) for p in polygons]
    return header.encode() + b"".join(rows)


def stl(corners: Points, triangles: NDArray[np.int64]) -> bytes:
    """Binary: three corners a triangle, in single precision, nothing shared."""
    rows = [struct.pack("<12fH", 0, 0, 0, *corners[t].ravel(), 0) for t in triangles]
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def as_trimesh(stone: Shape) -> trimesh.Trimesh:
    """To export it."""
    return trimesh.Trimesh(stone.vertices, stone.triangles, process=False)


def exported(mesh: trimesh.Trimesh | trimesh.Scene, file_type: str) -> bytes:
    """Written by trimesh."""
    data = mesh.export(file_type=file_type)
    return data.encode() if isinstance(data, str) else bytes(data)


def said(stone: Shape, *words: str) -> bool:
    """Whether one of the findings holds all of these words."""
    return any(all(word in finding for word in words) for finding in stone.findings)

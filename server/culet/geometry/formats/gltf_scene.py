"""The meshes that a glTF scene shows, each moved to where the scene shows it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError, TooLargeError
from culet.geometry.formats.found import Found, MeshLimits, MeshPart, counted
from culet.geometry.formats.gltf_accessor import count_of, indices, positions

MAX_NODES = 10_000
"""Of a scene, and primitives that its nodes show: each takes some 50 microseconds."""

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


@dataclass(frozen=True, eq=False)
class _Shown:
    """A node that shows a mesh."""

    index: int
    node: dict[str, Any]
    matrix: NDArray[np.float64]
    """(4, 4) from the node to the scene."""


def parts_of(document: dict[str, Any], binary: bytes, limits: MeshLimits) -> Found:
    """A part for each primitive of triangles of each shown node.

    MeshError names what would move a corner and is not read.
    """
    notes: Counter[str] = Counter()
    shown = _shown_nodes(document, notes)
    meshes = document.get("meshes", [])
    total = primitives = 0
    for each in shown:
        mesh = each.node["mesh"]
        if not isinstance(mesh, int) or not 0 <= mesh < len(meshes):
            raise MeshError(f"glTF node {each.index} names mesh {mesh!r} of {len(meshes)}")
        primitives += len(meshes[mesh]["primitives"])
        if primitives > MAX_NODES:
            raise TooLargeError(f"expected at most {MAX_NODES} glTF primitives in the scene, got more")
        total += sum(_triangle_count(document, primitive) for primitive in meshes[mesh]["primitives"])
        limits.check_triangles(total)
    read: dict[int, list[MeshPart]] = {}
    points: dict[int, NDArray[np.float64]] = {}  # by accessor: primitives share them
    parts = []
    for each in shown:
        mesh = each.node["mesh"]
        _check_deformation(each, meshes[mesh], notes)
        if mesh not in read:
            read[mesh] = [
                part
                for primitive in meshes[mesh]["primitives"]
                if (part := _part(document, binary, primitive, points, limits, notes)) is not None
            ]
        parts += [_moved(part, each.matrix) for part in read[mesh]]
    if document.get("animations"):
        notes["animation"] += len(document["animations"])
    said = [f"{counted(number, kind, _PLURAL.get(kind, kind + 's'))}" for kind, number in sorted(notes.items())]
    return Found(tuple(parts), (f"Left out: {', '.join(said)}.",) if said else ())


_PLURAL = {"mesh of lines or points": "meshes of lines or points"}


def _shown_nodes(document: dict[str, Any], notes: Counter[str]) -> list[_Shown]:
    """Nodes with a mesh; each node has one parent, as the format demands, so that there is no cycle."""
    scenes, nodes = document.get("scenes", []), document.get("nodes", [])
    if not scenes:
        raise MeshError("glTF has no scene")
    waiting = [(index, np.eye(4)) for index in reversed(scenes[document.get("scene", 0)].get("nodes", []))]
    found: list[_Shown] = []
    seen: set[int] = set()
    while waiting:
        index, above = waiting.pop()
        if not isinstance(index, int) or not 0 <= index < len(nodes):
            raise MeshError(f"glTF names node {index!r} of {len(nodes)}")
        if index in seen:
            raise MeshError(f"glTF node {index} has two parents")
        seen.add(index)
        if len(seen) + len(waiting) > MAX_NODES:
            raise TooLargeError(f"expected at most {MAX_NODES} glTF nodes, got more")
        node = nodes[index]
        extensions = node.get("extensions", {})
        if not extensions.get("KHR_node_visibility", {}).get("visible", True):
            notes["hidden node"] += 1
            continue
        matrix = above @ _matrix(node, index)
        if "mesh" in node:
            if "EXT_mesh_gpu_instancing" in extensions:
                notes["node's repetition of its mesh (EXT_mesh_gpu_instancing)"] += 1
            found.append(_Shown(index, node, matrix))
        waiting += [(child, matrix) for child in reversed(node.get("children", []))]
    return found


def _matrix(node: dict[str, Any], index: int) -> NDArray[np.float64]:
    """(4, 4) from the node to its parent: its matrix, stored by columns, or translation x rotation x scale."""
    if "matrix" in node:
        matrix: NDArray[np.float64] = np.array(node["matrix"], np.float64).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1)):
            raise MeshError(f"glTF node {index} has a matrix whose last row is {matrix[3].tolist()}, expected 0 0 0 1")
        return matrix
    matrix = np.eye(4)
    if "rotation" in node:
        matrix[:3, :3] = _turn(node["rotation"], index)
    matrix[:3, :3] *= np.array(node.get("scale", (1, 1, 1)), np.float64).reshape(3)
    matrix[:3, 3] = np.array(node.get("translation", (0, 0, 0)), np.float64).reshape(3)
    return matrix


def _turn(rotation: list[float], index: int) -> NDArray[np.float64]:
    """(3, 3) of a quaternion x, y, z, w, which writers round."""
    quaternion = np.array(rotation, np.float64).reshape(4)
    length = float(np.linalg.norm(quaternion))
    if not abs(length - 1) < 0.01:
        raise MeshError(f"glTF node {index} has a rotation of length {length:.3g}, expected 1")
    x, y, z, w = quaternion / length
    return np.array([
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    ])  # fmt: skip


def _check_deformation(shown: _Shown, mesh: dict[str, Any], notes: Counter[str]) -> None:
    """MeshError if a skin or a morph target moves the mesh's corners."""
    skinned = any("JOINTS_0" in primitive["attributes"] for primitive in mesh["primitives"])
    if "skin" in shown.node and skinned:
        raise MeshError(
            f"glTF node {shown.index} has a skin, whose joints move its corners; that is not read: apply it, and "
            "export again"
        )
    targets = max((len(primitive.get("targets", [])) for primitive in mesh["primitives"]), default=0)
    if targets:
        weights = shown.node.get("weights", mesh.get("weights", []))
        if any(weight != 0 for weight in weights):
            raise MeshError(
                f"glTF node {shown.index} has morph targets with weights {weights[:8]}, which move its corners; that "
                "is not read: apply them, and export again"
            )
        notes["morph target of weight 0"] += targets


def _triangle_count(document: dict[str, Any], primitive: dict[str, Any]) -> int:
    source = primitive.get("indices", primitive["attributes"].get("POSITION"))
    corners = 0 if source is None else count_of(document, source)
    mode = primitive.get("mode", _TRIANGLES)
    if mode == _TRIANGLES:
        return corners // 3
    return max(corners - 2, 0) if mode in {_STRIP, _FAN} else 0


def _part(
    document: dict[str, Any],
    binary: bytes,
    primitive: dict[str, Any],
    read: dict[int, NDArray[np.float64]],
    limits: MeshLimits,
    notes: Counter[str],
) -> MeshPart | None:
    """The triangles of a primitive, on the vertices that they use; None if it has none."""
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in {_TRIANGLES, _STRIP, _FAN}:
        notes["mesh of lines or points"] += 1
        return None
    if "POSITION" not in primitive["attributes"]:
        notes["mesh without positions"] += 1
        return None
    source = primitive["attributes"]["POSITION"]
    if source not in read:
        read[source] = positions(document, binary, source, limits.vertices)
    points = read[source]
    if "indices" in primitive:
        order = indices(document, binary, primitive["indices"], limits.vertices)
    else:
        order = np.arange(len(points))
    if len(order) and int(order.max()) >= len(points):
        raise MeshError(f"a face names vertex {int(order.max())} of {len(points)}")
    used, compact = np.unique(_corners(order, mode), return_inverse=True)
    return MeshPart(points[used], compact.reshape(-1, 3))


def _corners(order: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """(T, 3): section 3.7.2.1 of the specification; every second triangle of a strip is wound the other way."""
    if mode == _TRIANGLES:
        if len(order) % 3:
            raise MeshError(f"glTF has triangles of {len(order)} corners, which is no multiple of 3")
        return order.reshape(-1, 3)
    k = np.arange(max(len(order) - 2, 0))
    if mode == _FAN:
        return np.column_stack([order[k + 1], order[k + 2], np.broadcast_to(order[:1], k.shape)])
    return np.column_stack([order[k], order[k + 1 + k % 2], order[k + 2 - k % 2]])


def _moved(part: MeshPart, matrix: NDArray[np.float64]) -> MeshPart:
    """In the scene, wound the same way if the matrix mirrors."""
    with np.errstate(all="ignore"):  # what is not finite is refused later, by name
        vertices = part.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return MeshPart(vertices, part.triangles[:, ::-1] if mirrored else part.triangles)

"""Binary glTF: everything that may change where a corner is is read, told, or refused by name."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from culet.errors import MeshError, TooLargeError
from culet.geometry.formats import read_triangles
from culet.geometry.formats.reader import Soup
from culet.geometry.mesh import shape_from_mesh
from geometry.gltf import Document
from geometry.shapes import cube, fans, said

WILD = Path(__file__).with_name("wild")
CORNERS, FACES = cube()
TRIANGLES = fans(FACES).astype(np.uint16)
FLAT = TRIANGLES.reshape(-1)


def read(document: Document) -> Soup:
    return read_triangles(document.data(), "glb", max_triangles=10_000, max_bytes=1 << 20)


def corners_of(soup: Soup) -> set[tuple[float, ...]]:
    return {tuple(np.round(row, 6).tolist()) for row in soup.vertices[soup.triangles.reshape(-1)]}


def rows(points: np.ndarray) -> set[tuple[float, ...]]:
    return {tuple(np.round(row, 6).tolist()) for row in np.asarray(points, np.float64)}


def test_two_quantised_bodies_stay_where_their_nodes_put_them() -> None:
    """Two halves of a box side by side, each -1 to 1 as normalised shorts: taken for lengths, each is 65 000 wide."""
    stone = shape_from_mesh((WILD / "two_quant_norm.glb").read_bytes(), "glb")
    assert said(stone, "4 triangles of inner walls: dropped")
    assert stone.mass.volume == pytest.approx(2 * 1 * 1 / 1.5**1.5)  # a box of 2 x 1 x 1, its half diagonal sqrt(1.5)


@pytest.mark.parametrize("name", ["int8", "uint8", "int16", "uint16"])
@pytest.mark.parametrize("normalized", [True, False])
def test_quantised_positions_are_the_numbers_that_they_stand_for(name: str, normalized: bool) -> None:
    """Section 3.11: the largest integer stands for 1, and of the signed ones the two smallest for -1."""
    kind = np.dtype(name)
    low, high = (np.iinfo(kind).min, np.iinfo(kind).max) if kind.kind == "i" else (0, np.iinfo(kind).max)
    stored = np.where(CORNERS > 0, high, low).astype(kind)
    document = Document()
    document.show(document.mesh(document.accessor(stored, stride=8, normalized=normalized), document.accessor(FLAT)))
    document.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    least = (-1.0 if kind.kind == "i" else 0.0) if normalized else float(low)
    assert corners_of(read(document)) == rows(np.where(CORNERS > 0, 1.0 if normalized else float(high), least))


def test_sparse_items_replace_those_of_the_buffer_and_zeros() -> None:
    wanted = CORNERS.astype(np.float32)
    for base in (wanted.copy(), None):
        document = Document()
        moved = wanted.copy() if base is not None else np.zeros_like(wanted)
        places = np.array([1, 6] if base is not None else range(8), np.uint16)
        values = (wanted * 3)[places]
        moved[places] = values
        sparse: dict[str, Any] = {
            "count": len(places),
            "indices": {"bufferView": document.view(places.tobytes()), "componentType": 5123},
            "values": {"bufferView": document.view(values.tobytes())},
        }
        position = document.describe(wanted, sparse=sparse) if base is None else document.accessor(base, sparse=sparse)
        document.show(document.mesh(position, document.accessor(FLAT)))
        assert corners_of(read(document)) == rows(moved)


@pytest.mark.parametrize("stride", [12, 16, 40])
def test_strides_are_stepped_over(stride: int) -> None:
    document = Document()
    document.show(document.mesh(document.accessor(CORNERS.astype(np.float32), stride=stride), document.accessor(FLAT)))
    assert corners_of(read(document)) == rows(CORNERS)


@pytest.mark.parametrize("name", ["uint8", "uint16", "uint32"])
def test_indices_of_every_type_are_read(name: str) -> None:
    document = Document()
    document.show(document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT.astype(name))))
    assert (read(document).triangles == TRIANGLES).all()


def test_strips_and_fans_are_wound_as_the_specification_says() -> None:
    """Section 3.7.2.1, of five corners: a strip's second triangle is turned, a fan's first corner comes last."""
    for mode, wanted in ((5, [(0, 1, 2), (1, 3, 2), (2, 3, 4)]), (6, [(1, 2, 0), (2, 3, 0), (3, 4, 0)])):
        document = Document()
        document.show(document.mesh(document.accessor(CORNERS[:5].astype(np.float32)), mode=mode))
        assert read(document).triangles.tolist() == [list(triangle) for triangle in wanted]


def test_transforms_of_nodes_add_up_as_the_specification_orders_them() -> None:
    """Translation x rotation x scale, the parent's before the child's: x = 1 becomes 2, a quarter turn about z, + 5."""
    document = Document()
    mesh = document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT))
    half = float(np.sqrt(0.5))
    document.show(mesh, scale=[2, 3, 4])
    matrix = np.array([(0, -1, 0, 5), (1, 0, 0, 6), (0, 0, 1, 7), (0, 0, 0, 1)], np.float64)
    document.json["nodes"] += [
        {"translation": [5, 6, 7], "rotation": [0, 0, half, half], "children": [0]},
        {"matrix": matrix.T.reshape(-1).tolist(), "children": [0], "camera": 0},
    ]
    wanted = (CORNERS * [2, 3, 4]) @ matrix[:3, :3].T + matrix[:3, 3]
    for root in (1, 2):
        document.json["scenes"][0]["nodes"] = [root]
        assert corners_of(read(document)) == rows(wanted)


def test_a_node_that_is_also_a_camera_is_shown() -> None:
    document = Document()
    mesh = document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT))
    document.show(mesh, camera=0, scale=[2, 2, 2])
    assert corners_of(read(document)) == rows(CORNERS * 2)


def test_hidden_nodes_are_left_out_with_their_children() -> None:
    document = Document()
    mesh = document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT))
    document.show(mesh)
    document.show(mesh, scale=[9, 9, 9], extensions={"KHR_node_visibility": {"visible": False}}, children=[2])
    document.json["nodes"].append({"mesh": mesh, "scale": [3, 3, 3]})
    document.json["extensionsRequired"] = ["KHR_node_visibility"]
    soup = read(document)
    assert corners_of(soup) == rows(CORNERS)
    assert soup.findings == ("Left out: 1 hidden node.",)


def test_what_is_left_out_is_told() -> None:
    document = Document()
    position = document.accessor(CORNERS.astype(np.float32))
    document.show(document.mesh(position, document.accessor(FLAT), targets=[{"POSITION": position}]))
    document.show(document.mesh(position, mode=1))
    document.json["animations"] = [{}, {}]
    assert read(document).findings == (
        "Left out: 2 animations, 1 mesh of lines or points, 1 morph target of weight 0.",
    )


def morphed(document: Document) -> None:
    document.json["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}]
    document.json["nodes"][0]["weights"] = [0.5]


def skinned(document: Document) -> None:
    document.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 0
    document.json["nodes"][0]["skin"] = 0


def extension(key: str, name: str) -> Callable[[Document], object]:
    return lambda document: document.json.__setitem__(key, [name])


def accessor(**more: object) -> Callable[[Document], object]:
    return lambda document: document.json["accessors"][0].update(more)


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (morphed, "node 0 has morph targets with weights"),
        (skinned, "node 0 has a skin"),
        (extension("extensionsUsed", "KHR_draco_mesh_compression"), "uses KHR_draco_mesh_compression"),
        (extension("extensionsUsed", "EXT_meshopt_compression"), "uses EXT_meshopt_compression"),
        (extension("extensionsRequired", "ACME_curves"), "requires 'ACME_curves', which is not read"),
        (extension("extensionsRequired", "EXT_mesh_gpu_instancing"), "requires 'EXT_mesh_gpu_instancing'"),
        (accessor(type="VEC4"), "positions of type VEC4"),
        (accessor(componentType=5125), "component type 5125"),
        (accessor(bufferView=7), "names bufferViews 7 of 2"),
        (accessor(byteOffset=4), "needs 100 bytes of a buffer view; got 96"),
        (lambda d: d.json["nodes"][0].update(rotation=[0, 0, 0, 0]), "rotation of length 0"),
        (lambda d: d.json["nodes"][0].update(matrix=[1] * 16), "expected 0 0 0 1"),
    ],
)
def test_what_would_move_a_corner_and_is_not_read_is_refused_by_name(
    change: Callable[[Document], object], cause: str
) -> None:
    document = Document()
    document.show(document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT)))
    assert corners_of(read(document)) == rows(CORNERS)
    change(document)
    with pytest.raises(MeshError, match=cause):
        read(document)


@pytest.mark.parametrize("name", ["KHR_materials_ior", "KHR_texture_transform", "KHR_lights_punctual"])
def test_extensions_of_the_look_alone_may_be_required(name: str) -> None:
    document = Document()
    document.show(document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT)))
    document.json["extensionsRequired"] = [name]
    assert corners_of(read(document)) == rows(CORNERS)


def test_a_file_that_is_cut_off_says_so() -> None:
    document = Document()
    document.show(document.mesh(document.accessor(CORNERS.astype(np.float32)), document.accessor(FLAT)))
    data = document.data()
    with pytest.raises(MeshError, match=f"announces {len(data)} bytes, got {len(data) - 8}: the file is cut off"):
        shape_from_mesh(data[:-8], "glb")
    shorter = struct.pack("<4sII", b"glTF", 2, len(data) - 8) + data[12:-8]  # its header mended, its chunk not
    with pytest.raises(MeshError, match="binary chunk of 168 bytes, got 160: the file is cut off"):
        shape_from_mesh(shorter, "glb")


def test_many_nodes_of_a_mesh_with_few_triangles_and_many_vertices_take_no_memory() -> None:
    """A thousand nodes would hold 24 million corners if those that no triangle uses were taken along."""
    document = Document()
    many = np.zeros((24_000, 3), np.float32)
    many[:3] = CORNERS[:3]
    mesh = document.mesh(document.accessor(many), document.accessor(FLAT[:3]))
    for _ in range(1000):
        document.show(mesh)
    assert len(read(document).vertices) == 3000


def test_zeros_that_no_buffer_holds_are_bounded() -> None:
    document = Document()
    document.show(document.mesh(document.describe(np.zeros((0, 3), np.float32)), document.accessor(FLAT)))
    document.json["accessors"][0]["count"] = 10**12
    with pytest.raises((MeshError, TooLargeError), match="claims 1000000000000 items; expected at most 30000"):
        read(document)

"""Every format, read from memory: round trips, polygons, and what is refused before work begins."""

from __future__ import annotations

import json
import re
import struct
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh

from culet.errors import MeshError, TooLargeError
from culet.geometry.brilliant import brilliant
from culet.geometry.formats import FORMATS
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.polygons import edges_of_facets
from culet.scene.cuts import BrilliantCut
from geometry.shapes import as_trimesh, binary_ply, cube, exported, fans, obj, off, prism, said, star_outline, stl

BRILLIANT = brilliant(BrilliantCut())
STAR_AREA = 10 * 0.5 * 0.4 * np.sin(np.pi / 5)  # ten triangles between the centre, a tip and a notch


def matched(found: np.ndarray, wanted: np.ndarray) -> float:
    """Largest distance from a wanted point to the nearest found one."""
    return float(np.linalg.norm(wanted[:, None] - found[None], axis=2).min(axis=1).max())


@pytest.mark.parametrize("written", [*FORMATS, "stl_ascii"])
def test_the_brilliant_comes_back_from_every_format(written: str) -> None:
    stone = shape_from_mesh(exported(as_trimesh(BRILLIANT), written), written[:3])
    assert stone.convex
    assert (len(stone.planes), len(stone.vertices), len(edges_of_facets(stone))) == (73, 57, 128)
    assert matched(stone.vertices, BRILLIANT.vertices) < 3e-7  # measured 5e-8: single precision
    assert matched(stone.planes, BRILLIANT.planes) < 3e-6  # measured 4.1e-7: normals of the small facets
    assert stone.mass.volume == pytest.approx(BRILLIANT.mass.volume, rel=1e-6)
    assert stone.mass.inertia == pytest.approx(BRILLIANT.mass.inertia, abs=1e-6)


@pytest.mark.parametrize("written", [*FORMATS, "stl_ascii"])
def test_the_half_spaces_hold_every_vertex_and_touch_the_stone(written: str) -> None:
    stone = shape_from_mesh(exported(as_trimesh(BRILLIANT), written), written[:3])
    height = stone.vertices @ stone.planes[:, :3].T - stone.planes[:, 3]
    assert height.max() < 1e-12  # supporting: measured 4e-16
    assert abs(height.max(axis=0)).max() < 1e-12
    corners = stone.vertices[stone.triangles]
    own = stone.planes[stone.facet_of_triangle]
    assert abs(np.einsum("tkj,tj->tk", corners, own[:, :3]) - own[:, 3:]).max() < 2e-6  # measured 2.4e-7


@pytest.mark.parametrize(
    ("file_type", "data"),
    [
        ("obj", obj(*prism(star_outline(), 0.6))),
        ("off", off(*prism(star_outline(), 0.6))),
        ("ply", binary_ply(*prism(star_outline(), 0.6))),
        ("ply", binary_ply(*prism(star_outline(), 0.6), big_endian=True)),
        ("stl", stl(prism(star_outline(), 0.6)[0], fans(prism(star_outline(), 0.6)[1]))),
    ],
    ids=["obj", "off", "ply little", "ply big", "stl"],
)
def test_concave_ten_sided_faces_are_cut_without_folds(file_type: str, data: bytes) -> None:
    """A fan from a tip covers ground outside the star; the areas of the ends add up only when it was cut again."""
    stone = shape_from_mesh(data, file_type)
    assert not stone.convex
    assert (len(stone.planes), len(edges_of_facets(stone))) == (12, 30)
    a, b, c = (stone.vertices[stone.triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    radius = np.hypot(1, 0.3)
    ends = abs(stone.planes[stone.facet_of_triangle, 2]) > 0.99
    assert area[ends].sum() * radius**2 == pytest.approx(2 * STAR_AREA, rel=1e-6)
    assert stone.mass.volume * radius**3 == pytest.approx(0.6 * STAR_AREA, rel=1e-6)


def test_an_l_shaped_prism_with_corners_in_a_line_keeps_its_surface_whole() -> None:
    outline = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)], np.float64)
    for turn in range(8):
        corners, faces = prism(outline, 1)
        stone = shape_from_mesh(obj(corners, [list(np.roll(face, turn)) for face in faces]), "obj")
        assert not stone.convex
        assert len(stone.planes) == 8
        a, b, c = (stone.vertices[stone.triangles[:, k]] for k in range(3))
        assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 0.1
        scale = stone.mass.volume / 3  # the L covers 3
        assert scale == pytest.approx(np.linalg.norm(stone.vertices[1] - stone.vertices[0]) ** 3, rel=1e-6)


def test_obj_indices_may_be_negative_slashed_and_continued() -> None:
    corners, faces = cube()
    lines = [f"v\t{x} {y} {z} 0.5 0.5 0.5" for x, y, z in corners] + ["vn 0 0 1", "vt 0 0"]
    lines += ["mtllib /etc/passwd", "usemtl a"]
    lines += [f"f {a - 8}/1/1 {b - 8}/1/1 \\\n {c - 8}//1 {d + 1}" for a, b, c, d in faces]
    lines += ["v 9 9 9", "usemtl b", "o another"]
    stone = shape_from_mesh("\r\n".join(lines).encode(), "obj")
    assert stone.convex
    assert len(stone.planes) == 6
    assert said(stone, "1 vertex that no face uses left out")
    assert abs(stone.vertices) == pytest.approx(np.full((8, 3), 3**-0.5))


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_names_and_comments_may_be_in_any_encoding(encoding: str) -> None:
    name = "Brillant für Zoë".encode(encoding)
    mesh = as_trimesh(BRILLIANT)
    files = {
        "obj": b"# " + name + b"\no " + name + b"\n" + exported(mesh, "obj"),
        "off": exported(mesh, "off").replace(b"OFF\n", b"OFF\n# " + name + b"\n", 1),
        "stl": b"solid " + name + exported(mesh, "stl_ascii").split(b"solid", 1)[1],
        "ply": exported(mesh, "ply").replace(b"element", b"comment " + name + b"\nelement", 1),
    }
    for file_type, data in files.items():
        assert len(shape_from_mesh(data, file_type).planes) == 73


def test_duplicate_vertices_are_joined_and_said() -> None:
    corners, faces = cube()
    loose = np.vstack([corners[face] for face in faces])
    stone = shape_from_mesh(binary_ply(loose, [[4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3] for k in range(6)]), "ply")
    assert (len(stone.vertices), len(stone.planes)) == (8, 6)
    assert said(stone, "24 vertices, 8 of them distinct")


def test_a_scene_graphs_transforms_are_applied() -> None:
    scene = trimesh.Scene()
    turn = np.array([(0, -1, 0, 4), (1, 0, 0, 5), (0, 0, 1, 6), (0, 0, 0, 1)], np.float64)
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), transform=turn)
    scene.add_geometry(as_trimesh(BRILLIANT), transform=np.diag([3, 3, 3, 1]))
    stone = shape_from_mesh(exported(scene, "glb"), "glb")
    assert matched(stone.vertices, BRILLIANT.vertices) < 3e-7
    assert said(stone, "2 meshes")
    assert said(stone, "2 bodies", "largest closed one by volume", "110 triangles", "1 smaller closed body left out")


def test_a_mirrored_node_is_not_inside_out() -> None:
    scene = trimesh.Scene()
    scene.add_geometry(as_trimesh(BRILLIANT), transform=np.diag([-1, 1, 2, 1]))
    stone = shape_from_mesh(exported(scene, "glb"), "glb")
    assert stone.convex
    assert not said(stone, "inside out")


def glb(document: dict[str, object], binary: bytes = b"") -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def test_no_other_file_is_ever_opened(tmp_path: Path) -> None:
    buffer = tmp_path / "mesh.bin"
    buffer.write_bytes(bytes(36))
    for uri in (str(buffer), "file://" + str(buffer), "data:;base64,AAAA"):
        with pytest.raises(MeshError, match="refers to another file"):
            shape_from_mesh(glb({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 36}]}), "glb")


POSITION = {"componentType": 5126, "type": "VEC3", "bufferView": 0}


def one_mesh(count: int, nodes: Sequence[Mapping[str, object]], **more: object) -> bytes:
    document: dict[str, object] = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{**POSITION, "count": count}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}],
        **more,
    }
    return glb(document, bytes(36))


@pytest.mark.parametrize(
    ("data", "error", "message"),
    [
        (one_mesh(3, [{"children": [1]}, {"children": [0]}]), MeshError, "two parents"),
        (one_mesh(10**9, [{"mesh": 0}]), TooLargeError, "at most 200000 triangles"),
        (one_mesh(300_000, [{"mesh": 0}]), MeshError, "needs 3600000 bytes of a buffer view; got 36"),
        (one_mesh(3, [{"mesh": 0}], extensionsUsed=["KHR_draco_mesh_compression"]), MeshError, "draco"),
        (one_mesh(3, [{"mesh": 0}], accessors=[{**POSITION, "count": 3, "sparse": {}}]), MeshError, "malformed"),
        (one_mesh(3, [{"mesh": 5}]), MeshError, "node 0 names mesh 5 of 1"),
        (one_mesh(3, [{"mesh": 0}], scenes=[]), MeshError, "no scene"),
        (one_mesh(3, [{"children": list(range(1, 20_001))}, *[{"mesh": 0}] * 20_000]), TooLargeError, "nodes"),
    ],
    ids=["cycle", "count", "buffer", "draco", "sparse", "index", "no scene", "many nodes"],
)
def test_a_glb_that_lies_is_refused(data: bytes, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        shape_from_mesh(data, "glb")


@pytest.mark.parametrize(
    ("file_type", "data", "message"),
    [
        ("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4: vertex index '0' is out of range"),
        ("obj", b"v 0 0 0\nf -2 1 1\n", "line 2: vertex index '-2' is out of range"),
        ("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", "a face names vertex 7 of 3"),
        ("obj", b"v 0 0\n", "line 1: expected v x y z"),
        ("obj", b"v 0 0 0\nf 1 1\n", "line 2: expected a face of 3 corners"),
        ("obj", b"v 0 0 0\nf a b c\n", "line 2: expected a vertex index"),
        ("obj", b"v 0 0 x\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1: expected a number, got 'x'"),
        (
            "off",
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n",
            "expected 3 vertices and 1 faces, a line each; the file ends in line 5 with 3 and 0",
        ),
        ("off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "line 6: expected a number of corners"),
        ("off", b"OFF\nmany\n", "numbers of vertices and faces"),
        ("off", b"obj\n", "expected OFF, got 'obj"),
        ("ply", b"ply\nformat ascii 1.0\n", "expected a PLY header"),
        ("ply", b"ply\nformat other 1.0\nend_header\n", "PLY format 'other' is not known"),
        ("ply", b"ply\nformat ascii 1.0\nelement vertex -5\nend_header\n", "cannot be understood"),
        ("ply", binary_ply(*cube())[:-1], "the file is cut off: it ends within its rows of face, after 5 of 6"),
        ("ply", binary_ply(*cube())[:200], "the file is cut off: it ends within its rows of vertex, after"),
        ("glb", b"glTF", "expected a GLB header of 20 bytes, got 4"),
        ("glb", bytes(64), "expected binary glTF 2.0"),
        ("stl", b"solid nothing\nendsolid nothing\n", "the mesh is empty: no triangles"),
        ("stl", b"not a mesh at all", "expected text from 'solid' to 'endsolid', or binary"),
        ("obj", b" \n ", "the file is empty"),
        ("obj", b"# nothing\n", "expected polygons (f), got 0 vertices without any"),
        ("3mf", b"PK", "expected a mesh of type obj, off, stl, ply, glb, got '3mf'"),
    ],
)
def test_what_is_not_a_mesh_is_refused_by_name(file_type: str, data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        shape_from_mesh(data, file_type)


def big_ply(faces: int) -> bytes:
    header = f"ply\nformat ascii 1.0\nelement vertex 3\nelement face {faces}\nend_header\n"
    return header.encode()


MILLION = 1_000_000


@pytest.mark.parametrize(
    ("file_type", "data"),
    [
        ("obj", b"v 0 0 0\n" + b"f 1 1 1\n" * MILLION),
        ("obj", b"v 0 0 0\nf" + b" 1" * MILLION),
        ("off", b"OFF\n3 1000000 0\n"),
        ("off", b"OFF\n1 1 0\n0 0 0\n1000000" + b" 0" * MILLION),
        ("stl", bytes(80) + struct.pack("<I", MILLION) + bytes(50 * MILLION)),
        ("stl", b"solid\n" + b"facet\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendfacet\n" * MILLION),
        ("ply", big_ply(MILLION)),
        ("glb", one_mesh(3, [{"children": list(range(1, 9))}, *[{"mesh": 0}] * 8])),
    ],
    ids=["obj faces", "obj polygon", "off header", "off polygon", "stl", "stl text", "ply", "glb instances"],
)
def test_too_many_triangles_are_refused_before_work(file_type: str, data: bytes) -> None:
    limit = 7 if file_type == "glb" else 200_000
    start = time.process_time()
    with pytest.raises(TooLargeError, match=f"at most {limit} triangles"):
        shape_from_mesh(data, file_type, max_triangles=limit)
    assert time.process_time() - start < 20  # measured 0.35 s, obj faces


def test_too_many_bytes_are_refused() -> None:
    with pytest.raises(TooLargeError, match="at most 1000 bytes, got 5584"):
        shape_from_mesh(exported(as_trimesh(BRILLIANT), "stl"), "stl", max_bytes=1000)


@pytest.mark.parametrize("file_type", FORMATS)
def test_random_bytes_are_refused_and_never_crash(file_type: str) -> None:
    random = np.random.default_rng(11)
    starts = {
        "obj": b"v 0 0 0\nf ",
        "off": b"OFF\n",
        "stl": b"solid ",
        "ply": big_ply(2),
        "glb": b"glTF\x02\0\0\0",
    }
    for size in (1, 7, 83, 84, 200, 3000):
        for start in (b"", starts[file_type]):
            with pytest.raises((MeshError, TooLargeError)):
                shape_from_mesh(start + random.bytes(size), file_type)


@pytest.mark.parametrize("file_type", FORMATS)
def test_damaged_files_are_stones_or_refused(file_type: str) -> None:
    """A byte changed, removed or cut away: a MeshError, or a stone that keeps its promises; nothing else."""
    random = np.random.default_rng(12)
    good = exported(as_trimesh(BRILLIANT), file_type)
    refused = 0
    for _ in range(60):
        data = bytearray(good)
        match random.integers(3):
            case 0:
                data[random.integers(len(data))] = random.integers(256)
            case 1:
                del data[random.integers(len(data))]
            case _:
                del data[random.integers(len(data)) :]
        try:
            stone = shape_from_mesh(bytes(data), file_type)
        except (MeshError, TooLargeError):
            refused += 1
            continue
        assert np.isfinite(stone.vertices).all()
        assert stone.mass.volume > 0
        if stone.convex:
            assert (stone.vertices @ stone.planes[:, :3].T - stone.planes[:, 3]).max() < 1e-12
    assert refused >= 15  # measured 26 to 47: a third of the files lack their end

"""Text of meshes: encodings, numbers and lines, and what each format has besides polygons."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

import numpy as np
import pytest

from culet.errors import MeshError, TooLargeError
from culet.geometry.formats import read_triangles
from culet.geometry.formats.reader import Soup
from culet.geometry.mesh import shape_from_mesh
from geometry.shapes import binary_ply, cube, fans, obj, off, said, stl

WILD = Path(__file__).with_name("wild")
CORNERS, FACES = cube()
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def read(data: bytes, file_type: str) -> Soup:
    return read_triangles(data, file_type, max_triangles=1000, max_bytes=1 << 26)


def text_ply() -> bytes:
    header = (
        f"ply\nformat ascii 1.0\nelement vertex {len(CORNERS)}\nproperty double x\nproperty double y\n"
        f"property double z\nelement face {len(FACES)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = [" ".join(map(str, corner)) for corner in CORNERS.tolist()]
    rows += [" ".join(map(str, (len(face), *face))) for face in FACES]
    return "\n".join([header.rstrip("\n"), *rows, ""]).encode()


def text_stl() -> bytes:
    lines = ["solid cube"]
    for triangle in fans(FACES):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(str, CORNERS[corner].tolist())) for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid cube", ""]).encode()


TEXTS = {"obj": obj(CORNERS, FACES), "off": off(CORNERS, FACES), "stl": text_stl(), "ply": text_ply()}


# Encodings


@pytest.mark.parametrize("file_type", TEXTS)
@pytest.mark.parametrize(
    ("mark", "encoding"),
    [
        (codecs.BOM_UTF8, "utf-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le"),
        (codecs.BOM_UTF16_BE, "utf-16-be"),
        (codecs.BOM_UTF32_LE, "utf-32-le"),
        (codecs.BOM_UTF32_BE, "utf-32-be"),
    ],
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_byte_order_mark_tells_the_encoding(file_type: str, mark: bytes, encoding: str, end: str) -> None:
    plain = read(TEXTS[file_type], file_type)
    text = TEXTS[file_type].decode().replace("\n", end)
    marked = read(mark + text.encode(encoding), file_type)
    assert (marked.vertices == plain.vertices).all()
    assert (marked.triangles == plain.triangles).all()


def test_the_obj_in_utf_16_is_read() -> None:
    stone = shape_from_mesh((WILD / "obj_utf16.obj").read_bytes(), "obj")
    assert said(stone, "Convex: 12 triangles in the file")


@pytest.mark.parametrize("file_type", ["obj", "off"])
def test_text_in_utf_16_without_its_mark_is_refused_as_that(file_type: str) -> None:
    with pytest.raises(MeshError, match="line 1: expected text, got a zero byte: UTF-16 without a byte order mark"):
        read(TEXTS[file_type].decode().encode("utf-16-le"), file_type)


def test_a_mark_that_lies_is_refused_at_its_byte() -> None:
    with pytest.raises(MeshError, match="the byte order mark says UTF-16, but byte 4 is not UTF-16"):
        read(codecs.BOM_UTF16_LE + b"v \x00", "obj")
    with pytest.raises(MeshError, match="the byte order mark says UTF-8, but byte 5 is not UTF-8"):
        read(codecs.BOM_UTF8 + b"# \xff", "obj")


# Numbers


@pytest.mark.parametrize("file_type", TEXTS)
@pytest.mark.parametrize(
    ("word", "cause"),
    [
        ("-1,000000", "expected a number with a decimal point, got '-1,000000' with a decimal comma"),
        ("abc", "expected a number, got 'abc'"),
        ("1.0D+00", "expected a number, got '1.0D+00'"),
        ("1_0", "expected a number, got '1_0'"),
        ("1.0;", "expected a number, got '1.0;'"),
        ("0x1p3", "expected a number, got '0x1p3'"),
    ],
)
def test_a_number_that_is_none_is_refused_by_its_line(file_type: str, word: str, cause: str) -> None:
    lines = TEXTS[file_type].decode().split("\n")
    wrong = next(k for k, line in enumerate(lines) if "-1.0" in line) + 1
    lines[wrong] = lines[wrong].replace("-1.0", word, 1)
    with pytest.raises(MeshError, match=rf"^\.{file_type}: line {wrong + 1}: {re.escape(cause)}"):
        read("\n".join(lines).encode(), file_type)


def test_decimal_commas_are_named() -> None:
    with pytest.raises(MeshError, match="line 1: expected a number with a decimal point, got '-1,000000'"):
        shape_from_mesh((WILD / "obj_comma.obj").read_bytes(), "obj")


def test_a_continued_line_keeps_the_numbers_of_those_after_it() -> None:
    with pytest.raises(MeshError, match="line 7: expected a number, got 'x'"):
        read(SQUARE + b"f 1 2 \\\n3\nv 1 x 1\n", "obj")
    assert len(read(SQUARE + b"f 1 \\\n2 \\\n3 4\n", "obj").triangles) == 2


# OBJ


@pytest.mark.parametrize(
    ("lines", "cause"),
    [
        (b"f 1 2 0", "line 5: vertex index '0' is out of range: OBJ counts from 1"),
        (b"f 1 2 -5", "line 5: vertex index '-5' is out of range, 4 vertices so far"),
        (b"# x\nf 1 2 3\nf 1 2 9\nf 3 2 1", "line 7: a face names vertex 9 of 4"),
        (b"f 1 2 3.5", "line 5: expected a vertex index, got '3.5'"),
        (b"l 1 2\nl 2 3\np 1", "expected polygons (f), got 4 vertices without any, and 2 lines, 1 point"),
        (b"cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nend", "without any, and 1 free-form curve or surface"),
        (b"call other.obj", "line 5: 'call' asks for another file"),
        (b"face 1 2 3", "without any, and 1 unknown statement (the first in line 5, 'face')"),
    ],
)
def test_an_obj_is_refused_by_its_true_cause(lines: bytes, cause: str) -> None:
    with pytest.raises(MeshError, match=re.escape(cause)):
        read(SQUARE + lines + b"\n", "obj")


def test_what_is_no_polygon_is_left_out_of_an_obj_and_told() -> None:
    soup = read(SQUARE + b"f 1 2 3 4\nl 1 2\np 1\nsurf 0 1 0 1 1 2 3 4\nxyz\ng a\nusemtl b\nvn 0 0 1\n", "obj")
    assert soup.findings == (
        "Left out: 1 free-form curve or surface, 1 line, 1 point, 1 unknown statement (the first in line 9, 'xyz').",
    )


# OFF


@pytest.mark.parametrize(
    ("header", "vertex", "face"),
    [
        ("OFF", "", ""),
        ("COFF", " 255 0 0 255", " 3 0.1 0.2 0.3"),
        ("NOFF", " 0 0 1", ""),
        ("CNOFF", " 0 0 1 1 0 0 1", " 7"),
        ("STOFF", " 0.5 0.5", ""),
        ("", "", ""),
    ],
)
def test_off_has_colours_and_normals_and_comments_or_no_header(header: str, vertex: str, face: str) -> None:
    lines = [f"{header} # kind", "", "# counts", f"{len(CORNERS)} {len(FACES)} 12 # edges"]
    lines += [" ".join(map(str, corner)) + vertex for corner in CORNERS.tolist()]
    lines += [" ".join(map(str, (len(f), *f))) + face + " # face" for f in FACES]
    soup = read("\n".join(lines).encode(), "off")
    assert (soup.vertices == CORNERS).all()
    assert (soup.triangles == fans(FACES)).all()
    same_line = "\n".join([f"{header} {len(CORNERS)} {len(FACES)} 0", *lines[4:]])
    assert (read(same_line.encode(), "off").triangles == fans(FACES)).all()


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("4OFF\n1 1 0\n0 0 0 1\n", "line 1: '4OFF' has vertices in another space"),
        ("OFF BINARY\n", "line 1: binary OFF is not read"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6: a face names vertex 3 of 3, counted from 0"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "line 6: a face names vertex -1 of 3, counted from 0"),
        ("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 4: expected x y z, got '1 0'"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "no triangles (Left out: 1 face of 1 or 2 corners.)"),
    ],
)
def test_an_off_is_refused_by_its_true_cause(text: str, cause: str) -> None:
    with pytest.raises(MeshError, match=re.escape(cause)):
        read(text.encode(), "off")


# STL


def test_a_text_stl_without_its_end_is_read_and_told() -> None:
    stone = shape_from_mesh((WILD / "stl_txt_noend.stl").read_bytes(), "stl")
    assert said(stone, "The file ends in line 85 without 'endsolid': its whole facets were read")
    assert said(stone, "Convex: 12 triangles in the file, 9 facets")


def test_a_text_stl_that_is_cut_off_is_refused_as_that() -> None:
    lines = text_stl().decode().split("\n")
    with pytest.raises(MeshError, match=r"cut off: it ends in line 80, within a facet; expected 'endsolid'"):
        shape_from_mesh("\n".join(lines[:80]).encode(), "stl")
    with pytest.raises(
        MeshError, match=r"open: 3 boundary edges.*; the file ends in line 78 without 'endsolid': cut off"
    ):
        shape_from_mesh("\n".join(lines[:78]).encode(), "stl")


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (("outer loop\nvertex", "outer loop\nvertex 0 0 0\nvertex"), "line 9: expected a facet of 3 vertices, got 4"),
        (("vertex -1.0 -1.0 -1.0\n", "vertex -1.0 -1.0\n"), "line 4: expected vertex x y z, got 'vertex -1.0 -1.0'"),
        (("endfacet\n", ""), "line 8: expected outer loop, vertex, endloop or endfacet, got 'facet normal 0 0 0'"),
        (("solid cube\n", "solid\nendsolid\n"), "line 3: expected solid, got a facet"),
        (("facet normal 0 0 0\n", "color 1 2 3\n"), "line 2: expected facet or endsolid, got 'color 1 2 3'"),
    ],
)
def test_a_text_stl_is_refused_by_its_line(change: tuple[str, str], cause: str) -> None:
    with pytest.raises(MeshError, match=re.escape(cause)):
        read(text_stl().decode().replace(*change, 1).encode(), "stl")


def test_several_solids_are_joined_and_told() -> None:
    stone = shape_from_mesh(text_stl() + text_stl().replace(b"1.0", b"0.5"), "stl")
    assert said(stone, "The file shows 2 meshes")


@pytest.mark.parametrize("header", [b"", b"solid made by a writer that says solid in binary files too"])
def test_a_binary_stl_that_is_cut_off_says_how_much_is_missing(header: bytes) -> None:
    data = header.ljust(80, b"\0") + stl(CORNERS, fans(FACES))[80:]
    assert len(read(data, "stl").triangles) == 12
    with pytest.raises(MeshError, match="its header announces 12 triangles in 684 bytes, got 683 bytes"):
        read(data[:-1], "stl")
    soup = read(data + b"abc", "stl")
    assert (len(soup.triangles), soup.findings) == (12, ("Left out: 3 bytes after the last triangle.",))


# PLY


def test_ply_reads_every_number_type_in_both_orders() -> None:
    plain = read(text_ply(), "ply")
    for name, code in (("float", "f4"), ("float64", "f8"), ("int8", "i1"), ("short", "i2"), ("int", "i4")):
        for order, word in (("<", "little"), (">", "big")):
            header = (
                f"ply\nformat binary_{word}_endian 1.0\ncomment x\nelement other 2\nproperty list uint8 uint16 list\n"
                f"element vertex 8\nproperty uchar red\nproperty {name} x\nproperty {name} y\nproperty {name} z\n"
                "element face 6\nproperty uchar flag\nproperty list uint32 uint16 vertex_index\nend_header\n"
            )
            others = b"\1" + np.array([7], order + "u2").tobytes() + b"\2" + np.array([7, 8], order + "u2").tobytes()
            rows = b"".join(b"\0" + corner.astype(order + code).tobytes() for corner in CORNERS)
            rows += b"".join(
                b"\1" + np.array([4], order + "u4").tobytes() + np.array(face, order + "u2").tobytes() for face in FACES
            )
            soup = read(header.encode() + others + rows, "ply")
            assert (soup.vertices == plain.vertices).all()
            assert (soup.triangles == plain.triangles).all()


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (
            ("property double x", "property float16 x"),
            "line 4: type 'float16' is not known; expected one of char",
        ),
        (("property double x", "propery double x"), "line 4: 'propery double x' cannot be understood"),
        (("property double x", "property double u"), "has no property x of a vertex"),
        (("property double y", "property double x"), "line 5: vertex has two properties 'x'"),
        (("vertex_indices", "corners"), "no list of integers vertex_indices or vertex_index of a face"),
        (("element face 6", "element tristrips 6"), "triangle strips (tristrips), which are not read"),
        (("element face 6", "element edge 6"), "PLY has no faces: points are no solid"),
        (("4 5 1 3 7", "4 5 1 3 8"), "of 8, counted from 0"),
        (("4 1 5 7 3", "4 1 5 7"), "expected 5 numbers of a face, got 4: '4 1 5 7'"),
        (("4 1 5 7 3\n", ""), "the file is cut off: it ends within its rows of face, after 5 of 6"),
        (("1.0 1.0 1.0", "1.0 1.0"), "line 13: expected 3 numbers of a vertex, got 2: '-1.0 1.0'"),
    ],
)
def test_a_text_ply_is_refused_by_its_true_cause(change: tuple[str, str], cause: str) -> None:
    text = text_ply().decode()
    if change[0] == "4 5 1 3 7":
        change = (" 7 ", " 8 ")
    assert change[0] in text
    with pytest.raises(MeshError, match=re.escape(cause)):
        read(text.replace(*change, 1).encode(), "ply")


def test_a_binary_ply_that_is_cut_off_says_within_what() -> None:
    data = binary_ply(*cube())
    with pytest.raises(MeshError, match="cut off: it ends within its rows of face, after 5 of 6"):
        read(data[:-1], "ply")


@pytest.mark.parametrize("length", [np.inf, -np.inf, np.nan, -1.0, 2.5, 1e30])
def test_a_list_of_a_length_that_is_none_is_refused(length: float) -> None:
    """A list's length may be of any type, so also no whole number, or none at all."""
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\nproperty list float int vertex_indices\nend_header\n"
    )
    row = np.array([length], "<f4").tobytes() + np.arange(4, dtype="<i4").tobytes()
    with pytest.raises(MeshError, match="row 0 of face has a list vertex_indices of length"):
        read(header.encode() + CORNERS.astype("<f8").tobytes() + row, "ply")


# Counts


def test_lines_without_end_are_refused_by_their_number() -> None:
    with pytest.raises(TooLargeError, match="expected at most 5000000 lines, got 20000001"):
        read(b"\n" * 10_000_000 + b"v" + b"\n" * 10_000_000, "obj")
    with pytest.raises(TooLargeError, match="line 1: expected a line of at most 8388608 bytes, got 9000002"):
        read(b"f " + b"1" * 9_000_000, "obj")
    with pytest.raises(TooLargeError, match="expected at most 3000 vertices, 3 for each triangle allowed"):
        read(b"v 0 0 0\n" * 3001, "obj")

"""PLY (Turk 1994): its header, and binary polygons of varying length turned into text."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from culet.errors import MeshError, TooLargeError

_CODES = {
    **dict.fromkeys(("char", "int8"), "b"),
    **dict.fromkeys(("uchar", "uint8"), "B"),
    **dict.fromkeys(("short", "int16"), "h"),
    **dict.fromkeys(("ushort", "uint16"), "H"),
    **dict.fromkeys(("int", "int32"), "i"),
    **dict.fromkeys(("uint", "uint32"), "I"),
    **dict.fromkeys(("float", "float32"), "f"),
    **dict.fromkeys(("double", "float64"), "d"),
}
"""PLY's type names to those of `struct`."""


@dataclass(frozen=True)
class Element:
    """Rows of one kind: vertices, faces, or something else."""

    name: str
    count: int
    properties: tuple[tuple[str, ...], ...]
    """(type code,) of a scalar; (code of the length, code of the items) of a list."""


@dataclass(frozen=True)
class Header:
    """What stands before the rows."""

    encoding: str
    elements: tuple[Element, ...]
    text: bytes
    """The header itself."""

    def count(self, name: str) -> int:
        """Rows of that element; 0 if there is none."""
        return sum(element.count for element in self.elements if element.name == name)


def read_header(data: bytes) -> Header:
    """MeshError if the file does not begin with a PLY header."""
    lines: list[list[str]] = []
    start, end = 0, -1
    while start < len(data):
        stop = data.find(b"\n", start)
        if stop < 0 or stop - start > 4096:
            break
        lines.append(data[start:stop].decode("utf-8", "replace").split())
        start = stop + 1
        if lines[-1] == ["end_header"]:
            end = start
            break
    if end < 0 or lines[0] != ["ply"]:
        raise MeshError("expected a PLY header, 'ply' to 'end_header'")
    encoding = ""
    elements: list[Element] = []
    for words in lines[1:-1]:
        try:
            match words:
                case ["format", encoding, _]:
                    pass
                case ["element", name, count]:
                    elements.append(Element(name, _row_count(count), ()))
                case ["property", "list", length, item, _]:
                    elements[-1] = _with(elements[-1], (_CODES[length], _CODES[item]))
                case ["property", kind, _]:
                    elements[-1] = _with(elements[-1], (_CODES[kind],))
        except (KeyError, ValueError, IndexError):
            raise MeshError(f"PLY header line {' '.join(words)[:60]!r} cannot be understood") from None
    if encoding not in {"ascii", "binary_little_endian", "binary_big_endian"}:
        raise MeshError(f"PLY format {encoding[:40]!r} is not known")
    return Header(encoding, tuple(elements), data[:end])


def plain_polygons(data: bytes, max_triangles: int) -> bytes:
    """The file, or the same as text if binary faces differ in their numbers of corners.

    trimesh 5.2 reads a binary list as if every row were as long as the first.
    """
    header = read_header(data)
    if header.count("face") > max_triangles:
        raise TooLargeError(f"expected at most {max_triangles} triangles, got {header.count('face')} faces")
    data = ascii_only(header.text) + data[len(header.text) :]
    if header.encoding == "ascii":
        return data
    order = "<" if header.encoding == "binary_little_endian" else ">"
    lengths: set[tuple[str, tuple[int, ...]]] = set()
    rows: list[str] = []
    try:
        for element, _, seen in _rows(data, header, order, lists_only=True):
            lengths.add((element.name, seen))
        if len(lengths) == len({name for name, _ in lengths}):
            return data
        rows += (" ".join(map(repr, values)) for _, values, _ in _rows(data, header, order, lists_only=False))
    except struct.error:
        raise MeshError("PLY ends within its rows") from None
    text = ascii_only(header.text).replace(header.encoding.encode(), b"ascii", 1)
    return text + "\n".join([*rows, ""]).encode()


def ascii_only(text: bytes) -> bytes:
    """The same with a question mark for every other byte: names and comments come in any encoding, numbers do not."""
    return text.translate(bytes([*range(128), *b"?" * 128]))


def _rows(
    data: bytes, header: Header, order: str, *, lists_only: bool
) -> Iterator[tuple[Element, tuple[float, ...], tuple[int, ...]]]:
    """Each row's element, numbers and lengths of lists; with `lists_only`, elements without lists are passed over."""
    position = len(header.text)
    for element in header.elements:
        if not element.properties:
            continue
        if all(len(kinds) == 1 for kinds in element.properties):
            row = struct.Struct(order + "".join(kinds[0] for kinds in element.properties))
            end = position + row.size * element.count
            if end > len(data):
                raise MeshError(f"PLY ends within its {element.name} rows")
            if not lists_only:
                yield from ((element, values, ()) for values in row.iter_unpack(data[position:end]))
            position = end
        else:
            for _ in range(element.count):
                values, position, seen = _row(data, position, order, element)
                yield element, values, seen


def _row(data: bytes, position: int, order: str, element: Element) -> tuple[tuple[float, ...], int, tuple[int, ...]]:
    """One row's numbers with each list after its length, where it ends, and the lists' lengths."""
    values: list[float] = []
    seen: list[int] = []
    for kinds in element.properties:
        first = struct.Struct(order + kinds[0])
        values += first.unpack_from(data, position)
        position += first.size
        if len(kinds) == 2:
            length = int(values[-1])
            if not 0 <= length <= len(data):
                raise MeshError(f"PLY {element.name} row has a list of length {length}")
            items = struct.Struct(f"{order}{length}{kinds[1]}")
            values += items.unpack_from(data, position)
            position += items.size
            seen.append(length)
    return tuple(values), position, tuple(seen)


def _row_count(word: str) -> int:
    count = int(word)
    if count < 0:
        raise ValueError
    return count


def _with(element: Element, kinds: tuple[str, ...]) -> Element:
    return Element(element.name, element.count, (*element.properties, kinds))

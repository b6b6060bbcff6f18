"""A glTF accessor: numbers in the binary buffer, as an array.

The glTF 2.0 specification, sections 3.6.2 (accessors), 3.6.2.2 (component types), 3.6.2.3 (sparse) and 3.11 (alignment,
strides).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def positions(document: dict[str, Any], binary: bytes, index: int, max_count: int) -> NDArray[np.float64]:
    """(count, 3) an accessor of points or offsets, normalised integers as the numbers that they stand for.

    A signed integer c of b bits stands for max(c / (2^(b-1) - 1), -1), an unsigned one for c / (2^b - 1): section 3.11.
    """
    accessor = _at(document, "accessors", index)
    if accessor["type"] != "VEC3" or accessor["componentType"] == 5125:
        raise MeshError(
            f"glTF has positions of type {accessor['type']} and component type {accessor['componentType']}; expected "
            "VEC3 of floats, or of bytes or shorts"
        )
    stored = _items(document, binary, accessor, max_count)
    values = stored.astype(np.float64)
    if accessor.get("normalized", False) and stored.dtype.kind in "iu":
        values = np.maximum(values / np.iinfo(stored.dtype).max, -1.0)
    return values


def indices(document: dict[str, Any], binary: bytes, index: int, max_count: int) -> NDArray[np.int64]:
    """(count,) an accessor of unsigned integers."""
    accessor = _at(document, "accessors", index)
    if accessor["type"] != "SCALAR" or accessor["componentType"] not in {5121, 5123, 5125}:
        raise MeshError(
            f"glTF has indices of type {accessor['type']} and component type {accessor['componentType']}; expected "
            "SCALAR of unsigned integers"
        )
    return _items(document, binary, accessor, max_count)[:, 0].astype(np.int64)


def count_of(document: dict[str, Any], index: int) -> int:
    """Items of an accessor, as it claims."""
    count = _at(document, "accessors", index)["count"]
    if not isinstance(count, int) or count < 0:
        raise MeshError(f"glTF accessor {index} claims {count!r} items")
    return count


def _items(document: dict[str, Any], binary: bytes, accessor: dict[str, Any], max_count: int) -> NDArray[Any]:
    """(count, components) as stored, zeros where there is no buffer view, sparse items put in their places."""
    count = accessor["count"]
    if not isinstance(count, int) or not 0 <= count <= max_count:
        raise MeshError(f"glTF accessor claims {count!r} items; expected at most {max_count}")
    component = np.dtype(_COMPONENTS[accessor["componentType"]])
    size = _SIZES[accessor["type"]]
    if "bufferView" in accessor:
        items = _strided(document, binary, accessor, component, size, count)
    else:
        items = np.zeros((count, size), component)
    sparse = accessor.get("sparse")
    if sparse is None:
        return items
    number = sparse["count"]
    if not isinstance(number, int) or not 0 <= number <= count:
        raise MeshError(f"glTF has a sparse accessor of {number!r} items in place of {count}")
    kind = np.dtype(_COMPONENTS[sparse["indices"]["componentType"]])
    places = _strided(document, binary, sparse["indices"], kind, 1, number)
    if number and int(places.max()) >= count:
        raise MeshError(f"glTF has a sparse accessor that replaces item {int(places.max())} of {count}")
    replaced = items.copy()
    replaced[places[:, 0].astype(np.int64)] = _strided(document, binary, sparse["values"], component, size, number)
    return replaced


def _strided(
    document: dict[str, Any], binary: bytes, source: dict[str, Any], component: np.dtype[Any], size: int, count: int
) -> NDArray[Any]:
    """(count, size) items of a buffer view, each a stride after the one before."""
    view = _at(document, "bufferViews", source["bufferView"])
    if view.get("buffer", 0) != 0:
        raise MeshError(f"glTF names buffer {view['buffer']}; expected the one within the file")
    item = component.itemsize * size
    stride = _bytes(view.get("byteStride", item))
    start, own = _bytes(view.get("byteOffset", 0)), _bytes(source.get("byteOffset", 0))
    length = _bytes(view["byteLength"])
    if stride < item:
        raise MeshError(f"glTF has a buffer view with a stride of {stride} bytes for items of {item}")
    needed = own + (stride * (count - 1) + item if count else 0)
    if needed > length or start + needed > len(binary):
        raise MeshError(
            f"glTF accessor needs {needed} bytes of a buffer view; got {max(min(length, len(binary) - start), 0)}"
        )
    if count == 0:
        return np.zeros((0, size), component)
    return np.ndarray((count, size), component, binary, start + own, (stride, component.itemsize))


def _bytes(number: object) -> int:
    if not isinstance(number, int) or number < 0:
        raise MeshError(f"glTF has a buffer view with {str(number)[:40]!r} where a number of bytes is expected")
    return number


def _at(document: dict[str, Any], kind: str, index: object) -> dict[str, Any]:
    """An entry of one of the document's lists."""
    entries = document.get(kind, [])
    if not isinstance(index, int) or not 0 <= index < len(entries):
        raise MeshError(f"glTF names {kind} {index!r} of {len(entries)}")
    entry: dict[str, Any] = entries[index]
    return entry

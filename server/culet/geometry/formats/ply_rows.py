"""The rows of a PLY file, binary or text, as columns."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError, TooLargeError
from culet.geometry.formats.text import integer, numbered_lines, numbers, shown

_ROWS_WITH_LISTS = 1_000_000
"""Of one element: each costs a microsecond of its own."""


@dataclass(frozen=True)
class Property:
    """A number of each row, or a list of numbers."""

    name: str
    code: str
    """Of `struct`, of the number or of the list's items."""
    length: str | None = None
    """Of `struct`, of what stands before a list's items; None for a single number."""


@dataclass(frozen=True)
class Element:
    """Rows of one kind: vertices, faces, or something else."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def has_lists(self) -> bool:
        """Whether its rows may differ in length."""
        return any(own.length is not None for own in self.properties)


@dataclass(frozen=True, eq=False)
class Lists:
    """A property that is a list, of all rows."""

    lengths: NDArray[np.int64]
    """(rows,)."""
    items: NDArray[np.int64]
    """(sum of the lengths,)."""


Columns = Mapping[str, "NDArray[np.float64] | Lists"]
"""By the property's name."""


def binary_rows(data: bytes, start: int, elements: Sequence[Element], order: str) -> dict[str, Columns]:
    """The columns of each element of a binary file whose rows begin at a byte; `order` is < or >.

    MeshError says within what the file ends, and names a list that is none.
    """
    found: dict[str, Columns] = {}
    for element in elements:
        _check_count(element)
        if not element.properties:
            continue
        lengths = _first_lengths(data, start, element, order) if element.has_lists and element.count else ()
        row = _row_type(element, order, lengths)
        end = start + row.itemsize * element.count
        if end <= len(data):
            rows = np.frombuffer(data, row, element.count, start)
            if all((rows[f"#{own.name}"] == size).all() for own, size in zip(_lists(element), lengths, strict=False)):
                found[element.name] = _columns_alike(rows, element)
                start = end
                continue
        elif not element.has_lists:
            raise _ends_within(element, (len(data) - start) // row.itemsize)
        found[element.name], start = _columns_unlike(data, start, element, order)
    return found


def text_rows(
    text: bytes, first_line: int, elements: Sequence[Element], wanted: Mapping[tuple[str, str], int | None]
) -> dict[str, Columns]:
    """The wanted columns, (element, property), of each element of a text, a row a line.

    What is wanted of a list are indices below the number beside it. MeshError names the line.
    """
    lines = numbered_lines(text, comment=b"\n", first=first_line)
    found: dict[str, Columns] = {}
    for element in elements:
        _check_count(element)
        if not element.properties:
            continue
        own = {name: below for (owner, name), below in wanted.items() if owner == element.name}
        scalars: list[list[float]] = []
        lengths: dict[str, list[int]] = {name: [] for name in own}
        items: dict[str, list[int]] = {name: [] for name in own}
        for row in range(element.count):
            line, words = next(lines, (0, None))
            if words is None:
                raise _ends_within(element, row)
            scalar: list[bytes] = []
            place = 0
            for kind in element.properties:
                if kind.length is None:
                    if kind.name in own:
                        scalar += words[place : place + 1]
                    place += 1
                    continue
                size = integer(words[place], line, f"the length of {kind.name}") if place < len(words) else 0
                listed = words[place + 1 : place + 1 + max(size, 0)]
                place += 1 + max(size, 0)
                if kind.name in own:
                    lengths[kind.name].append(size)
                    items[kind.name] += (_index(word, line, own[kind.name]) for word in listed)
                if size < 0:
                    place = len(words) + 1
            if place != len(words):
                raise MeshError(
                    f"line {line}: expected {place} numbers of a {element.name}, got {len(words)}: "
                    f"{shown(b' '.join(words))}"
                )
            if scalar:
                scalars.append(numbers(scalar, line))
        table = np.array(scalars, np.float64).reshape(element.count, -1)
        single = [kind.name for kind in element.properties if kind.length is None and kind.name in own]
        columns: dict[str, NDArray[np.float64] | Lists] = {name: table[:, k] for k, name in enumerate(single)}
        for kind in _lists(element):
            if kind.name in own:
                columns[kind.name] = Lists(np.array(lengths[kind.name], np.int64), np.array(items[kind.name], np.int64))
        found[element.name] = columns
    return found


def _index(word: bytes, line: int, below: int | None) -> int:
    value = integer(word, line, "a vertex of a face")
    if below is not None and not 0 <= value < below:
        raise MeshError(f"line {line}: a face names vertex {value} of {below}, counted from 0")
    return value


def _check_count(element: Element) -> None:
    if element.has_lists and element.count > _ROWS_WITH_LISTS:
        raise TooLargeError(
            f"expected at most {_ROWS_WITH_LISTS} rows of {element.name}, which have lists, got {element.count}"
        )


def _ends_within(element: Element, rows: int) -> MeshError:
    return MeshError(f"the file is cut off: it ends within its rows of {element.name}, after {rows} of {element.count}")


def _lists(element: Element) -> list[Property]:
    return [own for own in element.properties if own.length is not None]


def _row_type(element: Element, order: str, lengths: Sequence[int]) -> np.dtype[np.void]:
    """The rows of an element whose lists all have the lengths given; a list's length is named with a #."""
    sizes = iter(lengths)
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    for own in element.properties:
        if own.length is None:
            fields.append((own.name, order + own.code))
        else:
            fields += [(f"#{own.name}", order + own.length), (own.name, order + own.code, (next(sizes, 0),))]
    return np.dtype(fields)


def _first_lengths(data: bytes, start: int, element: Element, order: str) -> tuple[int, ...]:
    lists, _ = _row(data, start, element, order, 0)
    return tuple(len(items) for items in lists)


def _row(data: bytes, start: int, element: Element, order: str, row: int) -> tuple[list[tuple[float, ...]], int]:
    """The lists of one row, and where the row ends."""
    found: list[tuple[float, ...]] = []
    try:
        for own in element.properties:
            if own.length is None:
                start += struct.calcsize(order + own.code)
                continue
            (length,) = struct.unpack_from(order + own.length, data, start)
            if not 0 <= length <= len(data) or length != int(length):  # a float may be infinite
                raise MeshError(f"row {row} of {element.name} has a list {own.name} of length {length}")
            start += struct.calcsize(order + own.length)
            if start + int(length) * struct.calcsize(order + own.code) > len(data):
                raise _ends_within(element, row)
            found.append(struct.unpack_from(f"{order}{int(length)}{own.code}", data, start))
            start += int(length) * struct.calcsize(order + own.code)
    except struct.error:
        raise _ends_within(element, row) from None
    if start > len(data):
        raise _ends_within(element, row)
    return found, start


def _columns_alike(rows: NDArray[np.void], element: Element) -> Columns:
    columns: dict[str, NDArray[np.float64] | Lists] = {}
    for own in element.properties:
        values = rows[own.name]
        if own.length is None:
            columns[own.name] = values.astype(np.float64)
        elif own.code not in "fd":
            columns[own.name] = Lists(
                np.full(len(rows), values.shape[1], np.int64), values.astype(np.int64).reshape(-1)
            )
    return columns


def _columns_unlike(data: bytes, start: int, element: Element, order: str) -> tuple[Columns, int]:
    """Of rows that differ in length: their lists of integers alone."""
    kept = [k for k, own in enumerate(_lists(element)) if own.code not in "fd"]
    lengths: list[list[int]] = [[] for _ in kept]
    items: list[list[float]] = [[] for _ in kept]
    for row in range(element.count):
        lists, start = _row(data, start, element, order, row)
        for target, k in enumerate(kept):
            lengths[target].append(len(lists[k]))
            items[target] += lists[k]
    names = [own.name for own in _lists(element)]
    return {
        names[k]: Lists(np.array(lengths[target], np.int64), np.array(items[target], np.int64))
        for target, k in enumerate(kept)
    }, start

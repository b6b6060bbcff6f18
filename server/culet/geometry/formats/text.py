"""Text of a mesh file: its encoding, its lines and its numbers, with refusals that name the line."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Iterator

from culet.errors import MeshError, TooLargeError

MAX_LINES = 5_000_000
"""The vertices, normals, texture coordinates and faces of 200 000 triangles are 2 million lines; each line costs time
even if it is empty."""

MAX_LINE = 8 << 20
"""Bytes: a polygon of 200 000 corners with six digits for each of its three indices has 4.2 million."""

BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16: its mark begins with UTF-16's
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""And the encodings that they tell."""

_DECIMAL_COMMA = re.compile(rb"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")


def has_mark(data: bytes) -> bool:
    """Whether the bytes begin with a byte order mark."""
    return any(data.startswith(mark) for mark, _ in BYTE_ORDER_MARKS)


def ascii_text(data: bytes) -> bytes:
    """The text with a question mark for every character beyond ASCII, its lines ended by a line feed.

    Names and comments come in any encoding, numbers and keywords do not. A byte order mark tells UTF-8, UTF-16 and
    UTF-32; MeshError if what follows the mark is something else, or if zero bytes show that the text is none.
    """
    for mark, encoding in BYTE_ORDER_MARKS:
        if data.startswith(mark):
            name = encoding.removesuffix("-le").removesuffix("-be").upper()
            try:
                data = data[len(mark) :].decode(encoding).encode("ascii", "replace")
            except UnicodeDecodeError as error:
                raise MeshError(
                    f"the byte order mark says {name}, but byte {error.start + len(mark)} is not {name} "
                    f"({error.reason}); expected text in ASCII, UTF-8 or UTF-16"
                ) from None
            break
    zero = data.find(b"\0")
    if zero >= 0:
        line = data.count(b"\n", 0, zero) + 1
        raise MeshError(
            f"line {line}: expected text, got a zero byte: UTF-16 without a byte order mark, or no text at all"
        )
    return data.translate(bytes([*range(128), *b"?" * 128])).replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def numbered_lines(text: bytes, *, comment: bytes = b"#", first: int = 1) -> Iterator[tuple[int, list[bytes]]]:
    """(number, words) of each line that has words; what follows `comment` is none. The first line has number `first`.

    A line that ends with a backslash goes on in the next. TooLargeError beyond MAX_LINES or MAX_LINE.
    """
    count = text.count(b"\n") + 1
    if count > MAX_LINES:
        raise TooLargeError(f"expected at most {MAX_LINES} lines, got {count}")
    begun, before = 0, b""
    for number, line in enumerate(io.BytesIO(text), start=first):  # a list of all lines would take 40 times the text
        if line.endswith(b"\\\n"):
            begun, before = begun or number, before + line[:-2] + b" "
        else:
            yield from _words(begun or number, before + line, comment)
            begun, before = 0, b""
        if len(before) > MAX_LINE:
            raise TooLargeError(f"line {begun}: expected a line of at most {MAX_LINE} bytes, got more")
    yield from _words(begun, before, comment)


def _words(number: int, line: bytes, comment: bytes) -> Iterator[tuple[int, list[bytes]]]:
    if len(line) > MAX_LINE:
        raise TooLargeError(f"line {number}: expected a line of at most {MAX_LINE} bytes, got {len(line)}")
    words = line.partition(comment)[0].split()
    if words:
        yield number, words


def numbers(words: list[bytes], line: int) -> list[float]:
    """The words as numbers; MeshError names the line and the word that is none."""
    try:
        values = list(map(float, words))
    except ValueError:
        values = []
    if not values or b"_" in b"".join(words):  # Python reads 1_000
        for word in words:
            _check_number(word, line)
    return values


def point(words: list[bytes], line: int) -> tuple[float, float, float]:
    """The three numbers of a position, which the words begin with; MeshError names the line."""
    x, y, z = numbers(words[:3], line)
    return x, y, z


def integer(word: bytes, line: int, what: str) -> int:
    """The word as an integer; MeshError names the line, and what was expected."""
    try:
        value = int(word)
    except ValueError:
        value = None
    if value is None or b"_" in word:  # Python reads 1_000
        raise MeshError(f"line {line}: expected {what}, got {shown(word)}")
    return value


def shown(text: bytes) -> str:
    """The beginning of a text, in quotes."""
    return repr(text[:60].decode("ascii", "replace"))


def _check_number(word: bytes, line: int) -> None:
    if _DECIMAL_COMMA.fullmatch(word):
        raise MeshError(
            f"line {line}: expected a number with a decimal point, got {shown(word)} with a decimal comma; "
            "export it with a point"
        )
    try:
        float(word)
    except ValueError:
        pass
    else:
        if b"_" not in word:
            return
    raise MeshError(f"line {line}: expected a number, got {shown(word)}")

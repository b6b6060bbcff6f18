"""Text of a design's file: its encoding, its lines, its numbers."""

from __future__ import annotations

import math
import re

from culet.errors import MeshError
from culet.geometry.formats.text import BYTE_ORDER_MARKS

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
"""Python's own reading takes 1_000, nan, and digits of other scripts too."""

_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?", re.ASCII)


def decoded(data: bytes) -> str:
    """The text: by its byte order mark, or else as UTF-8, or else in Windows' code page 1252, whose degree sign is no
    UTF-8. MeshError if it is other than its mark says, or no text."""
    for mark, encoding in BYTE_ORDER_MARKS:
        if data.startswith(mark):
            try:
                return _checked(data[len(mark) :].decode(encoding))
            except UnicodeDecodeError as error:
                name = encoding.removesuffix("-le").removesuffix("-be").upper()
                raise MeshError(
                    f"the byte order mark says {name}, but byte {error.start + len(mark)} is not ({error.reason})"
                ) from None
    try:
        return _checked(data.decode("utf-8"))
    except UnicodeDecodeError:
        return _checked(data.decode("cp1252", "replace"))


def encoded(text: str) -> bytes:
    """As cutters' programs on Windows read it; as UTF-8 with its mark where the code page 1252 lacks a character."""
    try:
        return text.encode("cp1252")
    except UnicodeEncodeError:
        return text.encode("utf-8-sig", "replace")


def lines_of(text: str) -> list[str]:
    """Lines that end with a line feed, a carriage return or both; the mark of an end that DOS wrote is none."""
    return text.rstrip("\x1a").replace("\r\n", "\n").replace("\r", "\n").split("\n")


def is_number(word: str) -> bool:
    """Whether a word is a decimal number."""
    return _NUMBER.fullmatch(word) is not None


def number(word: str, what: str, most: float) -> float:
    """The word as a number whose magnitude is at most `most`; MeshError says `what` was expected."""
    if _DECIMAL_COMMA.fullmatch(word):
        raise MeshError(f"expected {what} with a decimal point, got {shown(word)} with a decimal comma")
    if not is_number(word):
        raise MeshError(f"expected {what}, got {shown(word)}")
    value = float(word)
    if not math.isfinite(value) or abs(value) > most:
        raise MeshError(f"expected {what} from {-most:g} to {most:g}, got {shown(word)}")
    return value


def shown(text: str) -> str:
    """The beginning of a text, in quotes."""
    return repr(text if len(text) <= 60 else text[:60] + "\N{HORIZONTAL ELLIPSIS}")


def one_line(text: str) -> str:
    """With one blank between words, and nothing but characters that can be printed."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def _checked(text: str) -> str:
    zero = text.find("\0")
    if zero >= 0:
        line = len(lines_of(text[:zero]))
        raise MeshError(f"line {line}: expected text, got a zero byte: UTF-16 without its mark, or no text at all")
    return text

"""What the kernels read, as the host writes it: structs and arguments, taken from the kernels' own text.

A field of a struct, or an argument, is written once, in OpenCL C; here its place is found by its name.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import culet_kernels
from culet.rendering.opencl.device import Real

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_STRUCT = re.compile(r"typedef struct \{([^{}]*)\} (\w+);")
_MEMBER = re.compile(r"(\w+)((?:\[[\w +]+\])*)")
_CONSTANT = re.compile(r"^#define (\w+) \(?(-?\d+)\)?[ \t]*$", re.MULTILINE)
_BUFFER = re.compile(r"BUFFER\(([\w ]+), (\w+)\)")
_RENDER = re.compile(r"__kernel void render\(WORLD_BUFFERS\(AS_ARGUMENT\)([^)]*)\)")
_WHOLE = {"int": np.int32, "uint": np.uint32}


@cache
def _text(name: str) -> str:
    """A source file without its comments."""
    return _COMMENT.sub("", culet_kernels.written(name))


@cache
def constants(name: str) -> Mapping[str, int]:
    """The whole numbers that a source file defines."""
    return {constant: int(value) for constant, value in _CONSTANT.findall(_text(name))}


def struct(name: str, real: Real, file: str = "parameters.cl") -> np.dtype[np.void]:
    """A struct of a source file for kernels of that precision, aligned as C does."""
    return _struct(name, np.dtype(real).char, file)


@cache
def _struct(name: str, real: str, file: str) -> np.dtype[np.void]:
    members = next(members for members, found in _STRUCT.findall(_text(file)) if found == name)
    types: dict[str, Any] = {"real": real, "double": np.float64, "float": np.float32, **_WHOLE}
    fields: list[tuple[str, Any, tuple[int, ...]]] = []
    for declaration in filter(None, (part.strip() for part in members.split(";"))):
        kind, _, names = declaration.partition(" ")
        for field, sizes in _MEMBER.findall(names):
            shape = tuple(_size(size, file) for size in re.findall(r"\[([\w +]+)\]", sizes))
            fields.append((field, types[kind], shape))
    return np.dtype(fields, align=True)


def _size(written: str, file: str) -> int:
    """Of an array: a sum of numbers, and of names that are defined in the file or in what it includes."""
    terms = [term.strip() for term in written.split("+")]
    return sum(int(term) if term.isdigit() else _known(file)[term] for term in terms)


@cache
def _known(file: str) -> Mapping[str, int]:
    """Whole numbers that a source file and those that it includes define."""
    return {constant: int(value) for constant, value in _CONSTANT.findall(_COMMENT.sub("", culet_kernels.source(file)))}


@dataclass(frozen=True)
class Argument:
    """Of the render kernel."""

    name: str
    scalar: type[np.generic] | None
    """None: a buffer."""

    def value(self, given: object) -> object:
        """What pyopencl passes on."""
        return given if self.scalar is None else self.scalar(given)


@cache
def buffers() -> tuple[str, ...]:
    """Names of the world's buffers, a kernel's first arguments."""
    return tuple(name for _, name in _BUFFER.findall(_text("world.cl")))


@cache
def arguments() -> tuple[Argument, ...]:
    """Those of the render kernel, in its order: the world's buffers, then the others."""
    (declared,) = _RENDER.findall(_text("render.cl"))
    others = [declaration.split() for declaration in declared.split(",")]
    return (
        *(Argument(name, None) for name in buffers()),
        *(Argument(words[-1].lstrip("*"), None if "*" in words[-1] else _WHOLE[words[0]]) for words in others),
    )


def in_order(given: Mapping[str, object]) -> list[object]:
    """The arguments by name, as the kernel wants them."""
    expected = {argument.name for argument in arguments()}
    if given.keys() != expected:
        raise TypeError(f"render: expected the arguments {sorted(expected)}, got {sorted(given)}")
    return [argument.value(given[argument.name]) for argument in arguments()]

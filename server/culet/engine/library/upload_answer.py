"""What a reading process answers, as data: arrays, then JSON that says what they are, then the JSON's length.

The process has read hostile bytes through libraries in C++, so its answer is taken for hostile too: nothing in it is
executed or unpickled, every type, shape, place and number is checked, and the file cannot change any more by then.
"""

from __future__ import annotations

import fcntl
import math
import mmap
import os
import struct
from collections.abc import Iterable
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from culet.errors import CuletError, InputError, MeshError, SceneError, TooLargeError
from culet.geometry.designs.limits import MOST_FACETS
from culet.geometry.designs.solid import LONGEST_NAME
from culet.geometry.shape import FacetName, MassProperties, Shape
from culet.optics.panoramas import check_panorama
from culet.optics.sky_files.picture import SkyPicture

LENGTH = struct.Struct("<Q")
MOST_HEADER_BYTES = 2**20
ERRORS: dict[str, type[InputError]] = {
    error.__name__: error for error in (InputError, MeshError, SceneError, TooLargeError)
}
DTYPES = {"float32": np.float32, "float64": np.float64, "int32": np.int32}


class AnswerError(CuletError):
    """The answer is not one."""


class TooLittleMemoryError(CuletError):
    """The process could not take the memory that it would have needed: so many bytes, or 0 if it does not know."""

    def __init__(self, needed: int) -> None:
        super().__init__(f"{needed} bytes")
        self.needed = needed


class ArrayPart(BaseModel):
    """Where an array is in the file."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    dtype: Literal["float32", "float64", "int32"]
    shape: Annotated[tuple[Annotated[int, Field(ge=0, lt=2**40)], ...], Field(min_length=1, max_length=3)]
    offset: Annotated[int, Field(ge=0, lt=2**48, multiple_of=mmap.ALLOCATIONGRANULARITY)]


class Name(BaseModel):
    """What a facet is called."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    tier: Annotated[int, Field(ge=1, le=MOST_FACETS)]
    name: Annotated[str, Field(max_length=LONGEST_NAME)]


class MeshHeader(BaseModel):
    """A stone but for its arrays."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    kind: Literal["mesh"] = "mesh"
    name: str
    vertices: ArrayPart
    triangles: ArrayPart
    facet_of_triangle: ArrayPart
    planes: ArrayPart
    inertia: ArrayPart
    convex: bool
    volume: float
    findings: tuple[str, ...]
    names: Annotated[tuple[Name, ...], Field(max_length=MOST_FACETS)] = ()
    """Of each facet, or none."""


class SkyHeader(BaseModel):
    """A sky but for its pixels."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["sky"] = "sky"
    pixels: ArrayPart
    findings: tuple[str, ...]


class Refusal(BaseModel):
    """An error that says what is wrong with the file."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["refusal"] = "refusal"
    error: Literal["InputError", "MeshError", "SceneError", "TooLargeError", "MemoryError"]
    message: str
    field: str | None = None
    needed: Annotated[int, Field(ge=0, lt=2**48)] = 0
    """Bytes, of a MemoryError that knows."""


AnswerHeader = MeshHeader | SkyHeader | Refusal
_header: TypeAdapter[AnswerHeader] = TypeAdapter(Annotated[AnswerHeader, Field(discriminator="kind")])


class AnswerFile:
    """The reading process's side: an empty file to fill."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._end = 0
        self._sky: ArrayPart | None = None

    def allocate(self, shape: tuple[int, int, int]) -> NDArray[np.float32]:
        """The sky's pixels, black, in the file itself: they are there once, however large."""
        size = math.prod(shape) * 4
        self._sky = ArrayPart(dtype="float32", shape=shape, offset=self._end)
        os.ftruncate(self._descriptor, self._end + size)
        pixels = np.frombuffer(mmap.mmap(self._descriptor, size, offset=self._end), np.float32).reshape(shape)
        self._end += _whole_pages(size)
        return pixels

    def tell_sky(self, picture: SkyPicture) -> None:
        """The sky that was read into what `allocate` gave."""
        if self._sky is None:
            raise ValueError("expected pixels that lie in the answer")
        self._finish(SkyHeader(pixels=self._sky, findings=_utf_8(picture.findings)))

    def tell_mesh(self, shape: Shape) -> None:
        """The stone that was read."""
        parts = {
            name: self._place(array)
            for name, array in (
                ("vertices", shape.vertices), ("triangles", shape.triangles),
                ("facet_of_triangle", shape.facet_of_triangle), ("planes", shape.planes),
                ("inertia", shape.mass.inertia),
            )
        }  # fmt: skip
        self._finish(
            MeshHeader(
                name=_utf_8([shape.name])[0], convex=bool(shape.convex), volume=float(shape.mass.volume),
                findings=_utf_8(shape.findings),
                names=tuple(Name(tier=tier, name=_utf_8([name])[0]) for tier, name in shape.names), **parts,
            )
        )  # fmt: skip

    def refuse(self, error: InputError | MemoryError) -> None:
        """Why there is nothing."""
        name = next((name for name, kind in ERRORS.items() if type(error) is kind), "InputError")
        if isinstance(error, MemoryError):
            needed = error.args[0] if error.args and isinstance(error.args[0], int) else 0
            self._finish(Refusal(error="MemoryError", message="", needed=needed))
        else:
            (message,) = _utf_8([str(error)[:10_000]])
            self._finish(Refusal.model_validate({"error": name, "message": message, "field": error.field}))

    def _place(self, array: NDArray[np.generic]) -> ArrayPart:
        part = ArrayPart.model_validate({"dtype": array.dtype.name, "shape": array.shape, "offset": self._end})
        self._write(np.ascontiguousarray(array).tobytes())
        self._end = _whole_pages(self._end)
        return part

    def _finish(self, header: BaseModel) -> None:
        text = header.model_dump_json().encode()
        self._write(text + LENGTH.pack(len(text)))

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            written = os.pwrite(self._descriptor, view, self._end)
            self._end += written
            view = view[written:]


def taken(descriptor: int, kind: str) -> Shape | SkyPicture:
    """What a process that has ended answered, checked; InputError if that is a refusal,
    TooLittleMemoryError, AnswerError if it is no answer. The arrays go on lying in the file's memory."""
    _seal(descriptor)
    size = os.fstat(descriptor).st_size
    header = _read_header(descriptor, size)
    if isinstance(header, Refusal):
        if header.error == "MemoryError":
            raise TooLittleMemoryError(header.needed)
        raise ERRORS[header.error](header.message, header.field)
    if header.kind != kind:
        raise AnswerError(f"expected a {kind}, got a {header.kind}")
    if isinstance(header, SkyHeader):
        return _sky(header, descriptor, size)
    return _shape(header, descriptor, size)


def _seal(descriptor: int) -> None:
    """Nothing writes to the file any more, not even a child that the process may have left behind."""
    if not hasattr(fcntl, "F_ADD_SEALS"):  # systems whose memory files have a disk's kind
        return
    seals = fcntl.F_SEAL_WRITE | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
    try:
        fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, seals)
    except OSError as error:
        raise AnswerError(f"its answer could not be sealed: {error.strerror}") from error


def _read_header(descriptor: int, size: int) -> AnswerHeader:
    if size < LENGTH.size:
        raise AnswerError("there is no answer")
    (length,) = LENGTH.unpack(os.pread(descriptor, LENGTH.size, size - LENGTH.size))
    if not 0 < length <= min(MOST_HEADER_BYTES, size - LENGTH.size):
        raise AnswerError(f"a header of {length} bytes in an answer of {size}")
    try:
        return _header.validate_json(os.pread(descriptor, length, size - LENGTH.size - length))
    except ValidationError as error:
        raise AnswerError(f"a header that is none: {error.errors(include_url=False)[0]['msg']}") from error


def _sky(header: SkyHeader, descriptor: int, size: int) -> SkyPicture:
    pixels = np.asarray(_array(header.pixels, "float32", (-1, -1, 3), descriptor, size), np.float32)
    check_panorama(pixels)
    return SkyPicture(pixels, header.findings)


def _shape(header: MeshHeader, descriptor: int, size: int) -> Shape:
    def part(name: str, dtype: str, shape: tuple[int, ...]) -> NDArray[np.generic]:
        array = _array(getattr(header, name), dtype, shape, descriptor, size)
        if not np.isfinite(array).all():
            raise AnswerError(f"{name} that are not finite")
        return array

    vertices = np.asarray(part("vertices", "float64", (-1, 3)), np.float64)
    triangles = np.asarray(part("triangles", "int32", (-1, 3)), np.int32)
    facets = np.asarray(part("facet_of_triangle", "int32", (len(triangles),)), np.int32)
    planes = np.asarray(part("planes", "float64", (-1, 4)), np.float64)
    inertia = np.asarray(part("inertia", "float64", (3, 3)), np.float64)
    _check_range("triangles", triangles, len(vertices))
    _check_range("facet_of_triangle", facets, len(planes))
    if len(header.names) not in (0, len(planes)):
        raise AnswerError(f"{len(header.names)} names of {len(planes)} facets")
    names = tuple(FacetName(given.tier, given.name) for given in header.names)
    mass = MassProperties(header.volume, inertia)
    return Shape(header.name, vertices, triangles, facets, planes, header.convex, mass, header.findings, names)


def _check_range(name: str, numbers: NDArray[np.int32], count: int) -> None:
    if numbers.size == 0 or numbers.min() < 0 or numbers.max() >= count:
        raise AnswerError(f"{name} beyond what there is")


def _array(part: ArrayPart, dtype: str, shape: tuple[int, ...], descriptor: int, size: int) -> NDArray[np.generic]:
    """The array, in the file's memory and not to be written; of the shape, where -1 is any length."""
    fits = len(part.shape) == len(shape) and all(
        wanted in (-1, given) for given, wanted in zip(part.shape, shape, strict=True)
    )
    count = math.prod(part.shape)
    length = count * np.dtype(DTYPES[part.dtype]).itemsize
    if part.dtype != dtype or not fits or count == 0 or part.offset + length > size:
        raise AnswerError(f"expected {dtype} of shape {shape}, got {part.dtype} of {part.shape} at {part.offset}")
    memory = mmap.mmap(descriptor, length, flags=mmap.MAP_PRIVATE, prot=mmap.PROT_READ, offset=part.offset)
    return np.frombuffer(memory, DTYPES[part.dtype]).reshape(part.shape)


def _utf_8(sentences: Iterable[str]) -> tuple[str, ...]:
    """Without what a file's bytes can put into a text and JSON cannot say."""
    return tuple(sentence.encode("utf-8", "replace").decode() for sentence in sentences)


def _whole_pages(size: int) -> int:
    return -(-size // mmap.ALLOCATIONGRANULARITY) * mmap.ALLOCATIONGRANULARITY

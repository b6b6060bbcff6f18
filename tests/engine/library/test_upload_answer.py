"""The answer of a reading process is data: what was told arrives, and what no honest reader would say is refused."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from culet.engine.library.upload_answer import LENGTH, AnswerError, AnswerFile, TooLittleMemoryError, taken
from culet.errors import InputError, MeshError, TooLargeError
from culet.geometry.designs.limits import MOST_FACETS
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.geometry.stone_file import shape_from_file
from culet.memory_file import memory_file
from culet.optics.sky_files.picture import SkyPicture
from engine.peer import TETRAHEDRON

STONE = shape_from_mesh(TETRAHEDRON, "off", name="t\udcff")
"""Its name has half a character, as a file's may."""
LETTER = "\N{MATHEMATICAL BOLD CAPITAL A}"
"""Outside the plane of 16 bits."""


@pytest.fixture
def file() -> Iterator[int]:
    descriptor = memory_file("answer")
    yield descriptor
    os.close(descriptor)


def test_a_stone_arrives_as_it_was_told(file: int) -> None:
    AnswerFile(file).tell_mesh(STONE)
    stone = taken(file, "mesh")
    assert isinstance(stone, Shape)
    for name in ("vertices", "triangles", "facet_of_triangle", "planes"):
        assert (getattr(stone, name) == getattr(STONE, name)).all()
        assert getattr(stone, name).dtype == getattr(STONE, name).dtype
    assert (stone.mass.inertia == STONE.mass.inertia).all()
    assert (stone.convex, stone.mass.volume, stone.findings) == (True, STONE.mass.volume, STONE.findings)


def test_a_designs_names_arrive_with_its_facets(file: int) -> None:
    """As many as a design may have, each as long as it may be and in letters of four bytes, are not too much."""
    facets = MOST_FACETS // 2
    records = [f"a {angle} 0.5 " + " ".join(f"{96 * k / facets} n {32 * LETTER}" for k in range(facets))
               for angle in (40, -40)]  # fmt: skip
    stone = shape_from_file("\n".join(["g 96", *records]).encode(), "asc")
    assert len(stone.names) > 1.9 * facets
    AnswerFile(file).tell_mesh(stone)
    arrived = taken(file, "mesh")
    assert isinstance(arrived, Shape)
    assert arrived.names == stone.names
    assert arrived.names[0] == (1, 32 * LETTER)


def told_sky(file: int, value: float = 0.5) -> None:
    answer = AnswerFile(file)
    pixels = answer.allocate((2, 4, 3))
    pixels[:] = value
    answer.tell_sky(SkyPicture(pixels, ("Dark.",)))


def test_a_sky_arrives_where_it_was_written(file: int) -> None:
    told_sky(file)
    sky = taken(file, "sky")
    assert isinstance(sky, SkyPicture)
    assert (sky.pixels == 0.5).all()
    assert sky.pixels.dtype == np.float32
    assert not sky.pixels.flags.writeable
    assert sky.findings == ("Dark.",)


@pytest.mark.parametrize("error", [InputError("flat", "file"), MeshError("open"), TooLargeError("wide", "file")])
def test_a_refusal_is_raised_as_it_was(file: int, error: InputError) -> None:
    AnswerFile(file).refuse(error)
    with pytest.raises(type(error), match=str(error)) as refusal:
        taken(file, "mesh")
    assert (type(refusal.value), refusal.value.field) == (type(error), error.field)


def test_a_lack_of_memory_says_how_much_if_that_is_known(file: int) -> None:
    AnswerFile(file).refuse(MemoryError(1234))
    with pytest.raises(TooLittleMemoryError) as refusal:
        taken(file, "sky")
    assert refusal.value.needed == 1234


def rewritten(file: int, change: Callable[[dict[str, Any]], object]) -> None:
    """The answer with another header."""
    size = os.fstat(file).st_size
    (length,) = LENGTH.unpack(os.pread(file, LENGTH.size, size - LENGTH.size))
    begin = size - LENGTH.size - length
    header = json.loads(os.pread(file, length, begin))
    change(header)
    text = json.dumps(header).encode()
    os.ftruncate(file, begin)
    os.pwrite(file, text + LENGTH.pack(len(text)), begin)


MESH_LIES: dict[str, Callable[[dict[str, Any]], object]] = {
    "arrays beyond the file": lambda h: h["vertices"].update(shape=[2**30, 3]),
    "more elements than numbers count": lambda h: h["vertices"].update(shape=[2**39, 3]),
    "a negative length": lambda h: h["vertices"].update(shape=[-1, 3]),
    "a place before the file": lambda h: h["vertices"].update(offset=-4096),
    "a place between pages": lambda h: h["vertices"].update(offset=8),
    "points in a plane": lambda h: h["vertices"].update(shape=[6, 2]),
    "a type of its own": lambda h: h["vertices"].update(dtype="object"),
    "triangles of fractions": lambda h: h["triangles"].update(dtype="float32"),
    "no triangles": lambda h: h["triangles"].update(shape=[0, 3]),
    "corners that are not there": lambda h: h["triangles"].update(offset=h["vertices"]["offset"]),
    "fewer facets than triangles": lambda h: h["facet_of_triangle"].update(shape=[3]),
    "another kind": lambda h: h.update(kind="sky"),
    "an error that is none of ours": lambda h: (
        [h.pop(name) for name in list(h)] and h.update(kind="refusal", error="OSError", message="")
    ),
    "a volume that is no number": lambda h: h.update(volume=float("nan")),
    "names of other facets": lambda h: h.update(names=[{"tier": 1, "name": "table"}]),
    "a name without end": lambda h: h.update(names=4 * [{"tier": 1, "name": 33 * "x"}]),
    "something more": lambda h: h.update(run="os.system"),
}


@pytest.mark.parametrize("lie", MESH_LIES)
def test_no_lie_about_arrays_is_believed(file: int, lie: str) -> None:
    AnswerFile(file).tell_mesh(STONE)
    rewritten(file, MESH_LIES[lie])
    with pytest.raises(AnswerError):
        taken(file, "mesh")


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_a_sky_that_no_reader_may_give_is_refused(file: int, value: float) -> None:
    told_sky(file, value)
    with pytest.raises(InputError, match="finite and not below 0"):
        taken(file, "sky")


@pytest.mark.parametrize(
    "content", [b"", b"\0" * 8, LENGTH.pack(2**63), b"{}" + LENGTH.pack(2), b"cos\nsystem\n(S'x'\ntR."]
)
def test_what_is_no_answer_is_refused(file: int, content: bytes) -> None:
    os.pwrite(file, content, 0)
    with pytest.raises(AnswerError):
        taken(file, "sky")


def test_an_answer_that_somebody_can_still_write_to_is_refused(file: int) -> None:
    answer = AnswerFile(file)
    pixels = answer.allocate((2, 4, 3))
    answer.tell_sky(SkyPicture(pixels))
    with pytest.raises(AnswerError, match="sealed"):
        taken(file, "sky")
    del pixels
    assert isinstance(taken(file, "sky"), SkyPicture)
    with pytest.raises(PermissionError):
        os.pwrite(file, b"x", 0)

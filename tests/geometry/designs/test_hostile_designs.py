"""Designs that mean harm, and good ones with bytes changed: a stone, or a refusal, and soon."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from culet.errors import InputError
from culet.geometry.designs.design import DesignType
from culet.geometry.designs.reader import DESIGN_TYPES, read_design
from culet.geometry.stone_file import shape_from_file
from geometry.designs.files import design, gcs_of, gem_of, made

GOOD: dict[DesignType, bytes] = {
    "asc": made("14_quirks_of_02"), "gem": gem_of(design("03_single_cut")), "gcs": gcs_of(design("03_single_cut")),
}  # fmt: skip


def is_a_stone_or_refused(data: bytes, file_type: str) -> bool:
    """Whether it was refused; a stone keeps what the renderer relies on."""
    try:
        stone = shape_from_file(data, file_type)
    except InputError as error:
        said = str(error)
    else:
        said = ""
    if said:
        assert said.startswith(f".{file_type}: ")
        assert len(said) < 500
        return True
    height = stone.vertices @ stone.planes[:, :3].T - stone.planes[:, 3]
    assert height.max() < 1e-7
    assert abs(np.linalg.norm(stone.vertices, axis=1).max() - 1) < 1e-9
    assert len(stone.names) == len(stone.planes)
    assert sum(map(len, stone.findings)) < 10_000
    return False


@pytest.mark.parametrize("file_type", DESIGN_TYPES)
@settings(max_examples=60)
@given(chance=some.randoms(use_true_random=False))
def test_damaged_designs_are_stones_or_refused(file_type: DesignType, chance: some.Random) -> None:  # type: ignore[name-defined]
    data = bytearray(GOOD[file_type])
    for _ in range(chance.choice((1, 1, 2, 8))):
        at = chance.randrange(len(data))
        match chance.randrange(4):
            case 0:
                data[at] = chance.randrange(256)
            case 1:
                del data[at : at + chance.randrange(1, 30)]
            case 2:
                data[at:at] = data[: chance.randrange(60)]
            case _:
                data[at:at] = chance.choice((b"1e308", b"-", b"\r", b"0", b"9" * 400, b"\xff\xfe", b"&#0;", b"<"))
    is_a_stone_or_refused(bytes(data), file_type)


@pytest.mark.parametrize("file_type", DESIGN_TYPES)
@settings(max_examples=60)
@given(some.binary(max_size=300))
def test_random_bytes_are_refused(file_type: DesignType, data: bytes) -> None:
    assert is_a_stone_or_refused(data, file_type)
    is_a_stone_or_refused(GOOD[file_type][:40] + data, file_type)


def cone(count: int) -> bytes:
    """As many facets as a file may have, all in one corner: every one of them meets every other there."""
    rows = [f"a -45 0.5 {96 * k / count:.5f}" for k in range(count)]
    return "\n".join(["g 96", "a 0 1", *rows]).encode()


WORST: dict[str, Callable[[], bytes]] = {
    "cone": lambda: cone(1999),
    "one long line": lambda: b"g 96\na 30 0.5 " + b"1" * 4_000_000,
    "endless notes": lambda: b"g 96\na 0 1\n" + b" G more\n" * 100_000,
    "nothing understood": lambda: b"g 96\na 0 1\nF x\n" + b"?\n" * 200_000,
    "many tiers": lambda: b"g 96\n" + b"a 0 1\n" * 2000,
    "one number": lambda: b"g 96\na 30 " + b"9" * 1_000_000 + b" 3",
}


@pytest.mark.parametrize("name", WORST)
def test_the_worst_designs_known_take_little_time(name: str) -> None:
    start = time.process_time()
    is_a_stone_or_refused(WORST[name](), "asc")
    assert time.process_time() - start < 20  # measured up to 0.5 s


def test_another_ending_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match=r"of type obj, off, stl, ply, glb, asc, gem, gcs, got 'dwg'"):
        shape_from_file(b"x", "dwg")
    with pytest.raises(InputError, match="expected a design of type asc, gem, gcs, got 'obj'"):
        read_design(b"x", "obj")

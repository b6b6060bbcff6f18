"""Meshes through the real reading process."""

import asyncio

import pytest

from culet.engine.limits import Limits
from culet.engine.meshes import WAITING, MeshStore
from culet.errors import BusyError, InputError, MeshError, TooLargeError
from engine.peer import TETRAHEDRON


async def test_a_mesh_becomes_a_stone_and_is_described() -> None:
    store = MeshStore(Limits())
    told = await store.put("gem-1", "off", TETRAHEDRON)
    assert (told["vertices"], told["triangles"], told["facets"], told["convex"]) == (4, 4, 4, True)
    # A regular tetrahedron in the unit sphere: edge sqrt(8/3), volume edge^3 / sqrt(72).
    assert told["volume"] == pytest.approx((8 / 3) ** 1.5 / 72**0.5, rel=1e-9)
    assert len(store["gem-1"].vertices) == 4


@pytest.mark.parametrize("data", [b"", b"not a mesh at all", TETRAHEDRON[:-12]])
async def test_what_is_no_stone_is_refused_with_its_defect(data: bytes) -> None:
    store = MeshStore(Limits())
    with pytest.raises(MeshError) as caught:
        await store.put("a", "off", data)
    assert len(str(caught.value)) > 10
    assert "ended the process" not in str(caught.value)
    assert len(store) == 0


async def test_limits_of_size_are_kept() -> None:
    with pytest.raises(TooLargeError, match="at most 10 bytes, got"):
        await MeshStore(Limits(mesh_bytes=10)).put("a", "off", TETRAHEDRON)
    with pytest.raises(InputError, match="4"):
        await MeshStore(Limits(mesh_triangles=3)).put("a", "off", TETRAHEDRON)


async def test_a_mesh_that_takes_too_long_is_given_up() -> None:
    with pytest.raises(MeshError, match=r"could not be read in 0\.01 s"):
        await MeshStore(Limits(mesh_seconds=0.01)).put("a", "off", TETRAHEDRON)


async def test_an_id_that_could_be_a_path_is_refused() -> None:
    with pytest.raises(InputError, match="letters, digits") as caught:
        await MeshStore(Limits()).put("../a", "off", TETRAHEDRON)
    assert caught.value.field == "mesh"


async def test_the_least_recently_used_mesh_is_forgotten_first() -> None:
    store = MeshStore(Limits(meshes=2))
    await store.put("a", "off", TETRAHEDRON)
    await store.put("b", "off", TETRAHEDRON)
    assert store["a"].convex
    await store.put("c", "off", TETRAHEDRON)
    assert list(store) == ["a", "c"]


async def test_no_more_meshes_wait_than_memory_allows() -> None:
    store = MeshStore(Limits())
    results = await asyncio.gather(
        *(store.put(str(number), "off", b"none") for number in range(WAITING + 1)), return_exceptions=True
    )
    assert [type(result) for result in results].count(BusyError) == 1

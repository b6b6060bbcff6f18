"""Meshes and skies through the real reading process."""

import asyncio
import io

import pytest
from PIL import Image

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.library import upload_store
from culet.engine.library.upload_process import ReadingRoom
from culet.engine.library.upload_store import LEAST_TO_READ, MESH, SKY, WAITING, UploadStore, mesh_size
from culet.errors import BusyError, InputError, MeshError, TooLargeError
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.optics.sky_files.picture import SkyPicture
from culet.scene.stone import MOST_STONES
from engine.peer import TETRAHEDRON
from shared.patience import PATIENCE


async def test_a_mesh_becomes_a_stone_and_is_described() -> None:
    store = UploadStore(MESH, Limits())
    told = await store.put("gem-1", "off", TETRAHEDRON)
    assert (told["vertices"], told["triangles"], told["facets"], told["convex"]) == (4, 4, 4, True)
    # A regular tetrahedron in the unit sphere: edge sqrt(8/3), volume edge^3 / sqrt(72).
    assert told["volume"] == pytest.approx((8 / 3) ** 1.5 / 72**0.5, rel=1e-9)
    assert len(store["gem-1"].vertices) == 4


@pytest.mark.parametrize("data", [b"", b"not a mesh at all", TETRAHEDRON[:-12]])
async def test_what_is_no_stone_is_refused_with_its_defect(data: bytes) -> None:
    store = UploadStore(MESH, Limits())
    with pytest.raises(MeshError) as caught:
        await store.put("a", "off", data)
    assert len(str(caught.value)) > 10
    assert "ended the process" not in str(caught.value)
    assert len(store) == 0


async def test_limits_of_size_are_kept() -> None:
    with pytest.raises(TooLargeError, match="at most 10 bytes, got"):
        await UploadStore(MESH, Limits(max_upload_bytes=10)).put("a", "off", TETRAHEDRON)
    with pytest.raises(InputError, match="4"):
        await UploadStore(MESH, Limits(max_mesh_triangles=3)).put("a", "off", TETRAHEDRON)


async def test_a_mesh_that_takes_too_long_is_given_up() -> None:
    with pytest.raises(MeshError, match=r"could not be read in 0\.01 s"):
        await UploadStore(MESH, Limits(read_seconds=0.01)).put("a", "off", TETRAHEDRON)


async def test_an_id_that_could_be_a_path_is_refused() -> None:
    with pytest.raises(InputError, match="letters, digits") as caught:
        await UploadStore(MESH, Limits()).put("../a", "off", TETRAHEDRON)
    assert caught.value.field == "mesh"


async def test_the_least_recently_used_mesh_is_forgotten_first() -> None:
    store = UploadStore(MESH, Limits(max_uploads=2))
    await store.put("a", "off", TETRAHEDRON)
    await store.put("b", "off", TETRAHEDRON)
    assert store["a"].convex
    await store.put("c", "off", TETRAHEDRON)
    assert list(store) == ["a", "c"]


async def test_no_more_meshes_wait_than_memory_allows() -> None:
    store = UploadStore(MESH, Limits())
    results = await asyncio.gather(
        *(store.put(str(number), "off", b"none") for number in range(WAITING + 1)), return_exceptions=True
    )
    assert [type(result) for result in results].count(BusyError) == 1


def png(width: int, height: int, colour: tuple[int, int, int]) -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (width, height), colour).save(buffer, "PNG")
    return buffer.getvalue()


async def test_a_sky_becomes_linear_radiance_and_is_described() -> None:
    store = UploadStore(SKY, Limits())
    told = await store.put("dusk", "png", png(8, 4, (255, 188, 0)))
    assert told == {"width": 8, "height": 4, "largest_radiance": 1.0, "findings": []}
    assert store["dusk"].pixels.shape == (4, 8, 3)
    # IEC 61966-2-1: 188 of 255 is ((188 / 255 + 0.055) / 1.055)^2.4 = 0.5029.
    assert store["dusk"].pixels[0, 0] == pytest.approx([1, 0.5029, 0], abs=1e-4)


async def test_a_sky_of_another_shape_or_without_light_is_taken_and_said_so() -> None:
    told = await UploadStore(SKY, Limits()).put("a", "png", png(8, 8, (0, 0, 0)))
    stretched, black = told["findings"]
    assert "8 x 8 pixels are stretched" in stretched
    assert "black" in black


@pytest.mark.parametrize(("file_type", "data"), [("png", b""), ("hdr", b"#?RADIANCE\n"), ("exr", b"x"), ("jpeg", b"x")])
async def test_what_is_no_sky_is_refused_with_its_defect(file_type: str, data: bytes) -> None:
    store = UploadStore(SKY, Limits())
    with pytest.raises(InputError) as caught:
        await store.put("a", file_type, data)
    assert caught.value.field == "file"
    assert "ended the process" not in str(caught.value)
    assert len(store) == 0


async def test_a_sky_of_too_many_pixels_is_too_large_before_it_is_decoded() -> None:
    header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 20000\n"
    with pytest.raises(TooLargeError, match="20000 x 10000"):
        await UploadStore(SKY, Limits()).put("a", "hdr", header)


async def test_readers_of_both_kinds_at_once_share_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    memory = Memory(3 * LEAST_TO_READ)
    both, rooms = asyncio.Barrier(2), []

    async def read(*arguments: object) -> None:
        room = arguments[-1]
        assert isinstance(room, ReadingRoom)
        rooms.append(room.memory)
        await both.wait()
        assert memory.free >= 0
        raise InputError("none")

    monkeypatch.setattr(upload_store, "read_upload", read)
    mesh, sky = UploadStore(MESH, Limits(), memory), UploadStore(SKY, Limits(), memory)
    async with asyncio.timeout(PATIENCE):
        results = await asyncio.gather(mesh.put("a", "off", b"1"), sky.put("b", "png", b"2"), return_exceptions=True)
    assert [str(result) for result in results] == ["none", "none"]
    assert sum(rooms) <= memory.budget
    assert min(rooms) >= LEAST_TO_READ
    assert memory.free == memory.budget


async def test_what_is_kept_is_bounded_in_memory_too() -> None:
    one = 1000 * 500 * 3 * 4  # bytes of a panorama
    memory = Memory(LEAST_TO_READ + int(2.5 * one))
    store = UploadStore(SKY, Limits(), memory)
    for name in "abcdef":
        await store.put(name, "png", png(1000, 500, (1, 2, 3)))
        assert memory.free >= 0
    assert list(store) == ["d", "e", "f"]


async def test_a_mesh_for_each_stone_is_kept_and_the_one_that_memory_has_no_room_for_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """While a scene shows them, none of as many as a scene may have makes room for another."""

    async def read(_kind: str, _error: object, file_type: str, data: bytes, *_: object) -> Shape:
        return shape_from_mesh(data, file_type)

    monkeypatch.setattr(upload_store, "read_upload", read)
    meshes = {f"m{number}": TETRAHEDRON + b"#%d" % number for number in range(MOST_STONES)}
    one = mesh_size(shape_from_mesh(TETRAHEDRON, "off"))
    memory = Memory(LEAST_TO_READ + (MOST_STONES - 1) * one)
    store = UploadStore(MESH, Limits(max_uploads=1), memory, in_use=lambda: meshes)
    for name, data in meshes.items():
        await store.put(name, "off", data)
    assert list(store) == list(meshes)
    with pytest.raises(BusyError, match=r"reading a mesh needs 64 MiB of memory, 6\d MiB .* are free"):
        await store.put("one-more", "off", TETRAHEDRON)
    assert list(store) == list(meshes)
    assert memory.free >= 0


async def test_what_another_file_of_its_name_replaces_is_forgotten_and_the_same_file_is_not() -> None:
    """Or the device would keep its copy of a sky that nothing names any more."""
    forgotten: list[SkyPicture] = []
    store = UploadStore(SKY, Limits(), forgotten=forgotten.append)
    for colour in ((255, 188, 0), (255, 188, 0), (0, 188, 255)):
        await store.put("dusk", "png", png(8, 4, colour))
    assert [sky.pixels[0, 0, 2] for sky in forgotten] == [0]
    assert store["dusk"].pixels[0, 0, 2] == 1

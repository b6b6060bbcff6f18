"""Pictures as files, read back by other programs' libraries and byte by byte."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import OpenEXR
import PIL.Image
import pytest

from culet.errors import InputError
from culet.gateway.routes.stills import MEDIA_TYPES
from culet.rendering.film import files
from culet.rendering.film.files import FORMATS, encode, write
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene.legacy import LEGACY_DEFAULT
from rendering.views import take

WIDTH, HEIGHT = 97, 55
"""Odd, so that a row's padding or a swapped axis would show."""


@pytest.fixture(scope="module")
def picture(renderer: Renderer) -> DevicePicture:
    return take(renderer, LEGACY_DEFAULT, size=(WIDTH, HEIGHT))


def test_a_tga_is_what_its_specification_says_byte_by_byte(picture: DevicePicture) -> None:
    """Truevision TGA File Format Specification, version 2.0: an 18-byte header, pixels as blue, green, red from the
    bottom row up, and a 26-byte footer."""
    data = encode("tga", picture.rgb, picture.linear)
    identity, map_type, image_type = data[0], data[1], data[2]
    assert (identity, map_type, image_type) == (0, 0, 2)  # no id, no colour map, uncompressed true colour
    assert data[3:8] == bytes(5)  # of the colour map that is not there
    assert struct.unpack_from("<HHHH", data, 8) == (0, 0, WIDTH, HEIGHT)
    assert data[16] == 24
    assert data[17] == 0  # no alpha bits; the origin is the lower left corner
    pixels = np.frombuffer(data, np.uint8, WIDTH * HEIGHT * 3, 18).reshape(HEIGHT, WIDTH, 3)
    assert (pixels[::-1, :, ::-1] == picture.rgb()).all()
    footer = data[18 + pixels.size :]
    assert footer == struct.pack("<II", 0, 0) + b"TRUEVISION-XFILE.\0"


@pytest.mark.parametrize("name", ["tga", "png", "webp"])
def test_lossless_formats_hold_what_is_shown(picture: DevicePicture, name: str) -> None:
    with PIL.Image.open(io.BytesIO(encode(name, picture.rgb, picture.linear))) as image:
        assert image.mode == "RGB"
        assert (np.asarray(image) == picture.rgb()).all()


def test_a_jpeg_is_close_to_what_is_shown(picture: DevicePicture) -> None:
    with PIL.Image.open(io.BytesIO(encode("jpeg", picture.rgb, picture.linear))) as image:
        error = np.asarray(image).astype(int) - picture.rgb()
    assert np.sqrt((error**2).mean()) < 3  # levels
    assert encode("jpg", picture.rgb, picture.linear) == encode("jpeg", picture.rgb, picture.linear)


def test_an_exr_holds_the_linear_radiance_untouched(picture: DevicePicture, tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(encode("exr", picture.rgb, picture.linear))
    channels = OpenEXR.File(str(tmp_path / "a.exr")).channels()
    assert channels["RGB"].pixels.dtype == np.float32
    assert channels["RGB"].pixels.tobytes() == picture.linear().tobytes()
    assert channels["RGB"].pixels.max() > 1  # more than a screen can show


def test_an_npy_holds_the_linear_radiance_untouched(picture: DevicePicture) -> None:
    array = np.load(io.BytesIO(encode("npy", picture.rgb, picture.linear)), allow_pickle=False)
    assert array.dtype == np.float32
    assert array.shape == (HEIGHT, WIDTH, 3)
    assert array.tobytes() == picture.linear().tobytes()


def test_a_picture_in_double_precision_has_the_same_files(exact: Renderer) -> None:
    picture = take(exact, LEGACY_DEFAULT, size=(20, 10))
    array = np.load(io.BytesIO(encode("npy", picture.rgb, picture.linear)))
    assert (array == picture.linear().astype(np.float32)).all()
    assert len(encode("tga", picture.rgb, picture.linear)) == 18 + 600 + 26


def test_the_gateway_names_the_media_type_of_every_format_but_numpys() -> None:
    assert set(FORMATS) - {"jpg", "npy"} == set(MEDIA_TYPES)


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_a_file_is_written_by_its_ending(picture: DevicePicture, tmp_path: Path, name: str) -> None:
    path = tmp_path / f"picture.{name.upper()}"
    write(path, picture.rgb, picture.linear)
    assert path.read_bytes() == encode(name, picture.rgb, picture.linear)
    assert list(tmp_path.iterdir()) == [path]
    assert path.stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize("name", ["picture.gif", "picture", "picture.tar.gz"])
def test_an_unknown_ending_is_refused_with_those_that_exist(picture: DevicePicture, tmp_path: Path, name: str) -> None:
    with pytest.raises(
        InputError, match=r"expected a name that ends in \.tga, \.png, \.jpeg, \.jpg, \.webp, \.exr, \.npy; got"
    ) as refusal:
        write(tmp_path / name, picture.rgb, picture.linear)
    assert refusal.value.field == "path"
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_leaves_the_old_one(
    picture: DevicePicture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether encoding fails or the file's last step: the old picture stays, and nothing beside it."""
    path = tmp_path / "picture.png"
    path.write_bytes(b"old")

    def fail(*_: object) -> bytes:
        raise OSError("no space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(files, "encode", fail)
        with pytest.raises(OSError, match="no space"):
            write(path, picture.rgb, picture.linear)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", fail)
        with pytest.raises(InputError, match=r"path: cannot write .*picture\.png: no space"):
            write(path, picture.rgb, picture.linear)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]

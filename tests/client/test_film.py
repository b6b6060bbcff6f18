"""Films of a session: one size, whatever the frames' are, and their colour."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from culet_client.errors import ClientError
from culet_client.film import Film, fitted
from culet_client.image import Image
from culet_protocol.frame import Codec, Flags, Frame
from video_extra import needs_av

RED, BLUE = (230, 40, 40), (50, 60, 230)


def image(width: int, height: int) -> Image:
    """Stripes of red and blue, one pixel wide."""
    pixels = np.empty((height, width, 3), np.uint8)
    pixels[:, 0::2], pixels[:, 1::2] = RED, BLUE
    frame = Frame(bytes(16), Codec.PNG, Flags.KEY, 1, width, height, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"")
    return Image.checked(frame, pixels)


@needs_av
def test_pictures_of_many_sizes_are_shown_at_one_each_until_the_next_came(tmp_path: Path) -> None:
    import av

    film = Film(tmp_path / "fall.mp4", (160, 90))
    for number, width in enumerate((160, 80, 320)):
        film.add(image(width, width * 9 // 16), 0.5 * number)
    film.finish(2)
    with av.open(str(tmp_path / "fall.mp4")) as file:
        stream = file.streams.video[0]
        pictures = list(file.decode(video=0))
        assert stream.codec_context.profile == "High 4:4:4 Predictive"
    assert {(picture.width, picture.height) for picture in pictures} == {(160, 90)}
    assert [round(picture.time or 0, 2) for picture in pictures] == [0, 0.5, 1, 1.99]
    rgb = pictures[0].to_ndarray(format="rgb24").astype(int)
    assert np.abs(rgb - image(160, 90).pixels).mean() < 4  # 1.1 measured; with chroma 420 it is 67
    assert list(tmp_path.iterdir()) == [tmp_path / "fall.mp4"]


@needs_av
def test_of_pictures_that_come_at_once_the_last_is_shown(tmp_path: Path) -> None:
    film = Film(tmp_path / "fall.mp4", (32, 18))
    for seconds in (0.0, 0.001, 0.002, 0.5):
        film.add(image(32, 18), seconds)
    film.finish(0.5)
    assert film.count == 2


@needs_av
def test_a_film_without_a_picture_leaves_no_file(tmp_path: Path) -> None:
    film = Film(tmp_path / "fall.mp4", (32, 18))
    with pytest.raises(ClientError, match="no picture came"):
        film.finish(1)
    assert list(tmp_path.iterdir()) == []


@needs_av
def test_a_film_that_is_given_up_leaves_no_file(tmp_path: Path) -> None:
    film = Film(tmp_path / "fall.mp4", (32, 18))
    film.add(image(32, 18), 0)
    film.discard()
    assert list(tmp_path.iterdir()) == []


@needs_av
def test_a_pyav_without_the_encoder_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Container:
        def __init__(self, path: str) -> None:
            Path(path).touch()

        def add_stream(self, name: str, **_: object) -> None:
            raise ValueError(name)

        def close(self) -> None:
            pass

    monkeypatch.setattr("av.open", lambda path, *_args, **_options: Container(path))
    with pytest.raises(ClientError, match="no libx264"):
        Film(tmp_path / "fall.mp4", (32, 18))
    assert list(tmp_path.iterdir()) == []


def test_without_pyav_it_is_said_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr("culet_client.film.find_spec", lambda name: None if name == "av" else find(name))
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ClientError, match=r"culet\[video\]"):
        Film(tmp_path / "fall.mp4", (32, 18))


def test_a_picture_of_another_shape_has_bars_and_is_not_stretched() -> None:
    wide = fitted(np.full((10, 40, 3), 200, np.uint8), (40, 40))
    assert wide.shape == (40, 40, 3)
    assert [int(wide[y, 20, 0]) for y in (0, 14, 20, 24, 39)] == [0, 0, 200, 200, 0]

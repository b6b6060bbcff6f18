"""What a failed comparison of pictures leaves behind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pictures import compared

GREY = np.full((4, 6, 3), 0.5)


def failed(folder: Path, picture: object, reference: object) -> Path:
    """Where the message says that the pictures are."""
    with pytest.raises(AssertionError) as failure, compared(picture, reference, folder=folder):  # type: ignore[arg-type]
        raise AssertionError("not alike")
    (note,) = failure.value.__notes__
    return Path(note.removeprefix("the pictures are in "))


def test_pictures_that_are_alike_leave_nothing(tmp_path: Path) -> None:
    with compared(GREY, GREY, folder=tmp_path):
        assert (GREY == 0.5).all()
    assert list(tmp_path.iterdir()) == []


def test_a_failure_leaves_picture_reference_and_difference_as_drawings_and_as_numbers(tmp_path: Path) -> None:
    brighter = GREY.copy()
    brighter[1, 2] = 1.0
    folder = failed(tmp_path, brighter, GREY)
    assert "test_a_failure_leaves_picture" in folder.name
    names = ("picture", "reference", "difference")
    drawn = {name: np.asarray(Image.open(folder / f"{name}.png")) for name in names}
    assert [drawn[name][1, 2].tolist() for name in names] == [[255] * 3, [128] * 3, [255] * 3]
    assert [drawn[name][0, 0].tolist() for name in names] == [[128] * 3, [128] * 3, [0] * 3]
    np.testing.assert_array_equal(np.load(folder / "picture.npy"), brighter)


def test_a_reference_may_be_one_number_and_pixels_are_drawn_as_they_are(tmp_path: Path) -> None:
    folder = failed(tmp_path, np.full((4, 6), 100, np.int16), 40)
    assert np.asarray(Image.open(folder / "picture.png"))[0, 0] == 100
    assert np.asarray(Image.open(folder / "reference.png"))[0, 0] == 40


def test_pictures_of_two_sizes_have_no_difference(tmp_path: Path) -> None:
    folder = failed(tmp_path, GREY, GREY[:2])
    assert not (folder / "difference.png").exists()
    assert np.load(folder / "reference.npy").shape == (2, 6, 3)

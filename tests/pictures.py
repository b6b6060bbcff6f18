"""Pictures of a failed comparison, left on disk to look at."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

FAILED = Path(__file__).parents[1] / "failed-pictures"
"""A folder for each test that failed; git does not see it."""


@contextmanager
def compared(picture: ArrayLike, reference: ArrayLike, *, folder: Path = FAILED) -> Iterator[None]:
    """Around assertions on two pictures: where one fails, both and their difference are written, and it says where.

    Pictures are (height, width) or (height, width, 3): pixels as whole numbers from 0 to 255, or radiance. A reference
    may be one number or colour. Radiance is drawn from 0 to the brightest of both, a difference from 0 to its largest;
    beside each drawing the numbers themselves are kept.
    """
    try:
        yield
    except AssertionError as failure:
        failure.add_note(f"the pictures are in {_leave(np.asarray(picture), np.asarray(reference), folder)}")
        raise


def _leave(picture: NDArray[Any], reference: NDArray[Any], folder: Path) -> Path:
    test = os.environ.get("PYTEST_CURRENT_TEST", "test").removesuffix(" (call)")
    folder = folder / re.sub(r"[^\w.=-]+", "-", test).strip("-")
    folder.mkdir(parents=True, exist_ok=True)
    whole = np.issubdtype(picture.dtype, np.integer)
    ours = picture.astype(np.float64)
    theirs = np.broadcast_to(reference.astype(np.float64), ours.shape) if _fits(reference, ours) else reference * 1.0
    shown = {"picture": ours, "reference": theirs}
    white = 255.0 if whole else max(float(np.nan_to_num(each).max(initial=0)) for each in shown.values())
    if ours.shape == theirs.shape:
        shown["difference"] = abs(ours - theirs)
    for name, values in shown.items():
        np.save(folder / f"{name}.npy", values)
        brightest = float(np.nan_to_num(values).max(initial=0)) if name == "difference" else white
        drawn = np.clip(np.nan_to_num(values, nan=brightest) / (brightest or 1), 0, 1)
        Image.fromarray((255 * drawn).round().astype(np.uint8)).save(folder / f"{name}.png")
    return folder


def _fits(reference: NDArray[Any], picture: NDArray[Any]) -> bool:
    try:
        return np.broadcast_shapes(reference.shape, picture.shape) == picture.shape
    except ValueError:
        return False

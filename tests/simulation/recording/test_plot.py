"""The plot of a path: its curve is where the numbers are, and a wrong name is refused."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest
from PIL import Image

from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.scene import Scene
from culet.simulation.recording.paths import record
from culet.simulation.recording.plot import BOTTOM, CURVE, INK, PANEL, WIDTH, plot
from shared.stages import staged


def test_the_curves_of_a_drop_fill_three_panels_and_end_in_sleep(box: Shape, tmp_path: pathlib.Path) -> None:
    path = record(staged(Scene().moved(((0, 2, 0), (1, 0, 0, 0))), box), 4)
    assert path.asleep[-1]
    plot(path, tmp_path / "drop.png")
    picture = np.asarray(Image.open(tmp_path / "drop.png"))
    assert picture.shape == (3 * PANEL + BOTTOM, WIDTH, 3)
    for panel in range(3):
        curve = (picture[panel * PANEL : (panel + 1) * PANEL] == CURVE).all(axis=-1)
        assert curve.any(axis=0).sum() > 0.8 * WIDTH  # a curve from one side to the other
    first = (picture[:PANEL] == CURVE).all(axis=-1)
    rows = [int(first[:, column].nonzero()[0].mean()) for column in (90, WIDTH - 60)]
    assert rows[0] < rows[1], "it starts high and ends low: rows count downward"
    asleep = (picture[100 : 3 * PANEL] == INK).all(axis=-1).sum(axis=0)
    assert asleep.max() > 0.8 * (3 * PANEL - 100), "one line from top to bottom where it falls asleep"


def test_a_path_of_one_state_and_no_motion_is_drawn_too(box: Shape, tmp_path: pathlib.Path) -> None:
    plot(record(staged(Scene(), box), 0), tmp_path / "still.png")
    assert (tmp_path / "still.png").stat().st_size > 0


@pytest.mark.parametrize("name", ["drop.pdf", "drop", "missing/drop.png"])
def test_a_place_that_it_cannot_be_written_to_is_refused(box: Shape, tmp_path: pathlib.Path, name: str) -> None:
    with pytest.raises(InputError, match="plot"):
        plot(record(staged(Scene(), box), 0), tmp_path / name)

"""The study of the light in moving frames, in miniature."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pytest

from command_line import invoke
from culet.errors import SceneError
from culet.rendering.renderer import Renderer
from culet.scene import preset
from culet.stage import Stage
from culet.study.light.live_light import measure
from shared.stages import staged
from shared.stones import ring

SMALL = ("--width", "64", "--height", "36", "--poses", "1", "--repeats", "1")


def test_a_lower_cutoff_of_moving_light_has_less_error_and_cuts_less(tmp_path: Path) -> None:
    """Measured: errors 0.63, 0.45 and 0.29, cuts 0.46, 0.32 and 0.19."""
    out = tmp_path / "light.json"
    cutoffs = [value for cutoff in ("1e-2", "2e-3", "3e-4") for value in ("--cutoff", cutoff)]
    run = invoke("study", "light", *SMALL, *cutoffs, "-o", out)
    assert run.returncode == 0, run.stderr
    found = json.loads(out.read_text())
    assert (found["width"], found["height"], found["poses"]) == (64, 36, 1)
    coarse_first = found["cutoffs"]
    assert [each["cutoff"] for each in coarse_first] == [1e-2, 2e-3, 3e-4]
    for coarse, fine in pairwise(coarse_first):
        assert 0 < fine["error"] < 0.9 * coarse["error"]
        assert 0 < fine["cut"] < 0.9 * coarse["cut"]
    for each in coarse_first:
        assert each["of_map"] < each["error"] == each["worst"] < 1, "shadows are most of the map; without caustics: 1"
        assert each["cut"] < each["bound"] < 1
        assert each["ratio"] == each["processor_seconds"] / found["shadows_alone"] > 0
    assert run.stdout.count("0.002") == 1


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        (staged(preset("mirror")), "floor: expected a matte floor"),
        (staged(preset("matte"), ring()), "stones: expected convex stones"),
    ],
    ids=["mirror floor", "stone with a hole"],
)
def test_what_throws_no_light_by_beams_onto_a_matte_floor_is_refused(stage: Stage, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        measure(Renderer(), stage, (64, 36), (1e-3,), 1, 1, lambda part: None)

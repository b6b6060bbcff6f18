"""What a viewer sees of a fall, judged: in miniature."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from command_line import invoke
from culet.rendering.renderer import Renderer
from culet.scene import preset
from culet.stage import Stage
from culet.study.stream.moving_pictures import DrawingWay, as_seen, differences, moments_of, planned

FALLING = Stage.of(preset("falling"))
SIZE = (96, 54)


def test_equal_pictures_do_not_differ_and_worse_ones_differ_more() -> None:
    converged = np.full((*SIZE[::-1], 3), 100, np.uint8)
    little, much = converged.copy(), converged.copy()
    little[20:30, 20:30] += 20
    much[20:30, 20:30] += 90
    none, some, more = (np.array(differences(shown, converged)) for shown in (converged, little, much))
    assert none == pytest.approx(0, abs=1e-6)
    assert (none < some).all()
    assert (some < more).all()
    assert some[2] == pytest.approx(20 * np.sqrt(100 / (SIZE[0] * SIZE[1])))


def test_the_moments_are_spread_over_the_fall() -> None:
    """Free until it lands: the height is a parabola."""
    heights = [moment.scene.stones[0].position[1] for moment in moments_of(FALLING, 0.4, 3)]
    start, stone = FALLING.scene.stones[0], FALLING.scene.simulation
    expected = [start.position[1] + start.velocity[1] * t - stone.gravity * t**2 / 2 for t in (0, 0.2, 0.4)]
    assert heights == pytest.approx(expected, abs=1e-3)


def test_what_is_seen_has_the_size_that_was_asked_for_however_it_is_drawn(renderer: Renderer) -> None:
    """Frames that would be late are drawn smaller; a frame of full size is filtered, a smaller one is not."""
    wide = (1280, 720)
    quick, slow = (planned(FALLING, wide, DrawingWay(30, 1, softened=True), unit) for unit in (0.001, 10.0))
    assert quick.size == wide
    assert slow.size < wide
    small = planned(FALLING, SIZE, DrawingWay(30, 1, softened=True), 0.001)
    plain, softened = (as_seen(renderer, FALLING, small, softened=soft)[0] for soft in (False, True))
    assert plain.shape == softened.shape == (*SIZE[::-1], 3)
    assert np.abs(np.diff(softened.astype(int), axis=1)).mean() < np.abs(np.diff(plain.astype(int), axis=1)).mean()


def test_the_study_judges_each_way_of_drawing(tmp_path: Path) -> None:
    out = tmp_path / "motion.json"
    size = ("--width", "64", "--height", "36")
    run = invoke("study", "motion", *size, "--moments", "2", "--reference", "4", "--dearer", "9", "-o", str(out))
    assert run.returncode == 0, run.stderr
    judged = json.loads(out.read_text())["judged"]
    assert len(judged) == 2 * 2 * 2
    assert {(each["way"]["rate"], each["way"]["dearer"]) for each in judged} == {(30, 1), (30, 9), (60, 1), (60, 9)}
    assert all(0 < each["flip"] < 1 and each["seconds"] > 0 for each in judged)
    assert "FLIP" in run.stdout

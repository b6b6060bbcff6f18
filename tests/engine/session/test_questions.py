"""What a viewer asks about its picture: which stone is at a point, and where a stone is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.engine.session import questions
from culet.engine.session.outline import outline_of
from culet.engine.session.picking import Placed
from culet.engine.session.session import Session
from culet.engine.session.viewpoint import axes
from culet.scene import Camera, Scene
from culet_protocol.messages import Answer, Outline, Outlined, Pick, Picked, Question, Reach, Reached
from shared import stones
from shared.stages import staged

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
AHEAD = Camera(position=(0, 0, 10), target=(0, 0, 0), fov_degrees=90)
"""At the target half the picture's height is 10 R."""
ASIDE: dict[str, Any] = {"camera": AHEAD.model_dump(), "stones": [{"id": "left", "position": [-3, 0, 0]}]}


def session(**scene: Any) -> Session:  # noqa: ANN401
    return Session("0" * 32, staged(Scene.read(scene)))


def answer(subject: Session, question: Question) -> Answer:
    return questions.answering(subject, question)()


def placed(x: float = 0, y: float = 0, z: float = 0, scale: float = 1) -> Placed:
    return Placed("block", stones.skew_block(), scale, (x, y, z), UPRIGHT)


def test_the_outline_of_a_stone_far_away_is_its_shadow_on_the_picture() -> None:
    """By parallel rays along -z: x and y of the corners, in halves of the picture's height of 4 R."""
    camera = Camera(kind="orthographic", position=(0, 0, 9), target=(0, 0, 0), height=4)
    found = np.array(outline_of(camera, placed(1, 0.5, scale=2)))
    corners = (2 * stones.skew_block().vertices[:, :2] + (1, 0.5)) / 2
    for point in found:
        assert np.abs(corners - point).max(axis=1).min() < 1e-5
    edges = np.roll(found, -1, axis=0) - found
    for start, (x, y) in zip(found, edges, strict=True):
        across, up = (corners - start).T
        assert (x * up - y * across > -1e-4).all(), "all corners are to the left of each edge"


def test_a_nearer_stone_has_a_larger_outline_and_one_that_reaches_behind_the_camera_none() -> None:
    sizes = [np.ptp(np.array(outline_of(AHEAD, placed(z=z))), axis=0) for z in (0, 5)]
    assert (sizes[1] > 1.8 * sizes[0]).all()
    assert outline_of(AHEAD, placed(z=10)) == []
    assert outline_of(AHEAD, placed(z=15)) == []


def test_a_plate_seen_edge_on_has_an_outline_too() -> None:
    plate = Placed("plate", stones.slab(1e-9), 1, (0, 0, 0), UPRIGHT)
    camera = Camera(kind="orthographic", position=(0, 0, 9), target=(0, 0, 0), height=2)
    assert np.ptp(np.array(outline_of(camera, plate))[:, 0]) == pytest.approx(np.sqrt(2), rel=1e-4)


def test_a_stone_is_found_where_its_outline_is() -> None:
    subject = session(**ASIDE)
    told = answer(subject, Outline(stone="left", step=subject.shown.step))
    assert isinstance(told, Outlined)
    x, y = np.array(told.points).reshape(-1, 2).mean(axis=0)
    assert answer(subject, Pick(number=4, x=x, y=y)) == Picked(number=4, stone="left")
    assert answer(subject, Pick(number=5, x=0, y=0.9)) == Picked(number=5, stone=None)


def test_a_question_changes_nothing_and_where_no_stone_is_none_is_found() -> None:
    subject = session(**ASIDE)
    shown = subject.shown
    assert answer(subject, Pick(number=1, x=5, y=5)) == Picked(number=1, stone=None)
    assert subject.shown is shown
    assert answer(session(stones=[]), Pick(number=2, x=0, y=0)) == Picked(number=2, stone=None)


def test_the_outline_is_that_of_the_picture_of_its_step() -> None:
    subject = session(**ASIDE)
    before = Outline(stone="left", step=subject.shown.step)
    first = answer(subject, before)
    subject.remember(subject.shown)
    right, _, _ = axes(AHEAD)
    camera = AHEAD.model_copy(update={"position": tuple(np.add(AHEAD.position, right))})
    subject.change(subject.stage.showing(subject.scene.model_copy(update={"camera": camera})))
    assert answer(subject, before) == first
    assert answer(subject, Outline(stone="left", step=subject.shown.step)) != first


def test_what_was_done_is_reached_with_the_step_that_shows_it() -> None:
    subject = session(**ASIDE)
    before = subject.shown.step
    assert answer(subject, Reach(number=1)) == Reached(number=1, step=before)
    camera = AHEAD.model_copy(update={"fov_degrees": 30})
    subject.change(subject.stage.showing(subject.scene.model_copy(update={"camera": camera})))
    assert answer(subject, Reach(number=2)) == Reached(number=2, step=subject.shown.step)
    assert subject.shown.step > before


@pytest.mark.parametrize(("stone", "step"), [("gone", 1), ("left", 99)])
def test_what_is_not_there_has_no_outline(stone: str, step: int) -> None:
    told = answer(session(**ASIDE), Outline(stone=stone, step=step))
    assert told == Outlined(stone=stone, step=step, points=())

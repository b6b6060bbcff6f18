"""What a viewer asks about the picture of its session."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import assert_never

from culet.engine.session.outline import outline_of
from culet.engine.session.picking import Placed, placed, struck
from culet.engine.session.session import Session
from culet.errors import NotFoundError
from culet.scene import Camera, Scene
from culet.stage import Stage
from culet_protocol.messages import Answer, Outline, Outlined, Pick, Picked, Question, Reach, Reached


def answering(session: Session, question: Question) -> Callable[[], Answer]:
    """What works out the answer from what the session shows now, or showed at the step that is asked about. In any
    thread: of many stones of many triangles it takes a while."""
    match question:
        case Pick():
            return partial(_picked, session.scene.camera, session.shown.stage, question)
        case Outline():
            try:
                past = session.recall(question.step).scene
            except NotFoundError:
                past = None
            return partial(_outlined, past, session.shown.stage, question)
        case Reach(number=number):
            return partial(Reached, number=number, step=session.shown.step)
        case _:
            assert_never(question)


def _picked(camera: Camera, stage: Stage, question: Pick) -> Picked:
    met = struck(camera, placed(stage), question.x, question.y)
    return Picked(number=question.number, stone=None if met is None else met.name)


def _outlined(past: Scene | None, stage: Stage, question: Outline) -> Outlined:
    """Without points for a stone that is not there, or not any more: another viewer may have removed or cut it anew."""
    stones = [] if past is None else [stone for stone in _placed(past, stage) if stone.name == question.stone]
    points = [] if past is None or not stones else outline_of(past.camera, stones[0])
    return Outlined(stone=question.stone, step=question.step, points=tuple(c for point in points for c in point))


def _placed(scene: Scene, stage: Stage) -> Iterator[Placed]:
    """The scene's stones that have the same shape on the stage."""
    shapes = {stone.id: (stone, shape) for stone, shape in zip(stage.scene.stones, stage.shapes, strict=True)}
    for stone in scene.stones:
        if stone.id not in shapes:
            continue
        now, shape = shapes[stone.id]
        if (now.cut, now.mesh, now.recut) == (stone.cut, stone.mesh, stone.recut):
            yield Placed(stone.id, shape, stone.scale, stone.position, stone.orientation)

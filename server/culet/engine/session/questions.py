"""What a viewer asks about the picture of its session."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from culet.engine.session.outline import outline_of
from culet.engine.session.picking import Placed
from culet.engine.session.session import Session
from culet.errors import NotFoundError
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.messages import Answer, Outline, Outlined, Pick, Picked, Question


def answer(session: Session, question: Question) -> Answer:
    """Of what the session shows, or showed at the step that is asked about; changes nothing."""
    match question:
        case Pick(number=number, x=x, y=y):
            return Picked(number=number, stone=session.pick(x, y))
        case Outline(stone=name, step=step):
            points = _outline(session, name, step)
            return Outlined(stone=name, step=step, points=tuple(c for point in points for c in point))
        case _:
            assert_never(question)


def _outline(session: Session, name: str, step: int) -> list[tuple[float, float]]:
    """Empty for a stone that is not there, or not any more: another viewer may have removed or cut it anew."""
    try:
        past = session.recall(step).scene
    except NotFoundError:
        return []
    stones = _placed(past, session.shown.stage)
    return next((outline_of(past.camera, stone) for stone in stones if stone.name == name), [])


def _placed(scene: Scene, stage: Stage) -> Iterator[Placed]:
    """The scene's stones that have the same shape on the stage."""
    shapes = {stone.id: (stone, shape) for stone, shape in zip(stage.scene.stones, stage.shapes, strict=True)}
    for stone in scene.stones:
        if stone.id not in shapes:
            continue
        now, shape = shapes[stone.id]
        if (now.cut, now.mesh) == (stone.cut, stone.mesh):
            yield Placed(stone.id, shape, stone.scale, stone.position, stone.orientation)

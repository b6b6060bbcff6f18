"""What follows from a scene's light and its room, wherever its stones are: found once, not for each moving frame."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import ReferenceType, ref

from culet.optics.panoramas import Panorama
from culet.stage import Stage

T = TypeVar("T")

KEPT = 16
"""Scenes whose answers are kept: of sessions that move at the same time, each has one."""


def of_room(find: Callable[[Stage], T]) -> Callable[[Stage], T]:
    """A function of a stage that looks at nothing but emitters, sky, floor and walls, and answers the same as long
    as those are the same objects: a scene whose stones move keeps them. What it returns must not be changed."""
    known: deque[tuple[tuple[object, ...], ReferenceType[Panorama] | None, T]] = deque(maxlen=KEPT)

    @wraps(find)
    def found(stage: Stage) -> T:
        scene, panorama = stage.scene, stage.panorama
        parts = scene.emitters, scene.environment, scene.floor, scene.walls
        for others, sky, answer in tuple(known):
            shown = panorama is None if sky is None else panorama is not None and sky() is panorama
            if shown and all(one is other for one, other in zip(parts, others, strict=True)):
                return answer
        answer = find(stage)
        known.appendleft((parts, None if panorama is None else ref(panorama), answer))
        return answer

    return found

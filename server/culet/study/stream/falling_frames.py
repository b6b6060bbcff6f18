"""Stages of a scene whose stones fall, as frames of a film show them."""

from __future__ import annotations

from culet.scene.model import Scene
from culet.simulation.staged import world_of
from culet.stage import Stage

RATE = 30.0
"""Frames a second."""


def falling(scene: Scene, count: int) -> list[Stage]:
    """So many of them from the beginning of the fall on."""
    stage = Stage.of(scene)
    world = world_of(stage)
    stages = []
    for number in range(count):
        while world.state.time < number / RATE - 1e-9:
            world.step()
        stages.append(stage.posed([(body.position, body.orientation) for body in world.state.bodies]))
    return stages

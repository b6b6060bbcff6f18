"""The stones of a stage as the bodies of a world."""

from __future__ import annotations

from culet.simulation.bodies import Body
from culet.simulation.one_stone.drop import drop_position
from culet.simulation.rigid_body.settings import mass_of
from culet.simulation.rigid_body.surfaces import surfaces_of
from culet.simulation.world import World
from culet.stage import Stage


def bodies_of(stage: Stage) -> tuple[Body, ...]:
    """A body for each stone, named by its id, at its start."""
    return tuple(
        Body(
            stone.id, shape, stone.position, stone.orientation, stone.velocity, stone.spin, stone.scale,
            mass_of(stone, shape, stage.scene.millimetres), stone.restitution, stone.friction,
        )
        for stone, shape in zip(stage.scene.stones, stage.shapes, strict=True)
    )  # fmt: skip


def world_of(stage: Stage) -> World:
    """The stones at their starts, between the surfaces of the scene and under its law."""
    return World(bodies_of(stage), surfaces_of(stage.scene), stage.scene.simulation)


def dropped(stage: Stage) -> Stage:
    """The stage with its stones where they fall from: of several all are lifted together, or they would overlap."""
    stones = stage.scene.stones
    if len(stones) > 1:
        world = world_of(stage)
        world.drop()
        return stage.posed((body.position, body.orientation) for body in world.state.bodies)
    return stage.posed(
        (drop_position(shape, stone.position, stone.orientation), stone.orientation)
        for stone, shape in zip(stones, stage.shapes, strict=True)
    )

"""How a world of stones follows a stage that has changed: stones come and go, are put elsewhere or made anew."""

from __future__ import annotations

from collections.abc import Mapping

from culet.simulation.bodies import Body, BodyState
from culet.simulation.rigid_body.surfaces import surfaces_of
from culet.simulation.world import World
from culet.stage import Stage


def moved_by(stage: Stage) -> object:
    """What motion depends on."""
    scene = stage.scene
    return scene.stones, stage.shapes, scene.simulation, surfaces_of(scene), scene.millimetres


def same_form(one: Body, other: Body) -> bool:
    """Whether two stones have the same shape and size."""
    return one.shape is other.shape and one.scale == other.scale


def adapt(world: World, stage: Stage, wanted: Mapping[str, Body], states: Mapping[str, BodyState]) -> bool:
    """Make the world that of a stage, whose bodies are `wanted`, by their names; the stones that `states` names are in
    these states from then on. Whether all stones begin anew, and time with them.

    Whoever calls saves the world before: where an error comes, a part of it may have changed.
    """
    bodies = world.bodies
    kept = [body for body in bodies if body.name in wanted and body.name not in states]
    anew = [body.name for body in kept if _begins_anew(body, wanted[body.name])]
    world.adjust(stage.scene.simulation)
    world.surround(surfaces_of(stage.scene))
    for gone in [body.name for body in bodies if body.name not in wanted]:
        world.remove(gone)
    for body in wanted.values():
        _fit(world, body, states.get(body.name))
    if len(anew) == len(wanted):
        world.reset()
        return True
    for name in anew:
        world.reset(name)
    return False


def in_order(world: World, names: object) -> World:
    """The same bodies in the order of a snapshot's, if those are the same."""
    bodies = {body.name: body for body in world.bodies}
    if not isinstance(names, list) or sorted(map(str, names)) != sorted(bodies) or list(bodies) == names:
        return world
    return World([bodies[name] for name in names], world.surfaces, world.law)


def _fit(world: World, body: Body, state: BodyState | None) -> None:
    """Make a stone of the world what it is to be, or add it; in that state, if one is given."""
    old = next((each for each in world.bodies if each.name == body.name), None)
    if old is None:
        world.add(body, state)
        return
    if not old.like(body) or _begins_anew(old, body):
        world.change(body)
    if state is not None:
        world.put(body.name, state)


def _begins_anew(old: Body, new: Body) -> bool:
    """Whether a stone is to be put to its start."""
    starts = [(body.position, body.orientation, body.velocity, body.spin) for body in (old, new)]
    return starts[0] != starts[1] or not same_form(old, new)

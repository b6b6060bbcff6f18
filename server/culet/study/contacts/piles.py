"""Stones at rest for the presets `trio` and `heap`: `python -m culet.study.contacts.piles` lets them fall.

It writes where they came to lie into `culet/scene/piles.json`, to a millionth of R.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import culet.scene
from culet.scene import Scene
from culet.scene.cuts import BrilliantCut
from culet.scene.room import FLOOR_Y
from culet.simulation.rigid_body.rotation import product, rotate_back
from culet.simulation.rigid_body.state import Quaternion
from culet.simulation.rigid_body.surfaces import Surface, surfaces_of
from culet.simulation.staged import world_of
from culet.simulation.world import World
from culet.stage import Stage
from culet.study.contacts.worlds import about, turned

FILE = Path(culet.scene.__file__).parent / "piles.json"
PATIENCE = 60.0
"""s that they may take until all sleep."""
DIGITS = 6
FRICTION = 0.5
"""Of the heap, which would spread by the scene's 0.3."""
TOUCHING = 1e-6
"""R between two that touch."""
CORNER = (-8 / math.sqrt(3), -8.0)
"""x and z, R, where the wall behind meets the one on the left."""

STEEP = BrilliantCut(table_percent=55, crown_degrees=40, pavilion_degrees=43).model_dump()
"""As the coloured presets', which would have a window by a diamond's angles."""
TRIO: Sequence[dict[str, Any]] = (
    {"id": "diamond", "material": "diamond"},
    {"id": "ruby", "material": "ruby", "cut": STEEP, "scale": 0.85},
    {"id": "sapphire", "material": "sapphire", "cut": STEEP, "scale": 0.7},
)
GEMS = ("diamond", "ruby", "sapphire", "emerald", "diamond", "spinel")
HEAP: Sequence[dict[str, Any]] = tuple(
    {"id": f"{material}-{number}", "material": material, "scale": scale}
    | ({} if material in ("diamond", "spinel") else {"cut": STEEP})
    for number, (material, scale) in enumerate(
        zip(GEMS * 2, (1, 0.8, 0.65, 0.75, 0.7, 0.9, 0.85, 0.7, 0.9, 0.6, 0.95, 0.65), strict=True), 1
    )
)


def fallen(
    stones: Sequence[dict[str, Any]],
    seed: int,
    place: tuple[float, float],
    screens: Sequence[Surface],
    **room: Any,  # noqa: ANN401
) -> World:
    """The world in which they have come to rest, that fell one after the other onto a place of the floor (x, z).

    Screens keep them together as they fall; then these are taken away, and the stones settle by the scene's own law.
    """
    rng = np.random.default_rng(seed)
    offsets = rng.uniform(-0.1, 0.1, (len(stones), 2))
    laid = [
        stone
        | {
            "position": [place[0] + float(x), 0.5 + 2.2 * number, place[1] + float(z)],
            "orientation": turned(rng),
            "spin": rng.normal(size=3).tolist(),
        }
        for number, (stone, (x, z)) in enumerate(zip(stones, offsets, strict=True))
    ]
    scene = Scene.read({"stones": laid, **room})
    moving, surfaces = world_of(Stage.of(scene)), surfaces_of(scene)
    moving.surround((*surfaces, *screens))
    moving.adjust(scene.simulation.model_copy(update={"restitution": 0.2}))
    settle(moving)
    moving.adjust(scene.simulation)
    moving.surround(surfaces)
    settle(moving)
    return moving


def settle(moving: World) -> None:
    """Step until all sleep."""
    until = moving.state.time + PATIENCE
    while not moving.settled and moving.state.time < until:
        moving.step()
    if not moving.settled:
        raise RuntimeError(f"expected {len(moving.bodies)} stones to sleep within {PATIENCE} s")


def screens_about(place: tuple[float, float], distance: float, *turns: float) -> tuple[Surface, ...]:
    """Upright planes that face a place of the floor (x, z) from those azimuths (radians, from +x to +z)."""
    x, z = place
    return tuple(
        Surface((-math.cos(turn), 0.0, -math.sin(turn)), -math.cos(turn) * x - math.sin(turn) * z - distance)
        for turn in turns
    )


def written(stones: Sequence[dict[str, Any]], moving: World) -> list[dict[str, Any]]:
    """The stones as a scene has them, where they lie."""
    return [
        stone
        | {
            "position": [round(c, DIGITS) for c in state.position],
            "orientation": [round(c, DIGITS) for c in state.orientation],
        }
        for stone, state in zip(stones, moving.state.bodies, strict=True)
    ]


def piles() -> dict[str, list[dict[str, Any]]]:
    """By the names of the presets."""
    return {"trio": written(TRIO, trio()), "heap": written(HEAP, heap())}


def trio() -> World:
    """Three that lie on their pavilions, as the presets of one stone do, each touching the others."""
    stage = Stage.of(Scene.read({"stones": list(TRIO)}))
    moving = world_of(stage)
    lying = stage.scene.stones[0].orientation
    names = [body.name for body in moving.bodies]
    for name, turn, place in zip(names, (0.0, 0.5, -0.6), ((0.0, 0.0), (-3.0, 1.2), (3.0, 1.2)), strict=True):
        put(moving, name, place, product(about((0.0, 1.0, 0.0), turn), lying))
    settle(moving)
    first, second, third = names
    slide(moving, second, (first,), (1.0, -0.25))
    slide(moving, third, (first, second), (-1.0, -0.25))
    settle(moving)
    return moving


def put(moving: World, name: str, place: tuple[float, float], orientation: Quaternion) -> None:
    """Lay a stone onto the floor."""
    body = next(body for body in moving.bodies if body.name == name)
    lowest = float((body.scale * body.shape.vertices @ np.array(rotate_back(orientation, (0.0, 1.0, 0.0)))).min())
    moving.move(name, (place[0], FLOOR_Y - lowest, place[1]), orientation, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def slide(moving: World, name: str, others: Sequence[str], way: tuple[float, float]) -> None:
    """Along the floor until it touches one of the others, to a millionth of R: no step is longer than the gap."""
    index = [body.name for body in moving.bodies].index(name)
    for _ in range(1000):
        gap = min(moving.separation(name, other) for other in others)
        if gap < TOUCHING:
            return
        state, step = moving.state.bodies[index], gap / math.hypot(*way)
        x, y, z = state.position
        moving.move(name, (x + way[0] * step, y, z + way[1] * step), state.orientation)
    raise RuntimeError(f"expected {name} to meet one of {', '.join(others)} on its way {way}")


def heap(seed: int = 4) -> World:
    """A dozen in the corner of two walls."""
    x, z = CORNER
    turn = math.radians(60)  # from the corner into the room: half way between the walls
    way = 2.4
    place = x + way * math.cos(turn), z + way * math.sin(turn)
    return fallen(
        HEAP, seed, place, screens_about(place, 0.9, turn), walls={"kind": "matte"}, simulation={"friction": 0.5}
    )


def main() -> None:
    """Write the file."""
    FILE.write_text(json.dumps(piles(), indent=1) + "\n")


if __name__ == "__main__":
    main()

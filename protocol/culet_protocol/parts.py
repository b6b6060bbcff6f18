"""What changed in a scene, as its parts: how a `change` notice tells it, and how a viewer applies it.

A part's name is a field of the scene, such as `camera`, with its new value; or `stones.` and an id, with the stone as
it now is, null for one that is gone. A new stone comes after the others. Where that would give another order, the part
`stones` has all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

STONE = "stones."

Document = Mapping[str, Any]


def changed_parts(before: Document, after: Document) -> dict[str, Any]:
    """The parts by which `after` differs from `before`, both whole scenes."""
    parts = {
        name: after[name] for name in after if name != "stones" and (name not in before or after[name] != before[name])
    }
    old, new = _by_id(before), _by_id(after)
    if [*(name for name in old if name in new), *(name for name in new if name not in old)] != list(new):
        return parts | {"stones": after["stones"]}
    parts |= {STONE + name: None for name in old if name not in new}
    return parts | {STONE + name: stone for name, stone in new.items() if stone != old.get(name)}


def with_parts(scene: Document, parts: Document) -> dict[str, Any]:
    """The scene with these parts; what did not change is the same object as before."""
    of_stones = {name.removeprefix(STONE): stone for name, stone in parts.items() if name.startswith(STONE)}
    after = {**scene, **{name: value for name, value in parts.items() if not name.startswith(STONE)}}
    if of_stones:
        stones = _by_id(after) | of_stones
        after["stones"] = [stone for stone in stones.values() if stone is not None]
    return after


def _by_id(scene: Document) -> dict[str, Any]:
    return {stone["id"]: stone for stone in scene.get("stones", ())}

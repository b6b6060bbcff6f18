"""Changing a scene's JSON by a merge patch (RFC 7396) that reaches each stone by its id.

`{"stones": {"ruby": {"material": "sapphire"}}}` changes one stone and leaves the others; null removes a stone; an id
that there is not adds one, if the patch gives it a shape; a list takes the place of all stones.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from culet.errors import SceneError
from culet.scene.atelier import LAMPS
from culet.scene.model import Scene
from culet.scene.sky import SKIES_WITHOUT_LAMPS

TAGS = ("kind", "name", "shape")
"""Fields that say which form an object has: one of another form is replaced, as it has other fields."""
WHOLE = frozenset({"material"})
"""Fields whose forms have nothing in common."""


def merge_patch(target: Any, patch: Any) -> Any:  # noqa: ANN401 - whatever JSON holds
    """`target` with `patch` applied, after the pseudocode of RFC 7396 section 2; neither argument is changed.

    Unlike there, an object whose `kind` (or another of TAGS) the patch changes is replaced and not merged: a light sky
    has no use for the ground of the studio before it, and would be refused with it. So is what WHOLE names.
    """
    if not isinstance(patch, dict):
        return patch
    merged = dict(target) if isinstance(target, dict) and not _of_another_form(target, patch) else {}
    for name, value in patch.items():
        if value is None:
            merged.pop(name, None)
        else:
            merged[name] = merge_patch(None if name in WHOLE else merged.get(name), value)
    return merged


def patched(scene: Mapping[str, Any], patch: Mapping[str, Any]) -> dict[str, Any]:
    """A whole scene's JSON with a patch applied, still to be validated; SceneError about a stone that there is not.

    A patch to another kind of sky that names no emitters leaves that sky the lamps that it shows: a studio without any
    gets the atelier's; `dark` and `light` keep theirs, which they do not show; any other sky loses its lamps.
    """
    stones, rest = patch.get("stones"), {name: value for name, value in patch.items() if name != "stones"}
    after: dict[str, Any] = merge_patch(dict(scene), rest)
    if isinstance(stones, dict):
        after["stones"] = _patched_stones(scene["stones"], stones)
    elif "stones" in patch:
        after = merge_patch(after, {"stones": stones})
    kind, before = _kind(after), _kind(scene)
    if kind != before and "emitters" not in patch and isinstance(after.get("emitters"), list):
        after["emitters"] = emitters_under(kind, after["emitters"])
    return after


def read_patched(scene: Mapping[str, Any], patch: Mapping[str, Any]) -> Scene:
    """The scene that a patch makes of a whole scene's JSON; SceneError, which names a stone by the id that the patch
    reached it by."""
    after = patched(scene, patch)
    try:
        return Scene.read(after)
    except SceneError as error:
        _, _, place = (error.field or "").partition("stones.")
        number, dot, rest = place.partition(".")
        if not (isinstance(patch.get("stones"), dict) and number.isdecimal() and int(number) < len(after["stones"])):
            raise
        field = f"stones.{after['stones'][int(number)]['id']}{dot}{rest}"
        raise SceneError(f"{field}{str(error).removeprefix(error.field or '')}", field) from error


def sharing(scene: Scene, before: Scene) -> Scene:
    """A scene equal to `scene`, of which those fields and stones that equal `before`'s are the very same objects: many
    scenes that differ in little take little more memory than one."""
    known = {stone.id: stone for stone in before.stones}
    stones = tuple(known[stone.id] if known.get(stone.id) == stone else stone for stone in scene.stones)
    shared = {name: value for name, value in before if name != "stones" and getattr(scene, name) == value}
    return scene.model_copy(update=shared | {"stones": before.stones if stones == before.stones else stones})


def emitters_under(sky: object, emitters: list[Any]) -> list[Any]:
    """A list of emitters as a scene has it that is put under a sky of that kind."""
    if sky in SKIES_WITHOUT_LAMPS:
        return emitters
    points = [emitter for emitter in emitters if isinstance(emitter, dict) and emitter.get("shape") == "point"]
    if sky != "studio":
        return points
    own = [lamp.model_dump(mode="json") for lamp in LAMPS]
    return emitters if len(points) < len(emitters) else [*own, *points]


def _patched_stones(stones: list[dict[str, Any]], patch: Mapping[str, Any]) -> list[dict[str, Any]]:
    after = {stone["id"]: stone for stone in stones}
    for name, change in patch.items():
        field = f"stones.{name}"
        if name in after and change is None:
            del after[name]
        elif name in after:
            after[name] = _of_id(name, merge_patch(after[name], _an_object(field, change)))
        elif change is None or not {"cut", "mesh"} & {
            part for part, value in _an_object(field, change).items() if value
        }:
            there = ", ".join(after) or "none"
            raise SceneError(
                f"{field}: expected the id of a stone ({there}), or a new stone with its `cut` or `mesh`; got {name!r}",
                field,
            )
        else:
            after[name] = _of_id(name, merge_patch({}, change))
    return list(after.values())


def _an_object(field: str, change: object) -> dict[str, Any]:
    if not isinstance(change, dict):
        raise SceneError(f"{field}: expected an object, or null; got {change!r:.80}", field)
    return change


def _of_id(name: str, stone: dict[str, Any]) -> dict[str, Any]:
    if stone.setdefault("id", name) != name:
        field = f"stones.{name}.id"
        raise SceneError(f"{field}: expected {name!r}, since an id cannot be changed; got {stone['id']!r:.80}", field)
    return stone


def _of_another_form(target: dict[str, Any], patch: dict[str, Any]) -> bool:
    return any(tag in target and patch.get(tag, target[tag]) != target[tag] for tag in TAGS)


def _kind(scene: Mapping[str, Any]) -> object:
    environment = scene.get("environment")
    return environment.get("kind") if isinstance(environment, dict) else "studio"

"""What is new of a session since the gateways were told of it last: an edit tells what it changed, not the scene."""

from __future__ import annotations

from typing import Any

from culet.scene import Scene
from culet_protocol.engine import SessionChange, SessionMotion
from culet_protocol.messages import Condition
from culet_protocol.parts import STONE, changed_parts


class News:
    """Mutable: it remembers what was told. Used on the loop, while nothing of the session is being changed."""

    def __init__(self, session: str, scene: Scene, condition: Condition) -> None:
        """Of the session of that name, which is about to be opened with this scene in this condition, and of whose
        snapshot nothing was told."""
        self._session = session
        self.revision = 0
        """Of what was told last."""
        self.condition = condition
        """What was told last."""
        self._scene = scene
        self._snapshot: dict[str, Any] = {}

    def change(
        self, scene: Scene, condition: Condition, snapshot: dict[str, Any], *, moving: bool, edited: bool
    ) -> SessionChange:
        """Everything that is new. Where stones move and none of them was edited, their motion is left to `motion`,
        which tells it 20 times a second: a pointer's events come more often, and of many stones it is large."""
        parts = scene_parts(self._scene, scene)
        if moving and not any(name.startswith(STONE) or name == "stones" for name in parts):
            snapshot = {name: value for name, value in snapshot.items() if name != "simulation"}
        since, self.revision = self.revision, self.revision + 1
        self._scene, self.condition = scene, condition
        return SessionChange(
            session=self._session,
            revision=self.revision,
            since=since,
            parts=parts,
            edited=edited,
            moved=self._moved(snapshot),
            **condition.model_dump(),
        )

    def motion(self, moving_part: dict[str, Any]) -> SessionMotion:
        """What changed without anybody doing something, of that part of the snapshot."""
        return SessionMotion(session=self._session, moved=self._moved(moving_part))

    def _moved(self, snapshot: dict[str, Any]) -> dict[str, Any]:
        moved = {
            name: value
            for name, value in snapshot.items()
            if name not in self._snapshot or self._snapshot[name] != value
        }
        self._snapshot |= moved
        return moved


def scene_parts(before: Scene, after: Scene) -> dict[str, Any]:
    """`changed_parts` of two scenes, as JSON's types. What is the same object, as most are, is not looked into."""
    stones = {stone.id: stone for stone in after.stones}
    parts: dict[str, Any] = {}
    for name in changed_parts(_shallow(before), _shallow(after)):
        stone = stones.get(name.removeprefix(STONE)) if name.startswith(STONE) else None
        if name.startswith(STONE):
            parts[name] = None if stone is None else stone.model_dump(mode="json")
        else:
            parts |= after.model_dump(mode="json", include={name})
    return parts


def _shallow(scene: Scene) -> dict[str, Any]:
    """The scene's fields as they are, and each stone with its id."""
    return dict(scene) | {"stones": [{"id": stone.id, "stone": stone} for stone in scene.stones]}

"""What a session has shown lately, so that a frame can be rendered again in full quality.

While stones move, or the camera, each shown state differs from the one before in poses and view alone. Of each these
are kept, and once for all such states in a row the scene that they have in common.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from operator import attrgetter
from struct import Struct

from culet.errors import NotFoundError
from culet.scene import Camera, Scene, StoneSettings
from culet.scene.patch import sharing

MOVING = frozenset({"position", "orientation"})
"""What differs of a stone from one shown state to the next."""
STATE_BYTES = 512
"""Of a shown state without its poses; measured 0.4 KiB."""
CAMERA_BYTES = 1024
"""Of a view that is another than that of the state before; measured 0.8 KiB."""
SCENE_BYTES = 6144
"""Of a scene in which more changed than poses and view, without its stones and emitters; measured 5.5 KiB."""
STONE_BYTES = 2048
"""Of a stone of such a scene; measured 1.6 KiB, if all stones are changed."""
EMITTER_BYTES = 2048
"""Of an emitter that is new; measured 1.6 KiB."""

_POSE = Struct("=7d")
_of_scene = attrgetter(*sorted(Scene.model_fields.keys() - {"camera", "stones"}))
_of_stone = attrgetter(*sorted(StoneSettings.model_fields.keys() - MOVING))


@dataclass(frozen=True)
class Past:
    """What was shown, by the names of its mesh and sky: however long it is remembered, it keeps neither."""

    step: int
    scene: Scene
    """With the live camera and the stone's pose."""


@dataclass(frozen=True, eq=False, slots=True)
class _Shown:
    """A shown state, of which parts are shared with the states before and after."""

    scene: Scene
    """But for the view, and for where the stones are."""
    camera: Camera
    poses: bytes
    """Of each stone its centre, R, and its unit quaternion, in double precision: 7 numbers."""

    @classmethod
    def of(cls, scene: Scene, before: _Shown | None) -> _Shown:
        """A scene, which keeps of the one before what is the same."""
        poses = b"".join(_POSE.pack(*stone.position, *stone.orientation) for stone in scene.stones)
        if before is None:
            return cls(scene, scene.camera, poses)
        return cls(
            before.scene if _same_but_moved(before.scene, scene) else sharing(scene, before.scene),
            before.camera if before.camera == scene.camera else scene.camera,
            before.poses if before.poses == poses else poses,
        )

    def whole(self) -> Scene:
        """The scene as it was shown."""
        poses = (((x, y, z), (w, i, j, k)) for x, y, z, w, i, j, k in _POSE.iter_unpack(self.poses))
        return self.scene.model_copy(update={"camera": self.camera}).moved(*poses)

    def nbytes_beside(self, before: _Shown | None) -> int:
        """Bytes of what is not shared with the state before, about."""
        if before is None:
            return STATE_BYTES + len(self.poses) + CAMERA_BYTES + _bytes_of(self.scene, None)
        size = STATE_BYTES
        if self.poses is not before.poses:
            size += len(self.poses)
        if self.camera is not before.camera:
            size += CAMERA_BYTES
        if self.scene is not before.scene:
            size += _bytes_of(self.scene, before.scene)
        return size


class History:
    """The latest of what was shown, each by its step."""

    def __init__(self, length: int = 600, most_bytes: float = math.inf) -> None:
        """That remembers so many, or fewer where these would take more memory; the latest always."""
        self._length = length
        self._most_bytes = most_bytes
        self._shown: OrderedDict[int, _Shown] = OrderedDict()
        self.nbytes = 0
        """About, of what is kept."""

    def __len__(self) -> int:
        return len(self._shown)

    def add(self, past: Past) -> None:
        """Remember it; the oldest are forgotten if there are too many."""
        if past.step in self._shown:
            return
        latest = next(reversed(self._shown.values()), None)
        shown = self._shown[past.step] = _Shown.of(past.scene, latest)
        self.nbytes += shown.nbytes_beside(latest)
        while len(self) > 1 and (len(self) > self._length or self.nbytes > self._most_bytes):
            self._forget_oldest()

    def at(self, step: int, now: Past) -> Past:
        """What was shown at a step, which may be `now`; NotFoundError."""
        if step == now.step:
            return now
        try:
            return Past(step, self._shown[step].whole())
        except KeyError:
            raise NotFoundError(
                f"step {step} was never shown or is forgotten; the session is at step {now.step} "
                f"and keeps the last {len(self)} that it showed"
            ) from None

    def _forget_oldest(self) -> None:
        _, gone = self._shown.popitem(last=False)
        oldest = next(iter(self._shown.values()))
        self.nbytes += oldest.nbytes_beside(None) - oldest.nbytes_beside(gone) - gone.nbytes_beside(None)


def _bytes_of(scene: Scene, before: Scene | None) -> int:
    """What a scene takes beside another."""
    shared = set() if before is None else {id(stone) for stone in before.stones}
    stones = sum(id(stone) not in shared for stone in scene.stones)
    emitters = 0 if before is not None and scene.emitters is before.emitters else len(scene.emitters)
    return SCENE_BYTES + STONE_BYTES * stones + EMITTER_BYTES * emitters


def _same_but_moved(one: Scene, other: Scene) -> bool:
    """Whether two scenes differ in their views and in where their stones are, at most."""
    return (
        len(one.stones) == len(other.stones)
        and all(map(_same_stone, one.stones, other.stones))
        and _of_scene(one) == _of_scene(other)
    )


def _same_stone(one: StoneSettings, other: StoneSettings) -> bool:
    return bool(_of_stone(one) == _of_stone(other))

"""What stages are told apart by, across processes and days."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from culet.journal import differences
from culet.scene import Scene
from culet.stage import Stage


def identity_of(stage: Stage) -> dict[str, Any]:
    """All that a picture of the stage depends on, as JSON: its scene, and a SHA-256 of its shapes and its sky's
    picture."""
    found = hashlib.sha256()
    for shape in stage.shapes:
        found.update(shape.planes.tobytes() + shape.vertices.tobytes() + shape.triangles.tobytes())
    if stage.panorama is not None:
        found.update(np.ascontiguousarray(stage.panorama).tobytes())
    return {"scene": stage.scene.model_dump(mode="json"), "shapes_and_sky": found.hexdigest()}


def motion_of(scenes: Sequence[Scene]) -> dict[str, Any]:
    """What changes from the first scene on, as names with dots between, and a SHA-256 of how."""
    found, moving, first = hashlib.sha256(), set[str](), scenes[0]
    for scene in scenes:
        changed = {name for name in Scene.model_fields if getattr(scene, name) != getattr(first, name)}
        before, now = (each.model_dump(mode="json", include=changed) for each in (first, scene))
        steps = differences(before, now)
        moving.update(path for path, _, _ in steps)
        found.update(json.dumps([(path, value) for path, _, value in steps]).encode() + b"\n")
    return {"moving": sorted(moving), "digest": found.hexdigest()}

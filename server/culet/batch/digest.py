"""What stages are told apart by, across processes and days."""

from __future__ import annotations

import hashlib

import numpy as np

from culet.stage import Stage


def digest_of(stage: Stage) -> str:
    """SHA-256 of all that a picture of the stage depends on: its scene, its stones' shapes, its sky's picture."""
    found = hashlib.sha256(stage.scene.model_dump_json().encode())
    for shape in stage.shapes:
        found.update(shape.planes.tobytes() + shape.vertices.tobytes() + shape.triangles.tobytes())
    if stage.panorama is not None:
        found.update(np.ascontiguousarray(stage.panorama).tobytes())
    return found.hexdigest()

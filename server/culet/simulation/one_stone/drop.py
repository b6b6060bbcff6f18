"""Where a stone falls from that stands on the floor: time alone would not move it."""

from __future__ import annotations

import numpy as np

from culet.geometry.shape import Shape
from culet.scene.room import FLOOR_Y
from culet.simulation.rigid_body.rotation import rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple

DROP_HEIGHT = 1.5
"""y of the centre, R: 2.5 R above the floor, from where a stone takes 0.6 s to fall, in the default picture's sight."""
STANDING = 0.05
"""R above the floor, below which a stone's lowest corner counts as standing on it."""


def drop_position(shape: Shape, position: Triple, orientation: Quaternion) -> Triple:
    """Where to let it fall from: where it is, or, if it stands on the floor, DROP_HEIGHT above that place."""
    x, y, z = position
    lowest = float((shape.vertices @ np.array(rotate_back(orientation, (0.0, 1.0, 0.0)))).min())
    return position if y + lowest - FLOOR_Y > STANDING else (x, max(y, DROP_HEIGHT), z)

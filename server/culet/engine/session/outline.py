"""The outline of a stone in a picture: what a page draws about the one that its viewer chose."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from culet.engine.session.picking import Placed, corners
from culet.engine.session.viewpoint import axes, half_height
from culet.scene import Camera

NEAREST = 1e-3
"""R in front of the eye, below which a corner has no place in the picture."""
DIGITS = 5
"""Of the coordinates: a hundredth of a pixel in the largest pictures."""


def outline_of(camera: Camera, stone: Placed) -> list[tuple[float, float]]:
    """The corners of its outline as the picture shows them, counter-clockwise.

    x to the right and y up, from the picture's centre, in halves of its height. Empty unless all of the stone is in
    front of the camera. A stone that is not convex has the outline of its hull.
    """
    right, up, forward = axes(camera)
    offset = corners(stone) - np.array(camera.position, float)
    depth = offset @ forward
    if camera.kind == "orthographic":
        depth = np.ones_like(depth)
    elif depth.min() < NEAREST:
        return []
    points = np.column_stack([offset @ right, offset @ up]) / (half_height(camera) * depth)[:, None]
    hull = ConvexHull(points, qhull_options="QJ")  # joggled, or a plate that is seen edge-on would have none
    return [(round(x, DIGITS), round(y, DIGITS)) for x, y in points[hull.vertices].tolist()]

"""How much a picture's light map may take."""

from __future__ import annotations

from enum import Enum, auto


class Effort(Enum):
    """Of a picture, on its light map."""

    MOVING = auto()
    """One pass at the scene's cut-off: the next frame needs another map."""
    RESTING = auto()
    """One pass before the picture's first sample; then a part of what a patient one takes, and the sample anew."""
    PATIENT = auto()
    """All that it needs before the picture's first sample, within passes whose number depends on the scene alone."""

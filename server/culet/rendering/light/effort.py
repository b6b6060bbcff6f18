"""How much a picture's light map may take."""

from __future__ import annotations

from enum import Enum, auto


class LightEffort(Enum):
    """Of a picture, on its light map."""

    MOVING = auto()
    """One pass at the scene's cut-off: the next frame needs another map."""
    RESTING = auto()
    """One pass before the picture's first sample; then all that it needs, and the sample anew."""
    PATIENT = auto()
    """All that it needs, within passes whose number depends on the scene alone, before the first sample."""

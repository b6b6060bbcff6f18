"""How much one engine takes on. What is beyond is refused with an error that says so."""

from __future__ import annotations

import math
from dataclasses import dataclass

from culet.errors import InputError


@dataclass(frozen=True)
class Limits:
    """Configured limits of an engine."""

    sessions: int = 64
    idle_seconds: float = 3600
    """A session that nobody watched or touched for this long makes room when the engine is full."""
    stills: int = 8
    """Stills that wait or are being rendered."""
    still_edge: int = 8192
    """Pixels."""
    still_pixels: int = 2**25
    """33.5 Mpixel: 0.4 GB of float32 RGB."""
    live_pixels: int = 2560 * 1440
    """A larger frame that a viewer asks for is rendered this large, with the viewer's aspect ratio."""
    uploads: int = 32
    """Of each kind, mesh or sky, that are kept."""
    upload_bytes: int = 64 * 2**20
    """Of one file."""
    kept_bytes: int = 2**30
    """Of what all kept uploads of a kind take in memory; the latest one is kept in any case."""
    read_seconds: float = 60
    """For reading one upload."""
    mesh_triangles: int = 200_000
    shown_states: int = 600
    """Shown states of a session that can be rendered again: 10 s of motion at 60 frames/s."""


def check_still_size(width: int, height: int, limits: Limits) -> None:
    """InputError if it is beyond the limits."""
    for field, pixels in (("width", width), ("height", height)):
        if not 1 <= pixels <= limits.still_edge:
            raise InputError(f"{field}: expected 1 to {limits.still_edge} pixels, got {pixels}", field)
    if width * height > limits.still_pixels:
        raise InputError(
            f"width: expected at most {limits.still_pixels} pixels in all, got {width} x {height} = {width * height}",
            "width",
        )


def live_size(width: int, height: int, limits: Limits) -> tuple[int, int]:
    """The size, scaled down to the limit if it is beyond; at least 1 x 1."""
    scale = min(1.0, math.sqrt(limits.live_pixels / (width * height)))
    return max(1, int(width * scale)), max(1, int(height * scale))

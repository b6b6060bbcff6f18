"""The memory of pictures, and the size that a live picture can have within it."""

from __future__ import annotations

import math
from collections.abc import Iterable

from culet.engine.capacity.memory import Memory
from culet.engine.painting.live_picture import LivePicture
from culet.scene.film import Film

LEAST_LIVE_SIZE = (160, 90)
"""Pixels that a live picture has in any case."""
ASIDE = 16
"""Bytes of a pixel of the sum that is put aside while the light gets better: four float32."""
SEEN = 3
"""Bytes of a pixel of the frame that was drawn last."""


def picture_bytes(width: int, height: int, film: Film) -> int:
    """Of a picture while it is rendered: two sums of four float32, and three bytes that are shown, for each pixel; to
    hide fireflies a sample, the brightest and what is shown, of four more float32 each, and a luminance."""
    return (35 + (52 if film.fireflies == "hide" else 0)) * width * height


def size_within(memory: Memory, size: tuple[int, int], film: Film, others: Iterable[LivePicture]) -> tuple[int, int]:
    """The size, or one of that shape whose picture takes no more than half of the memory that is free beside other live
    pictures."""
    width, height = size
    needed = _live_bytes(width, height, film)
    held = memory.held()
    taken = (
        sum(held.values())
        - held.get("pictures", 0)
        + sum(_live_bytes(*other.size, other.session.scene.film) for other in others)
    )
    room = max(0, memory.budget - taken) // 2
    if needed <= room:
        return size
    memory.make_room(2 * needed)
    scale = math.sqrt(max(room, _live_bytes(*LEAST_LIVE_SIZE, film)) / needed)
    return size if scale >= 1 else (max(1, int(width * scale)), max(1, int(height * scale)))


def _live_bytes(width: int, height: int, film: Film) -> int:
    """Of a live one, which has another sum while its light gets better, and what was seen of it last."""
    return picture_bytes(width, height, film) + (ASIDE + SEEN) * width * height

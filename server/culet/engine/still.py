"""Stills: pictures asked for once, at full quality, rendered in bands between live frames."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from culet.engine.drawing import Picture, Renderer, band_rows
from culet.errors import BusyError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.scene import Scene
from culet_protocol.engine import Format

SESSION_STILL_SAMPLES = 16
"""Samples per pixel, at least, of a still of a session: no worse than the live picture gets at rest."""


@dataclass(eq=False)
class Still:
    """A picture that somebody waits for."""

    scene: Scene
    stone: Stone | None
    width: int
    height: int
    samples: int
    format: Format
    panorama: Panorama | None = None
    done: asyncio.Future[bytes] = field(default_factory=lambda: asyncio.get_running_loop().create_future())
    picture: Picture | None = None
    bands: Iterator[None] | None = None
    served_at: float = -1e9
    """s, steady clock."""

    def paint(self, renderer: Renderer) -> Iterator[None]:
        """Render, yielding between bands. Runs in the render thread."""
        self.picture = renderer.picture(self.scene, self.stone, self.width, self.height, panorama=self.panorama)
        for _ in self.picture.refine_in_bands(self.samples, band_rows(self.width)):
            yield


class StillQueue:
    """First come, first served; the first is being rendered."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._stills: deque[Still] = deque()

    def __len__(self) -> int:
        return len(self._stills)

    def put(self, still: Still) -> None:
        """Queue a still, or BusyError."""
        self._drop_abandoned()
        if len(self._stills) >= self._limit:
            raise BusyError(f"{self._limit} stills are waiting already; try again later")
        self._stills.append(still)

    def first(self) -> Still | None:
        """The still to render next."""
        self._drop_abandoned()
        return self._stills[0] if self._stills else None

    def remove(self, still: Still) -> None:
        """The still is done, or failed."""
        if still in self._stills:
            self._stills.remove(still)

    def _drop_abandoned(self) -> None:
        self._stills = deque(still for still in self._stills if not still.done.done())

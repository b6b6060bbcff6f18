"""The governor: how good a frame may be while things move, so that the frame rate asked for is held.

It chooses from a ladder of settings, the front of least error for each cost that `python -m culet.study.ladder` has
measured: down at once when a frame has taken too long, up only after a run of frames that would have had time to spare.
At rest nothing is chosen: the picture is refined as the scene has it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files

from culet.scene import Scene

SHARE = 0.8
"""Of a frame's time that rendering may take; the rest is for simulation, tone mapping and the rest of the machine."""
SPARE = 0.85
"""A better setting must be expected to take less than this part of the time before it is tried."""
PATIENCE = 12
"""Frames with time to spare before a better setting is tried: 0.4 s at 30 frames/s, or quality would flicker."""
MEMORY = 0.3
"""Weight of the latest frame in the expected cost; one that took longer than expected counts in full."""
LEAST_WIDTH, LEAST_HEIGHT = 640, 360
"""Pixels below which no frame is scaled, unless the viewer asked for less."""


@dataclass(frozen=True)
class Setting:
    """One rung of the ladder."""

    scale: float
    """Of width and height."""
    cutoff: float
    """At least, whatever the scene says."""
    cost: float
    """Time over that of the first rung, measured."""
    error: float
    """Root mean square error of what is shown, 0 to 1, at one sample a pixel; measured on the default scene."""


def read_ladder() -> tuple[Setting, ...]:
    """As measured, the best first."""
    rungs = json.loads(files(__package__).joinpath("ladder.json").read_text(encoding="utf-8"))["rungs"]
    return tuple(Setting(**rung) for rung in rungs)


class Governor:
    """Of one session's moving frames. Times are in seconds."""

    def __init__(self, ladder: tuple[Setting, ...]) -> None:
        self._ladder = ladder
        self._rung = 0
        self._unit: float | None = None
        """Expected time of the first rung for one pixel."""
        self._spared = 0

    @property
    def setting(self) -> Setting:
        """For the next moving frame."""
        return self._ladder[self._rung]

    def size(self, width: int, height: int) -> tuple[int, int]:
        """In pixels, of the next moving frame for a viewer of that size."""
        least = min(1.0, max(LEAST_WIDTH / width, LEAST_HEIGHT / height))
        scale = max(self.setting.scale, least)
        return max(16, round(width * scale)), max(16, round(height * scale))

    def simplified(self, scene: Scene) -> Scene:
        """The scene of the next moving frame: three indices, without polarisation, and a cut-off by the setting."""
        optics = scene.optics
        changes = {"bands": 3, "polarised": False, "cutoff": max(optics.cutoff, self.setting.cutoff)}
        return scene.model_copy(update={"optics": optics.model_copy(update=changes)})

    def rendered(
        self, seconds: float, size: tuple[int, int], wanted: tuple[int, int], frames_per_second: float
    ) -> None:
        """A moving frame of `size` took that long; a viewer wants `wanted` pixels at that rate. Chooses the next
        setting."""
        pixels = size[0] * size[1]
        relative = self.setting.cost / (self.setting.scale**2)  # of a pixel, by the cut-off
        unit = seconds / pixels / relative
        self._unit = unit if self._unit is None or unit > self._unit else self._unit + MEMORY * (unit - self._unit)
        budget = SHARE / frames_per_second
        if self._expected(self._rung, wanted) > budget:
            self._spared = 0
            while self._rung + 1 < len(self._ladder) and self._expected(self._rung, wanted) > budget:
                self._rung += 1
        elif self._rung > 0 and self._expected(self._rung - 1, wanted) < SPARE * budget:
            self._spared += 1
            if self._spared >= PATIENCE:
                self._spared = 0
                self._rung -= 1
        else:
            self._spared = 0

    def _expected(self, rung: int, wanted: tuple[int, int]) -> float:
        setting = self._ladder[rung]
        least = min(1.0, max(LEAST_WIDTH / wanted[0], LEAST_HEIGHT / wanted[1]))
        scale = max(setting.scale, least)
        return (self._unit or 0) * wanted[0] * wanted[1] * scale**2 * setting.cost / setting.scale**2

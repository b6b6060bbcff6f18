"""What the passes of light of one device share: buffers and programs of beams, and whose turn it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Protocol

from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.photons import Photons
from culet.rendering.opencl.device import Device

LEFT_SECONDS = 2.0
"""For which a pass is kept that nobody waits for any more: the next picture of the same stage goes on with it, as after
a frame that showed something sooner."""


class PassOwner(Protocol):
    """Who has a pass under way."""

    def end_pass(self) -> Iterator[object]:
        """Let it end, or give it up if nobody waits for it; yields between its launches."""

    def give_up_left(self, seconds: float) -> None:
        """Give it up if nobody has waited for it for so long."""


class Passes:
    """Of one device. One thread at a time makes maps."""

    def __init__(self, device: Device, allocate: Callable[[int], Any]) -> None:
        """`allocate` makes a buffer of so many bytes on the device."""
        self.device = device
        self.photons = Photons(device)
        self._allocate = allocate
        self._beams: list[Beams] = []
        """That are at no pass."""
        self._first: Beams | None = None
        """Whose programs the others share."""
        self._under_way: dict[LightEffort, PassOwner] = {}
        """Whose pass has begun and is not done yet. Of each effort there is one at a time: a pass holds 8 MiB a surface
        for each core, and ten pictures would hold that ten times."""

    def give_up_left(self) -> None:
        """Passes that nobody has waited for a while. One holds what it sums, and would do so until another picture of
        the same effort has a pass."""
        for each in list(self._under_way.values()):
            each.give_up_left(LEFT_SECONDS)

    def release(self) -> None:
        """Give up passes that nobody waits for, and give back what is kept for the next one. While no picture is
        refined."""
        for each in list(self._under_way.values()):
            each.give_up_left(0.0)
        self.forget_beams()

    def others_end(self, effort: LightEffort) -> Iterator[object]:
        """Let the pass of such an effort that is under way end, whoever it is for, or give it up if nobody waits for
        it; yields between its launches."""
        while (other := self._under_way.get(effort)) is not None:
            yield from other.end_pass()

    @contextmanager
    def under_way(self, effort: LightEffort, owner: PassOwner) -> Iterator[None]:
        """For as long as a pass takes."""
        self._under_way[effort] = owner
        try:
            yield
        finally:
            del self._under_way[effort]

    def take_beams(self) -> Beams:
        """For one pass; passes of pictures of different efforts may be under way by turns."""
        with suppress(IndexError):  # another thread may have given back what there was
            return self._beams.pop()
        self._first = self._first or Beams(self.device)
        return Beams(self.device, like=self._first)

    def give_back(self, beams: Beams) -> None:
        """For the next pass. Of several whose passes were under way by turns one is kept: each holds up to 8 MiB a
        surface for each core, and for each point a quarter of that. Those of a pass that was given up are not."""
        if beams.clean and not self._beams:
            self._beams.append(beams)

    def forget_beams(self) -> None:
        """Give back what is kept for the next pass. While no picture is refined, or by who refines it: buffers wait for
        the device before they go."""
        self._beams.clear()

    def scratch(self, size: int) -> Any:  # noqa: ANN401
        """Memory for a pass that is not whole yet."""
        return self._allocate(size)

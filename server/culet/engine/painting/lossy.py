"""The final picture at rest as a link had room for it, to be encoded again once there is more."""

from __future__ import annotations

from dataclasses import dataclass

from culet.engine.governing.thrift import ByteAllowance
from culet.engine.painting.live_frame import LiveFrame

WORTH_TIMES = 1.5
"""Times the bytes for which a picture at rest is sent again: two steps of JPEG's quality. One acknowledgement lets the
measured rate of a link grow less, so that a picture does not lead to its own next one."""


@dataclass(frozen=True, eq=False)
class Lossy:
    """The final picture at rest, as it was sent, with loss that it would not have without the limits of a link."""

    frame: LiveFrame
    most_bytes: float
    """For which there was room."""
    looks: tuple[int, int, int]
    """Width, height and quality."""
    thrifty: bool
    """It has more loss than those before it."""

    def improves(self, allowance: ByteAllowance) -> bool:
        """Whether there is room for so many bytes more that the picture is worth being sent again."""
        return allowance.resting(final=True) >= WORTH_TIMES * self.most_bytes

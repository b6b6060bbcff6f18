"""A frame's picture as it is sent."""

from __future__ import annotations

from typing import NamedTuple, Self

from culet.engine.painting.jpeg import Encoded
from culet_protocol.frame import Codec


class Coded(NamedTuple):
    """Of any codec."""

    codec: Codec
    data: bytes
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    quality: int
    """As the codec counts it."""
    thrifty: bool
    """It is less than it would be without the limits of a link."""
    depends_on: int = 0
    """Number of the frame that has to be decoded before it; 0: it needs none."""

    @property
    def looks(self) -> tuple[int, int, int]:
        """Width, height and quality."""
        return self.width, self.height, self.quality

    @classmethod
    def of_jpeg(cls, picture: Encoded, *, thrifty: bool) -> Self:
        """A picture of its own."""
        return cls(Codec.JPEG, picture.data, picture.width, picture.height, picture.quality, thrifty)

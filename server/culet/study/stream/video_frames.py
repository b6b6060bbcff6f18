"""Video decoded again, for judging it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from culet.engine.painting.video import Packet
from culet_client.video import VideoDecoder
from culet_protocol.frame import Codec, Flags, Frame

_FRAME = Frame(bytes(16), Codec.H264, Flags.KEY, 1, 1, 1, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"")


def decoded(codec: Codec, packets: Sequence[Packet]) -> list[NDArray[np.uint8]]:
    """(height, width, 3) pictures of packets that follow each other, the first being a key frame's."""
    decoder, pictures = VideoDecoder(), []
    for number, packet in enumerate(packets, 1):
        flags, before = (Flags.KEY, 0) if packet.is_key else (Flags.NONE, number - 1)
        frame = replace(_FRAME, codec=codec, flags=flags, sequence=number, depends_on=before, payload=packet.data)
        picture = decoder.decode(frame)
        assert picture is not None  # noqa: S101 - none is missing
        pictures.append(picture)
    return pictures

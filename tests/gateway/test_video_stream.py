"""Video on its whole way: a real engine encodes it, a real gateway sends it, and a viewer decodes it."""

from __future__ import annotations

import asyncio
import io
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from culet.gateway.viewers.viewer import Viewer as Watching
from culet_client.video import VideoDecoder, asked_of
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Hello, ResetStone, Resize, ToggleFall
from culet_protocol.watch import VIDEO
from gateway.running import Gateway, Viewer
from shared.patience import PATIENCE
from video_extra import needs_av

PACKETS = 10


async def decoding(viewer: Viewer) -> None:
    """Say, as every client does, what is decoded here."""
    asked = asked_of(Hello.model_validate(await viewer.notice("hello")))
    assert asked is not None
    assert asked.codecs
    await viewer.say(asked)


def packets(frames: list[Frame]) -> list[Frame]:
    return [frame for frame in frames if frame.codec in VIDEO]


async def dropped(viewer: Viewer, condition: Callable[[], bool]) -> None:
    """Receive until the condition holds, of a stone that is dropped again whenever it lies."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            if not viewer.frames or Flags.MOVING not in viewer.frames[-1].flags:
                await viewer.say(ResetStone())
                await viewer.say(ToggleFall())
            await viewer.receive()


def levels(frame: Frame, like: Frame) -> NDArray[np.float64]:
    """Of a JPEG, brought to the size of another frame."""
    picture = Image.open(io.BytesIO(frame.payload)).convert("RGB")
    return np.asarray(picture.resize((like.width, like.height)), float)


@needs_av
async def test_every_packet_of_what_falls_is_decoded_at_once_and_is_the_picture_that_others_get(
    gateway: Gateway,
) -> None:
    session = await gateway.session({"floor": {"kind": "matte"}})
    size = Resize(width=320, height=180)
    async with gateway.viewer(session, size=size) as viewer, gateway.viewer(session, size=size) as other:
        await decoding(viewer)
        await viewer.frame()

        def known() -> set[int]:
            if reading.done():
                reading.result()  # which is what ended it
            return {frame.sequence for frame in packets(viewer.frames)} & {frame.sequence for frame in other.frames}

        reading = asyncio.create_task(other.until(lambda: False))
        try:
            await dropped(viewer, lambda: bool(known()) and len(packets(viewer.frames)) >= PACKETS)
        finally:
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
    decoder, differences = VideoDecoder(), []
    by_number = {frame.sequence: frame for frame in other.frames}
    for frame in packets(viewer.frames):
        picture = decoder.decode(frame)
        assert picture is not None, f"frame {frame.sequence} needs {frame.depends_on}"
        assert picture.shape == (frame.height, frame.width, 3)
        twin = by_number.get(frame.sequence)
        if twin is not None:
            differences.append(float(np.abs(picture - levels(twin, frame)).mean()))
    # Levels, measured 1.4 to 2.1 each; to a frame some numbers before or after 8 to 17, while it falls fast.
    assert np.mean(differences) < 6


@needs_av
async def test_video_goes_on_through_another_size_and_a_picture_at_rest(gateway: Gateway) -> None:
    session = await gateway.session()
    async with gateway.viewer(session, size=Resize(width=320, height=180)) as viewer:
        await decoding(viewer)
        await dropped(viewer, lambda: len(packets(viewer.frames)) >= 3)
        await viewer.say(Resize(width=240, height=240))
        await dropped(viewer, lambda: any(frame.width == frame.height for frame in packets(viewer.frames)))
        await viewer.say(ResetStone())
        before = len(viewer.frames)
        await viewer.until(lambda: any(frame.codec is Codec.JPEG for frame in viewer.frames[before:]))
        before = len(packets(viewer.frames))
        await dropped(viewer, lambda: len(packets(viewer.frames)) >= before + 3)
    decoder = VideoDecoder()
    for frame in packets(viewer.frames):
        assert decoder.decode(frame) is not None, f"frame {frame.sequence} needs {frame.depends_on}"


@needs_av
async def test_lesser_frames_have_video_of_their_own_that_is_decoded_packet_by_packet(
    gateway: Gateway, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = await gateway.session({"floor": {"kind": "matte"}})
    record = gateway.parts.sessions.get(session)
    sizes = Resize(width=320, height=180), Resize(width=160, height=90)
    async with gateway.viewer(session, size=sizes[0]) as viewer, gateway.viewer(session, size=sizes[1]) as other:
        await decoding(viewer)
        await decoding(other)
        await viewer.frame()

        def assign(viewers: Sequence[Watching], *_: object) -> None:
            """As if the second one's link were slow."""
            for one in viewers:
                one.feed.follow_lesser(lesser=one.size == (160, 90))

        monkeypatch.setattr(record.tiers, "assign", assign)
        reading = asyncio.create_task(other.until(lambda: False))

        def lesser() -> list[Frame]:
            if reading.done():
                reading.result()  # which is what ended it
            return [frame for frame in packets(other.frames) if frame.width == 160]

        try:
            await dropped(viewer, lambda: len(lesser()) >= PACKETS and len(packets(viewer.frames)) >= PACKETS)
        finally:
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
    for frames in (packets(viewer.frames), [frame for frame in packets(other.frames) if frame.width == 160]):
        decoder = VideoDecoder()
        for frame in frames:
            picture = decoder.decode(frame)
            assert picture is not None, f"frame {frame.sequence} needs {frame.depends_on}"
            assert picture.shape == (frame.height, frame.width, 3)

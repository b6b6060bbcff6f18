"""Whose topics a gateway listens to, when it asks for a key frame, and when it has an encoder held."""

from __future__ import annotations

import asyncio
from time import monotonic
from typing import Any

from culet.gateway.demands import KEY_SECONDS, PATIENCE_SECONDS, Demands
from culet.gateway.link import EngineLink
from culet.gateway.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings
from culet.gateway.viewer import Viewer
from culet_protocol.engine import Demand, HoldVideo
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Message
from culet_protocol.watch import VIDEO, Stream

NAME = "0" * 32
LARGE = 50_000
"""Bytes: a frame that fills a link of which nothing is known."""


class Link(EngineLink):
    """Remembers what it is told."""

    def __init__(self) -> None:
        super().__init__(GatewaySettings(control="ipc:///none", frames="ipc:///none"))
        self.ready.set()
        self.heard: list[tuple[str, Stream]] = []
        self.holds: list[bool] = []
        self.record = SessionRecord(NAME, {})
        self.demands = Demands(self, {NAME: self.record})

    def _codec(self, topic: bytes) -> Stream:
        return next(codec for codec, its in self.record.topics.items() if its == topic)

    def subscribe(self, session: bytes) -> None:
        self.heard.append(("+", self._codec(session)))

    def unsubscribe(self, session: bytes) -> None:
        self.heard.append(("-", self._codec(session)))

    async def request(
        self, message: Message, payload: bytes | bytearray | None = None, *, patient: bool = False
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        if isinstance(message, HoldVideo):
            self.holds.append(message.held)
        else:
            assert isinstance(message, Demand)
        return {}, b""

    def viewer(self, codec: Codec | None = None) -> Viewer:
        viewer = Viewer(len(self.record.viewers) + 1, now=monotonic())
        viewer.resize(640, 360)
        viewer.feed.follow(codec)
        self.record.viewers.append(viewer)
        return viewer

    async def begin(self) -> None:
        """The engine has been told what is wanted."""
        self.demands.update(self.record)
        for _ in range(5):
            await asyncio.sleep(0)

    def offer(self, sequence: int, codec: Codec, depends_on: int = 0) -> None:
        flags = Flags.NONE if depends_on else Flags.KEY
        numbers = sequence, 1, 1, 1, 3, 1, 0, sequence, 0, 0, 0, 0, 0, 0, 0
        frame = Frame(self.record.topic, codec, flags, *numbers, bytes(LARGE), depends_on=depends_on)
        for viewer in self.record.viewers:
            viewer.offer(frame, frame.pack(), monotonic(), codec)
        self.demands.heed_video(self.record)


async def told(link: Link) -> list[bool]:
    await asyncio.sleep(0)
    return link.holds


async def ended(link: Link) -> None:
    if link.record.demanding is not None:
        link.record.demanding.cancel()
        await asyncio.gather(link.record.demanding, return_exceptions=True)


async def test_without_video_only_pictures_of_their_own_are_listened_to() -> None:
    link = Link()
    link.viewer()
    await link.begin()
    assert link.heard == [("+", Codec.JPEG)]
    await ended(link)


async def test_pictures_of_their_own_are_given_up_once_everybody_follows_the_video() -> None:
    link = Link()
    link.viewer(Codec.H264)
    await link.begin()
    assert link.record.subscribed == {Codec.JPEG, Codec.H264}
    link.offer(1, Codec.H264)
    assert link.record.subscribed == {Codec.H264}
    link.viewer()
    link.demands.update(link.record)
    assert link.record.subscribed == {Codec.JPEG, Codec.H264}
    await ended(link)


async def test_a_key_frame_is_asked_for_by_subscribing_once_more_and_not_twice_a_second() -> None:
    link = Link()
    link.viewer(Codec.H264)
    await link.begin()
    link.heard.clear()
    for sequence in (5, 6, 7):
        link.offer(sequence, Codec.H264, depends_on=sequence - 1)
    assert link.heard == [("+", Codec.H264), ("-", Codec.H264)], "in this order, so that none believes nobody watches"
    link.record.key_asked_at -= KEY_SECONDS
    link.offer(8, Codec.H264, depends_on=7)
    assert len(link.heard) == 4
    await ended(link)


async def test_the_encoder_is_held_while_a_link_is_full_and_goes_on_when_it_is_not() -> None:
    link = Link()
    viewer = link.viewer(Codec.H264)
    await link.begin()
    link.offer(1, Codec.H264)
    assert viewer.next_frame(monotonic()) is not None
    assert await told(link) == []
    link.offer(2, Codec.H264, depends_on=1)  # the first one is still under way
    assert await told(link) == [True]
    viewer.acknowledge(1, monotonic())
    assert viewer.next_frame(monotonic()) is not None
    link.demands.heed_video(link.record)
    assert await told(link) == [True, False]
    await ended(link)


async def test_one_whose_link_is_full_is_not_waited_for_by_others_for_long() -> None:
    link = Link()
    slow, fast = link.viewer(Codec.H264), link.viewer(Codec.H264)
    await link.begin()
    link.offer(1, Codec.H264)
    slow.next_frame(monotonic())
    fast.next_frame(monotonic())
    fast.acknowledge(1, monotonic())
    link.offer(2, Codec.H264, depends_on=1)
    fast.next_frame(monotonic())
    link.demands.heed_video(link.record)
    assert slow.feed.in_step, "it may take it in a moment"
    since = slow.behind(monotonic())
    assert since is not None
    slow._behind_since = since - PATIENCE_SECONDS - 0.01
    link.demands.heed_video(link.record)
    assert [viewer.feed.in_step for viewer in (slow, fast)] == [False, True]
    assert Codec.JPEG in link.record.subscribed
    assert (await told(link))[-1] is False
    await ended(link)


def test_topics_are_all_different() -> None:
    record = SessionRecord(NAME, {})
    assert len(set(record.topics.values())) == 2 + len(VIDEO)

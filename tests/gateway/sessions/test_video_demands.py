"""Whose topics a gateway listens to, when it asks for a key frame, and when it has an encoder held."""

from __future__ import annotations

import asyncio
from time import monotonic
from typing import Any

from culet.gateway.engine.link import EngineLink
from culet.gateway.sessions.demands import KEY_SECONDS, PATIENCE_SECONDS, Demands
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings
from culet.gateway.viewers.viewer import Viewer
from culet_protocol.engine import Demand, HoldVideo
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Message
from culet_protocol.watch import LESSER, VIDEO, Lesser, Stream

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
        self.held: list[tuple[bool, bool]] = []
        """Whether video is held, and is that of lesser pictures."""
        self.answers = asyncio.Event()
        """Whether demands are answered."""
        self.answers.set()
        self.widest = 4096
        """Pixels of the pictures that it makes."""
        self.record = SessionRecord(NAME, {})
        self.demands = Demands(self, {NAME: self.record})

    def _codec(self, topic: bytes) -> Stream:
        return next(codec for codec, its in self.record.topics.items() if its == topic)

    def subscribe(self, session: bytes) -> None:
        self.heard.append(("+", self._codec(session)))

    def unsubscribe(self, session: bytes) -> None:
        self.heard.append(("-", self._codec(session)))

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        if isinstance(message, HoldVideo):
            self.holds.append(message.held)
            self.held.append((message.held, message.lesser))
            return {}, b""
        assert isinstance(message, Demand)
        await self.answers.wait()
        return {"width": min(self.widest, message.width), "height": message.height}, b""

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

    def offer(self, sequence: int, codec: Codec, depends_on: int = 0, stream: Stream | None = None) -> None:
        flags = Flags.NONE if depends_on else Flags.KEY
        numbers = sequence, 1, 1, 1, 3, 1, 0, sequence, 0, 0, 0, 0, 0, 0, 0
        frame = Frame(self.record.topic, codec, flags, *numbers, bytes(LARGE), depends_on=depends_on)
        for viewer in self.record.viewers:
            viewer.offer(frame, frame.pack(), monotonic(), stream or codec)
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


async def test_lesser_pictures_are_listened_to_once_the_engine_knows_their_limits() -> None:
    link = Link()
    link.viewer()
    await link.begin()
    await ended(link)
    small = link.viewer()
    small.resize(160, 90)
    small.feed.follow_lesser(lesser=True)
    link.answers.clear()
    await link.begin()
    link.demands.update(link.record)
    assert link.record.demand.lesser is not None
    assert link.heard == [("+", Codec.JPEG)]
    link.answers.set()
    await link.begin()
    assert link.heard == [("+", Codec.JPEG), ("+", LESSER)]
    await ended(link)


async def test_who_has_had_lesser_pictures_has_the_frame_sent_anew() -> None:
    link = Link()
    link.viewer()
    small = link.viewer()
    small.resize(160, 90)
    small.feed.follow_lesser(lesser=True)
    await link.begin()
    small.feed.follow_lesser(lesser=False)
    link.heard.clear()
    link.demands.update(link.record)
    link.demands.update(link.record)
    again: list[tuple[str, Stream]] = [("+", Codec.JPEG), ("-", Codec.JPEG), ("-", LESSER)]
    assert link.heard == again, "once, and before the engine is told that nobody has lesser pictures"
    await ended(link)


async def test_windows_are_compared_with_the_pictures_that_the_engine_makes() -> None:
    link = Link()
    link.widest = 320
    link.viewer().resize(1280, 320)
    window = link.viewer()
    window.resize(200, 100)
    window.feed.follow_lesser(lesser=True)
    await link.begin()
    assert link.record.drawn_size == (320, 320)
    sizes: list[tuple[int, int]] = []
    link.record.tiers.assign = lambda *arguments: sizes.append(arguments[2])  # type: ignore[method-assign]
    link.demands.update(link.record)
    assert sizes == [(320, 320)]
    await ended(link)


def test_topics_are_all_different() -> None:
    record = SessionRecord(NAME, {})
    assert len(set(record.topics.values())) == len(record.topics) == 2 * (1 + len(VIDEO))


async def test_a_slow_viewer_of_the_lesser_video_has_that_held_and_is_not_barred_for_those_of_the_first() -> None:
    link = Link()
    fast, slow = link.viewer(Codec.H264), link.viewer(Codec.H264)
    slow.feed.follow_lesser(lesser=True)
    link.record.lesser_told = True
    await link.begin()
    assert link.record.subscribed == {Codec.JPEG, Codec.H264, LESSER, Lesser.H264}
    streams: tuple[Stream, ...] = (Codec.H264, Lesser.H264)
    for stream in streams:
        link.offer(1, Codec.H264, stream=stream)
    assert link.record.subscribed == set(streams)
    for viewer in (fast, slow):
        assert viewer.next_frame(monotonic()) is not None
    fast.acknowledge(1, monotonic())
    for stream in streams:
        link.offer(2, Codec.H264, depends_on=1, stream=stream)
    assert fast.next_frame(monotonic()) is not None
    assert slow.behind(monotonic()) is not None
    slow._behind_since = monotonic() - 2 * PATIENCE_SECONDS
    link.demands.heed_video(link.record)
    await asyncio.sleep(0)
    assert slow.feed.in_step, "nobody else follows what this one does"
    assert (True, True) in link.held
    assert (True, False) not in link.held
    link.offer(4, Codec.H264, depends_on=3, stream=Lesser.H264)
    assert ("+", Lesser.H264) in link.heard[-4:], "who missed a packet has a key frame asked for"
    await ended(link)

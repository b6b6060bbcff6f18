"""Which frames one viewer is given: pictures of their own, or a chain of video without a gap."""

from __future__ import annotations

from dataclasses import dataclass, field

from hypothesis import given
from hypothesis import strategies as st

from culet.gateway.viewers.frame_feed import BARRED_SECONDS, MOST_WAITING, FrameFeed
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.watch import VIDEO


def frame(sequence: int, codec: Codec = Codec.JPEG, depends_on: int = 0) -> Frame:
    flags = Flags.NONE if depends_on else Flags.KEY
    numbers = sequence, 1, 1, 1, 3, 1, 0, sequence, 0, 0, 0, 0, 0, 0, 0
    return Frame(bytes(16), codec, flags, *numbers, b"picture", depends_on=depends_on)


def offer(feed: FrameFeed, sequence: int, codec: Codec = Codec.JPEG, depends_on: int = 0, now: float = 0.0) -> None:
    """A frame by the topic of its own codec."""
    feed.offer(frame(sequence, codec, depends_on), b"%d" % sequence, codec, now)


def taken(feed: FrameFeed) -> list[int]:
    return [feed.take().sequence for _ in iter(lambda: feed.next, None)]


def following() -> FrameFeed:
    feed = FrameFeed()
    feed.follow(Codec.H264)
    offer(feed, 1, Codec.H264)
    return feed


def test_of_pictures_of_their_own_only_the_latest_waits() -> None:
    feed = FrameFeed()
    for sequence in (1, 2, 3):
        offer(feed, sequence)
    assert taken(feed) == [3]


def test_who_decodes_video_has_pictures_of_their_own_until_a_key_frame_and_then_every_packet() -> None:
    feed = FrameFeed()
    feed.follow(Codec.H264)
    assert feed.codecs == {Codec.JPEG, Codec.H264}
    offer(feed, 1)
    assert taken(feed) == [1]
    offer(feed, 2, Codec.H264)
    offer(feed, 3, Codec.H264, depends_on=2)
    assert feed.codecs == {Codec.H264}
    offer(feed, 4)  # of the other topic, which came late
    assert taken(feed) == [2, 3]


def test_a_key_frame_of_a_picture_that_was_sent_begins_no_video() -> None:
    feed = FrameFeed()
    feed.follow(Codec.H264)
    offer(feed, 1)
    assert taken(feed) == [1]
    offer(feed, 1, Codec.H264)
    assert feed.lacks_key
    offer(feed, 2, Codec.H264, depends_on=1)
    assert taken(feed) == [], "a page does not decode one number twice, and so lacks what this packet needs"
    offer(feed, 3, Codec.H264)
    offer(feed, 4, Codec.H264, depends_on=3)
    assert taken(feed) == [3, 4]


def test_a_still_between_packets_is_shown_and_gives_way_to_what_is_newer() -> None:
    feed = following()
    feed.offer(frame(2), b"", Codec.H264, 0)
    feed.offer(frame(3), b"", Codec.H264, 0)
    assert taken(feed) == [1, 3]
    feed.offer(frame(4), b"", Codec.H264, 0)
    offer(feed, 5, Codec.H264, depends_on=1)
    assert taken(feed) == [5], "its decoder has the packet of number 1"


def test_a_packet_that_was_lost_ends_the_chain_until_the_next_key_frame() -> None:
    feed = following()
    assert taken(feed) == [1]
    offer(feed, 3, Codec.H264, depends_on=2)
    assert feed.lacks_key
    assert feed.codecs == {Codec.JPEG, Codec.H264}
    offer(feed, 4, Codec.H264, depends_on=3)
    assert taken(feed) == []
    offer(feed, 5, Codec.H264)
    assert taken(feed) == [5]


def test_who_takes_nothing_has_few_packets_waiting_and_then_pictures_of_their_own() -> None:
    feed = following()
    for sequence in range(2, MOST_WAITING + 1):
        offer(feed, sequence, Codec.H264, depends_on=sequence - 1)
    assert len(feed.codecs) == 1
    offer(feed, MOST_WAITING + 1, Codec.H264, depends_on=MOST_WAITING)
    assert len(feed.codecs) == 2
    offer(feed, MOST_WAITING + 2)
    assert taken(feed) == [MOST_WAITING + 2]


def test_who_held_up_others_has_no_video_for_a_while() -> None:
    feed = following()
    feed.bar(now=10)
    offer(feed, 2, Codec.H264, now=10.1)
    assert len(feed.codecs) == 2
    assert not feed.lacks_key, "no key frame is asked for that would not be used"
    offer(feed, 3, Codec.H264, now=10 + BARRED_SECONDS)
    assert len(feed.codecs) == 1


@dataclass
class Viewer:
    """Decodes as a decoder does: a packet after the one that it needs."""

    feed: FrameFeed
    decoded: int | None = None
    shown: int = 0
    taken: list[int] = field(default_factory=list)

    def take(self, frames: dict[int, Frame]) -> None:
        waiting = self.feed.take()
        came = frames[waiting.sequence] if not waiting.is_video else frames[-waiting.sequence]
        if came.codec in VIDEO:
            assert Flags.KEY in came.flags or came.depends_on == self.decoded
            self.decoded = came.sequence
        assert came.sequence > self.shown
        self.shown = came.sequence


@given(st.lists(st.sampled_from(["packet", "lost packet", "key", "still", "take", "decoder failed"]), max_size=60))
def test_whatever_is_lost_nothing_is_sent_that_cannot_be_decoded_and_the_last_still_arrives(steps: list[str]) -> None:
    feed, frames, number, last = FrameFeed(), {}, 0, 0
    feed.follow(Codec.H264)
    viewer = Viewer(feed)
    for step in [*steps, "still"]:
        number += 1
        match step:
            case "packet" | "lost packet" | "key":
                packet = frame(number, Codec.H264, 0 if step == "key" else last)
                frames[-number], frames[number], last = packet, frame(number), number
                if step != "lost packet":
                    feed.offer(packet, b"", Codec.H264, 0)
                feed.offer(frames[number], b"", Codec.JPEG, 0)
            case "still":
                frames[number] = frame(number)
                for topic in (Codec.H264, Codec.JPEG):
                    feed.offer(frames[number], b"", topic, 0)
            case "take":
                if feed.next is not None:
                    viewer.take(frames)
            case "decoder failed":
                feed.follow(Codec.H264)
                viewer.decoded = None
    while feed.next is not None:
        viewer.take(frames)
    assert viewer.shown == number

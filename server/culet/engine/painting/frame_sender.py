"""Frames on their way out: encoded on threads of their own while the next one is rendered, and sent in order."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from culet.engine.governing.thrift import NO_LIMITS, ByteAllowance
from culet.engine.painting.coded import Coded
from culet.engine.painting.counters import SharedCounters
from culet.engine.painting.failure import as_culet_error
from culet.engine.painting.lesser_tier import LesserTier, shrunk
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.lossy import Lossy
from culet.engine.painting.video_track import VideoTrack
from culet.engine.session.session import Session
from culet.errors import CuletError
from culet_protocol.frame import Codec, Frame
from culet_protocol.watch import CODEC_OF_VIDEO, LESSER, LESSER_VIDEO, WATCH_BYTES, Lesser, Stream, topic_of

T = TypeVar("T")

UNSENT_FRAMES = 2
"""That may wait to be encoded and sent before no other is begun."""
REPEAT_SECONDS = 1.0
"""After which a picture at rest is sent again, since a high-water mark drops the newest message, maybe the last; and
after twice as long each time,"""
MOST_REPEAT_SECONDS = 8.0
"""but no longer: those who receive frames straight from the engine take 10 s of silence for its end."""


@dataclass(eq=False)
class Outgoing:
    """Of one session."""

    codecs: frozenset[Stream] = frozenset({Codec.JPEG})
    """Of what somebody subscribes to: frames that are pictures of their own (JPEG), video, and lesser pictures."""
    lesser: LesserTier = field(default_factory=LesserTier)
    """How lesser pictures are made, if somebody subscribes to them."""
    tracks: dict[Codec, VideoTrack] = field(default_factory=dict)
    """Of video that somebody subscribes to."""
    message: bytes | None = None
    """The frame sent last, by the session's watch id; None if it was only sent as video."""
    lossy: Lossy | None = None
    """The frame sent last, if a better one of it could be made."""
    sent_at: float = 0.0
    """s, steady clock: when that was, or when it was sent again."""
    silent_seconds: float = REPEAT_SECONDS
    """After which it is sent again."""
    encoded_at: float = 0.0
    """s, steady clock: when a frame was last encoded as video."""
    unsent: int = 0
    """Frames that are being encoded, or wait for that."""
    allowance: ByteAllowance = NO_LIMITS
    """Bytes that frames may have."""
    latest: asyncio.Task[None] | None = None
    """Encodes and sends the frame that was drawn last."""
    final: _Departure | None = None
    """A final picture at rest that is on its way, if nothing was drawn since: it takes long to encode."""

    def watch(self, codec: Stream, *, subscribed: bool) -> None:
        """Somebody began, or the last one ceased, to receive frames in that codec. Whoever subscribes once more to
        video lacks a key frame."""
        lesser, video = isinstance(codec, Lesser), CODEC_OF_VIDEO.get(codec)
        tracks = self.lesser.tracks if lesser else self.tracks
        if not subscribed:
            self.codecs -= {codec}
            if lesser and not self.lesser_streams:
                self.lesser.forget()
            if video is not None:
                tracks.pop(video, None)
            return
        self.codecs |= {codec}
        if video is not None:
            tracks.setdefault(video, VideoTrack(video)).want_key()

    @property
    def first_streams(self) -> frozenset[Stream]:
        """Of the first tier, what somebody subscribes to."""
        return self.codecs - set(Lesser)

    @property
    def lesser_streams(self) -> frozenset[Stream]:
        """The same of the lesser one."""
        return self.codecs & set(Lesser)

    @property
    def all_tracks(self) -> tuple[VideoTrack, ...]:
        """Of both tiers."""
        return *self.tracks.values(), *self.lesser.tracks.values()

    def hold(self, stream: Stream, now: float, *, held: bool) -> None:
        """Encode no more of that video for a while, or go on."""
        tracks, codec = self.lesser.tracks if isinstance(stream, Lesser) else self.tracks, CODEC_OF_VIDEO[stream]
        if codec in tracks:
            tracks[codec].hold(now, held=held)

    @property
    def kept_bytes(self) -> int:
        """Of the frame sent last."""
        return len(self.message or b"") + len(self.lesser.message or b"")

    @property
    def nbytes(self) -> int:
        """That its encoders take."""
        return sum(track.nbytes for track in self.all_tracks)

    def give_back(self) -> int:
        """Close its encoders, unless a frame is on its way: video goes on with a key frame. The bytes that are free by
        that."""
        if self.unsent > 0:
            return 0
        held = self.nbytes
        for track in self.all_tracks:
            track.close()
        return held

    @property
    def is_video(self) -> bool:
        """Whether what moves goes out as video alone."""
        return Codec.JPEG not in self.codecs and any(track.works and track.has_room for track in self.tracks.values())

    @property
    def first_improving(self) -> Lossy | None:
        """The final picture at rest as it was sent on the first tier, if who subscribes could be sent a better one."""
        lossy = self.lossy if self.first_streams else None
        return lossy if lossy is not None and lossy.improves(self.allowance) else None

    @property
    def lesser_improving(self) -> Lossy | None:
        """The same of the lesser tier."""
        lossy = self.lesser.lossy if self.lesser_streams else None
        return lossy if lossy is not None and lossy.improves(self.lesser.allowance) else None

    @property
    def is_thrifty(self) -> bool:
        """Whether the final picture at rest has more loss than those before it, since links carry no more."""
        return any(lossy is not None and lossy.thrifty for lossy in (self.lossy, self.lesser.lossy))

    def forget_frame(self) -> None:
        """Keep none to be encoded again."""
        self.lossy = self.lesser.lossy = None

    def sent(self, now: float) -> None:
        """Something new left, or the same for who has just come."""
        self.sent_at, self.silent_seconds = now, REPEAT_SECONDS

    @property
    def full(self) -> bool:
        """Whether so many frames wait that no other should be begun."""
        return self.unsent >= UNSENT_FRAMES


@dataclass(frozen=True, eq=False)
class _Departure:
    """A frame that is to leave."""

    session: Session
    outgoing: Outgoing
    learn: Callable[[Coded], None]
    """Is told what a frame for a link with limits has become."""
    frame: LiveFrame
    begun_at: float
    """s, steady clock."""
    before: asyncio.Task[None] | None
    """That of the session's frame before it."""
    again: bool = False
    """It was sent before, and is to be sent again where links have got better."""


class FrameSender:
    """Of all sessions."""

    def __init__(
        self,
        send: Callable[[bytes], None],
        tell_problem: Callable[[Session, CuletError], None],
        wake: Callable[[], None],
        tally: SharedCounters,
        clock: Callable[[], float],
        has_room: Callable[[int], bool] = lambda _: True,
    ) -> None:
        """`send` puts a message on the wire and does not wait, `wake` is called when a frame has left, `has_room` tells
        whether an encoder may take so many bytes."""
        self._send = send
        self._tell_problem = tell_problem
        self._wake = wake
        self._tally = tally
        self._now = clock
        self._has_room = has_room
        self._threads = ThreadPoolExecutor(max(1, (os.cpu_count() or 1) // 2), "encode")
        self._final_thread = ThreadPoolExecutor(1, "encode-final")
        """Of final pictures, which take long: nobody else's wait for them."""

    def publish(
        self, session: Session, outgoing: Outgoing, learn: Callable[[Coded], None], frame: LiveFrame, begun_at: float
    ) -> None:
        """Encode and send a frame that was begun at that time of the clock; this does not wait for either. `learn` is
        told what a frame for a link with limits has become."""
        outgoing.forget_frame()
        self._depart(_Departure(session, outgoing, learn, frame, begun_at, _leave_behind(outgoing)))

    def improve(self, session: Session, outgoing: Outgoing) -> None:
        """Encode the final picture at rest again where the links of who is sent it have got better, and send it under a
        number of its own."""
        lossy = outgoing.first_improving or outgoing.lesser_improving
        if lossy is None or outgoing.unsent > 0:
            return
        frame, before = lossy.frame, outgoing.latest
        self._depart(_Departure(session, outgoing, lambda _: None, frame, self._now(), before, again=True))

    def _depart(self, departure: _Departure) -> None:
        outgoing = departure.outgoing
        outgoing.unsent += 1
        outgoing.latest = asyncio.create_task(self._encode_and_send(departure))
        outgoing.latest.add_done_callback(partial(self._departed, departure))  # also of one given up before it began
        outgoing.final = departure if departure.frame.final else None

    def repeat(self, outgoing: Outgoing) -> None:
        """Send the frame sent last again, if there was one, for who has just come."""
        self._repeat(outgoing)
        outgoing.sent(self._now())

    def repeat_by_itself(self, outgoing: Outgoing) -> None:
        """The same for who may have missed it: the next time will be later."""
        self._repeat(outgoing)
        outgoing.sent_at = self._now()
        outgoing.silent_seconds = min(2 * outgoing.silent_seconds, MOST_REPEAT_SECONDS)

    def _repeat(self, outgoing: Outgoing) -> None:
        lesser = outgoing.lesser.message or outgoing.message
        if lesser is None:
            return
        self._tally.counters.frames_repeated += 1
        if outgoing.message is not None:
            self._send_to(outgoing.first_streams, outgoing.message)
        # Who follows video is sent no first picture in the place of a lesser one: what moves goes on at once.
        self._send_to(
            outgoing.lesser_streams if outgoing.lesser.message else outgoing.lesser_streams & {LESSER}, lesser
        )

    def send_anew(self, session: Session, outgoing: Outgoing) -> None:
        """Send the frame sent last again, under a number of its own if it was sent as a lesser picture too: whoever has
        that one takes no other of the same number."""
        if outgoing.unsent == 0 and outgoing.lesser.sequence == session.sequence:
            session.sequence += 1
            outgoing.lesser.sequence = session.sequence
            outgoing.message = _numbered(outgoing.message, session.sequence)
            outgoing.lesser.message = _numbered(outgoing.lesser.message, session.sequence)
        self.repeat(outgoing)

    def stop(self) -> None:
        """Encode nothing more."""
        for threads in (self._threads, self._final_thread):
            threads.shutdown(wait=False, cancel_futures=True)

    async def _encode_and_send(self, departure: _Departure) -> None:
        if departure.again:
            await self._send_better(departure)
        else:
            await self._send_tiers(departure)

    def _departed(self, departure: _Departure, task: asyncio.Task[None]) -> None:
        outgoing = departure.outgoing
        outgoing.unsent -= 1
        if outgoing.final is departure:
            outgoing.final = None
        self._wake()
        if not task.cancelled():
            self.improve(departure.session, outgoing)  # the links may have got better meanwhile

    async def _send_tiers(self, departure: _Departure) -> None:
        outgoing = departure.outgoing
        lesser = bool(outgoing.lesser_streams)
        began = await self._send_first(departure)
        if began is None:
            outgoing.forget_frame()
        if began is None or not lesser:
            outgoing.lesser.forget()
        else:
            await self._send_lesser(departure, began)

    async def _send_better(self, departure: _Departure) -> None:
        """What was sent before, where it becomes another picture by what the links have room for then."""
        session, outgoing, frame = departure.session, departure.outgoing, departure.frame
        lesser, started = outgoing.lesser, time.perf_counter()
        try:
            if (lossy := outgoing.first_improving) is not None:
                allowance = outgoing.allowance
                picture = await self._in_thread(frame.encoded, allowance, final=True)
                if outgoing.lossy is not lossy:  # nobody watches any more
                    return
                outgoing.lossy = _lossy(frame, picture, allowance)
                if picture.looks != lossy.looks:
                    outgoing.message = self._pack_anew(session, frame, picture, started)
                    outgoing.sent(self._now())
                    self._send_to(outgoing.first_streams, outgoing.message)
            if (lossy := outgoing.lesser_improving) is not None:
                allowance = lesser.allowance
                picture = await self._in_thread(lesser.encoded, frame, final=True)
                if lesser.lossy is not lossy:
                    return
                lesser.lossy = _lossy(frame, picture, allowance)
                if picture.looks != lossy.looks:
                    lesser.message = self._pack_anew(session, frame, picture, started)
                    lesser.sequence = session.sequence
                    outgoing.sent(self._now())
                    self._send_to(outgoing.lesser_streams, lesser.message)
        except Exception as error:  # the picture that was sent before stays
            outgoing.forget_frame()
            self._tell_problem(session, as_culet_error(error, what="encoding"))

    def _pack_anew(self, session: Session, frame: LiveFrame, picture: Coded, started: float) -> bytes:
        session.sequence += 1
        self._tally.counters.frames_sent += 1
        return frame.pack(session, picture, time.perf_counter() - started)

    async def _send_first(self, departure: _Departure) -> float | None:
        """The first tier, which waits for no lesser picture of the same frame. s, of the performance counter: when it
        was begun; None if the frame goes no further."""
        session, outgoing, frame, before = departure.session, departure.outgoing, departure.frame, departure.before
        drawn_at, started = self._now(), time.perf_counter()
        codecs, lesser = outgoing.first_streams, bool(outgoing.lesser_streams)
        tracks = list(outgoing.tracks.values()) if frame.planned else []
        video: dict[VideoTrack, Coded] = {}
        try:
            if tracks and before is not None:
                await asyncio.wait([before])  # each frame of video is encoded after the one before it
            for track in tracks:
                works = track.works and track.find_room(frame.size, frame.crf, drawn_at, self._has_room)
                codecs -= {track.codec} if works else set()
                if not works or track.is_held(drawn_at):  # skipped before it is encoded, not after
                    track.forgo()
                    continue
                packet = await self._in_thread(track.encode, frame.rgb, frame.crf, drawn_at)
                if packet is None:
                    codecs |= {track.codec}  # as JPEG
                else:
                    video[track] = frame.coded(track.codec, packet, track.sequence)
            allowance = outgoing.allowance
            picture = await self._in_thread(frame.encoded, allowance, final=frame.final) if codecs else None
            encode_seconds = time.perf_counter() - started
            if frame.encoding is not None:
                for coded in [*video.values(), *([] if picture is None else [picture])]:
                    departure.learn(coded)
            if before is not None:
                await asyncio.wait([before])  # so that frames leave in order
            if picture is None and not video and not lesser:
                outgoing.message = None  # of something else than what is shown
                return None
            session.sequence += 1
            message = None if picture is None else frame.pack(session, picture, encode_seconds)
            packed = {track: frame.pack(session, coded, encode_seconds) for track, coded in video.items()}
        except Exception as error:  # one session's failure must not end the others'
            for track in video:
                track.close()  # what comes next must not need what was not sent
            self._tell_problem(session, as_culet_error(error, what="encoding"))
            return None
        now = self._now()
        self._tally.durations.encode_wait.add(max(0.0, now - drawn_at))
        self._tally.durations.frame.add(max(0.0, now - departure.begun_at))
        outgoing.message = message
        outgoing.sent(now)
        outgoing.lossy = None if picture is None else _lossy(frame, picture, allowance)
        if video:
            outgoing.encoded_at = now
        self._tally.counters.frames_sent += 1
        for track, sent in packed.items():
            track.sequence = session.sequence
            self._send_to({track.codec}, sent)
        if message is not None:  # after the packets: who is sent a frame as a picture cannot begin video with it
            self._send_to(codecs, message)
        return started

    async def _send_lesser(self, departure: _Departure, started: float) -> None:
        """The lesser picture of the frame that was sent last, under the same number. What fails here costs nobody else
        theirs."""
        session, outgoing, frame, now = departure.session, departure.outgoing, departure.frame, self._now()
        lesser, streams = outgoing.lesser, outgoing.lesser_streams
        tracks = list(lesser.tracks.values()) if frame.planned else []
        video: dict[VideoTrack, Coded] = {}
        rgb: NDArray[np.uint8] | None = None
        try:
            size, crf = lesser.video_of(frame) if tracks else (frame.size, frame.crf)
            for track in tracks:
                works = track.works and track.find_room(size, crf, now, self._has_room)
                streams -= {LESSER_VIDEO[track.codec]} if works else set()
                if not works or track.is_held(now):  # skipped before it is encoded, not after
                    track.forgo()
                    continue
                if rgb is None:
                    rgb = await self._in_thread(shrunk, frame.rgb, *size)
                packet = await self._in_thread(lesser.packet, frame, rgb, track, crf, now)
                if packet is None:
                    streams |= {LESSER_VIDEO[track.codec]}  # as JPEG
                else:
                    video[track] = packet
            allowance = lesser.allowance
            picture = await self._in_thread(lesser.encoded, frame, final=frame.final) if streams else None
            seconds = time.perf_counter() - started
            message = None if picture is None else frame.pack(session, picture, seconds)
            packed = {track: frame.pack(session, coded, seconds) for track, coded in video.items()}
        except Exception as error:
            lesser.forget()
            for track in video:
                track.close()  # what comes next must not need what was not sent
            self._tell_problem(session, as_culet_error(error, what="encoding"))
            return
        lesser.forget()
        lesser.sequence = session.sequence
        if video:
            outgoing.encoded_at = self._now()
        for track, sent in packed.items():
            track.sequence = session.sequence
            self._send_to({LESSER_VIDEO[track.codec]}, sent)
        if message is not None and picture is not None and outgoing.lesser_streams:
            lesser.lossy = _lossy(frame, picture, allowance)
            lesser.message = message
            self._send_to(streams & outgoing.lesser_streams, message)

    def _send_to(self, codecs: Collection[Stream], message: bytes) -> None:
        """A message by the session's watch id to who subscribes to frames in those codecs."""
        for codec in codecs:
            watch, rest = message[:WATCH_BYTES], message[WATCH_BYTES:]
            self._send(topic_of(watch, codec) + rest)

    async def _in_thread(self, call: Callable[..., T], *arguments: object, final: bool = False) -> T:
        threads = self._final_thread if final else self._threads
        return await asyncio.get_running_loop().run_in_executor(threads, call, *arguments)


def _leave_behind(outgoing: Outgoing) -> asyncio.Task[None] | None:
    """The task of the frame before the one that is drawn now. A final picture that is still being encoded, or waits for
    those of others, is given up: an input's answer does not wait for it."""
    latest, final = outgoing.latest, outgoing.final
    if latest is None or final is None:
        return latest
    latest.cancel()
    return final.before


def _lossy(frame: LiveFrame, picture: Coded, allowance: ByteAllowance) -> Lossy | None:
    """Of a frame that was sent as that picture; None if no better one can come of it, or if others follow it soon."""
    if not frame.final or frame.planned or frame.shown.moving or picture.codec is Codec.PNG:
        return None
    return Lossy(frame, allowance.resting(final=True), picture.looks, picture.thrifty)


def _numbered(message: bytes | None, sequence: int) -> bytes | None:
    return None if message is None else replace(Frame.unpack(message), sequence=sequence).pack()

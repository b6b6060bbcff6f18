"""A live frame on its way out: developed on the render thread, packed when its payload is encoded."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.engine.governing.governor import Plan
from culet.engine.governing.thrift import BEST_CRF, ByteAllowance, Encoding
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet.engine.painting.renderer import AnyPicture
from culet.engine.painting.resting_picture import encode_resting
from culet.engine.painting.video_track import TrackedPacket
from culet.engine.painting.whereabouts import Ball, whereabouts
from culet.engine.session.session import Session, ShownScene
from culet.rendering.chains import bands_seen
from culet.rendering.film.target import Target
from culet.scene.optics import Optics
from culet_protocol.frame import Codec, Flags, Frame


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """Before its payload is there. Times are in seconds."""

    rgb: NDArray[np.uint8]
    """(height, width, 3)"""
    shown: ShownScene
    optics: Optics
    """As drawn."""
    bands: int
    """Of the last sample."""
    samples: int
    simulate_seconds: float
    render_seconds: float
    """Of all samples."""
    develop_seconds: float
    """Of tone mapping."""
    cut: float
    error: float
    """Of the radiance: estimated, or NaN."""
    shown_error: float
    """Of what is shown, from 0 to 1: estimated, or NaN."""
    rest_error: float
    """That a picture at rest is refined to; NaN of a first sample."""
    expected_error: float
    """That of the front, or NaN if the governor had no part in it."""
    final: bool
    slow: bool
    """The stone moves slower than in real time."""
    light_cut: float
    """Part of the stones' light that floor and walls may miss, or NaN."""
    light_error: float
    """Of the light map: estimated, or NaN."""
    shadows_only: bool
    """Floor and walls show nothing of what goes through stones."""
    encoding: Encoding | None
    """Of a moving one for a link with limits."""
    planned: bool
    """As the governor, or a pinned balance, has what moves: others like it follow soon."""

    @classmethod
    def developed(
        cls,
        picture: AnyPicture,
        shown: ShownScene,
        plan: Plan | None,
        spent: tuple[float, float],
        develop_seconds: float,
        *,
        aim: Target | None,
        final: bool,
        slow: bool,
        soft: bool,
        overlaid: NDArray[np.uint8] | None = None,
    ) -> LiveFrame:
        """Of a picture that is done and developed, and took that long to simulate and to render; or that is amid a
        sample and `overlaid`.

        Estimating its error costs nothing for the single sample of a moving one.
        """
        started = time.perf_counter()
        rgb = overlaid
        if rgb is None:
            rgb = picture.softened() if soft else picture.rgb()
        cut, error = picture.cut(), picture.error_estimate()
        return cls(
            rgb=rgb,
            shown=shown,
            optics=picture.scene.optics,
            bands=bands_seen(picture.scene, picture.samples_seen),
            samples=picture.samples_seen,
            simulate_seconds=spent[0],
            render_seconds=spent[1],
            develop_seconds=develop_seconds + time.perf_counter() - started,
            cut=cut,
            error=error,
            shown_error=picture.shown_error(),
            rest_error=math.nan if aim is None or aim.error is None else aim.error,
            expected_error=math.nan if plan is None else plan.error,
            final=final,
            slow=slow,
            light_cut=picture.light_bound(),
            light_error=picture.light_error(),
            shadows_only=picture.shows_shadows_only(),
            encoding=None if plan is None else plan.encoding,
            planned=plan is not None,
        )

    def encoded(self, allowance: ByteAllowance) -> Coded:
        """Its picture as it is sent; one that does not move has no more bytes than the link allows. Takes milliseconds,
        a final one some hundredths of a second."""
        if self.encoding is not None:
            picture = jpeg.encode_within(self.rgb, self.encoding.quality, self.encoding.most_bytes)
            return Coded.of_jpeg(picture, thrifty=self.encoding.thrifty or picture.quality < self.encoding.quality)
        if self.shown.moving:
            return Coded.of_jpeg(jpeg.encode_within(self.rgb, jpeg.MOVING_QUALITY, math.inf), thrifty=False)
        return encode_resting(self.rgb, allowance, final=self.final)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.rgb.shape[1], self.rgb.shape[0]

    @property
    def crf(self) -> int:
        """Constant rate factor of it as video."""
        return BEST_CRF if self.encoding is None else self.encoding.crf

    def coded(self, codec: Codec, packet: TrackedPacket, before: int) -> Coded:
        """Its picture as video; the packet needs the frame of that number before it, unless it is a key frame."""
        thrifty = packet.crf > BEST_CRF or (self.encoding is not None and self.encoding.reduced)
        depends_on = 0 if packet.is_key else before
        return Coded(codec, packet.data, packet.width, packet.height, packet.crf, thrifty, depends_on)

    def pack(self, session: Session, encoded: Coded, encode_seconds: float) -> bytes:
        """The message to send, by the session's watch id."""
        frontier = math.isnan(self.error) and not math.isnan(self.expected_error)
        return Frame(
            watch=session.key,
            codec=encoded.codec,
            flags=self._flags(frontier, encoded) | self._unseen(),
            sequence=session.sequence,
            width=encoded.width,
            height=encoded.height,
            samples=self.samples,
            bands=self.bands,
            max_bounces=self.optics.max_bounces,
            cutoff=self.optics.cutoff,
            step=self.shown.step,
            simulation_time=self.shown.simulation_time,
            timestamp=time.time(),
            simulate_ms=self.simulate_seconds * 1e3,
            render_ms=self.render_seconds * 1e3,
            encode_ms=(self.develop_seconds + encode_seconds) * 1e3,
            cut=self.cut,
            error=self._with_light(self.expected_error) if frontier else self.error,
            light_cut=self.light_cut,
            light_error=self.light_error,
            shown_error=self.shown_error,
            rest_error=self.rest_error,
            payload=encoded.data,
            depends_on=encoded.depends_on,
        ).pack()

    def _with_light(self, error: float) -> float:
        """An expected error that knows nothing of the light map, and the map's."""
        return error if math.isnan(self.light_error) else math.hypot(error, self.light_error)

    def _unseen(self) -> Flags:
        """Where the nearest stone is, if no stone is in the picture."""
        height, width, _ = self.rgb.shape
        scene = self.shown.scene
        return whereabouts(scene.camera, [Ball(stone.position, stone.scale) for stone in scene.stones], width / height)

    def _flags(self, frontier: bool, encoded: Coded) -> Flags:
        flags = {
            Flags.MOVING: self.shown.moving,
            Flags.FINAL: self.final,
            Flags.POLARISED: self.optics.polarised,
            Flags.FRONTIER: frontier,
            Flags.SLOW: self.slow,
            Flags.KEY: encoded.depends_on == 0,
            Flags.SHADOWS_ONLY: self.shadows_only,
            Flags.THRIFTY: encoded.thrifty,
        }
        return Flags(sum(flag for flag, is_set in flags.items() if is_set))

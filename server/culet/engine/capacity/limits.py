"""How much one engine takes on. What is beyond is refused with an error that says so."""

from __future__ import annotations

import math

from pydantic import ByteSize, Field

from culet.errors import InputError
from culet.rendering.film.target import Target
from culet.scene.film import MOST_SAMPLES
from culet.settings import Settings

REST_LEAST = 16
"""Samples per pixel of a picture at rest, whatever its error: what is small in a picture has little part in that."""


class Limits(Settings):
    """Configured limits of an engine."""

    trust_network: bool = Field(
        default=False,
        description="Let the engine publish frames, and take control, at tcp:// addresses that other machines reach. "
        "Whoever reaches the frames sees every session that is watched; whoever reaches control changes all sessions.",
    )
    engine_idle_seconds: float = Field(
        3600,
        gt=0,
        description="A session that nobody watched or touched for so long makes room when the engine is full.",
    )
    orphan_seconds: float = Field(
        600, gt=0, description="Sessions are kept for so long while no gateway is there to serve them."
    )
    max_stills: int = Field(8, ge=1, description="Stills that wait or are being rendered.")
    max_still_edge: int = Field(8192, ge=1, le=8192, description="Pixels of a still's longer side.")
    max_still_pixels: int = Field(
        2**25, ge=1, description="Pixels of a still in all; 33.5 million take 0.4 GB of linear colours."
    )
    max_still_work: float = Field(
        2**36,
        gt=0,
        description="Pixels of a still times its samples times its bands; 7e10 take half an hour of two cores.",
    )
    still_seconds: float = Field(
        1800, gt=0, description="Time of the render thread for one still, after which it is given up."
    )
    grade_seconds: float = Field(
        60,
        gt=0,
        description="Time of the grading thread for the grades of one stone; what is known by then is the answer.",
    )
    rest_error: float = Field(
        0.004,
        gt=0,
        le=1,
        description="A live picture at rest gets better until what is shown, from 0 to 1, is estimated to be off by "
        "this (root mean square over pixels and colours): by default until no difference is seen.",
    )
    rest_samples: int = Field(
        256,
        ge=1,
        le=MOST_SAMPLES,
        description="Samples of a pixel that a live picture at rest takes at most, whatever its error.",
    )
    special_programs: bool = Field(
        default=True,
        description="Compile a program of its own for each kind of scene, in the background, which takes some 3 s of a "
        "processor once and renders faster from then on; without, the general programs render all: "
        "of boxes and prisms then some three pixels in a million are dark, by up to 0.010.",
    )
    max_live_pixels: int = Field(
        2560 * 1440,
        ge=1,
        description="Pixels of a live frame; one asked for larger is rendered so large, with the same aspect ratio.",
    )
    max_uploads: int = Field(
        128,
        ge=1,
        description="Uploads of each kind, mesh or sky, that are kept besides those that sessions show; a scene whose "
        "64 stones are all uploads needs that many at least before it is opened.",
    )
    memory: ByteSize | None = Field(
        None,
        ge=256 * 2**20,
        description="Memory of sessions, uploads and pictures; by default half of the machine's or container's.",
    )
    max_sky_pixels: int = Field(2**25, ge=2, description="Pixels of an uploaded sky; each takes 12 bytes.")
    read_seconds: float = Field(60, gt=0, description="Time for reading one upload.")
    read_processor_seconds: float = Field(30, gt=0, description="Time of a processor for reading one upload.")
    max_read_bytes: ByteSize = Field(
        ByteSize(2**30), ge=2**26, description="Memory that reading one upload may take; what is kept of it among it."
    )
    max_mesh_triangles: int = Field(200_000, ge=1, description="Triangles of an uploaded mesh.")
    max_shown_states: int = Field(
        600,
        ge=1,
        description="Shown states of a session that can be rendered again; 600 are 10 s of motion at 60 frames/s.",
    )

    @property
    def rest(self) -> Target:
        """Of live pictures at rest."""
        return Target(self.rest_samples, self.rest_error, least=min(REST_LEAST, self.rest_samples))


def check_still_size(width: int, height: int, limits: Limits, *, pictures: int = 1) -> None:
    """InputError if it is beyond the limits. A still without its backdrop is made of two `pictures`, held at once."""
    for field, pixels in (("width", width), ("height", height)):
        if not 1 <= pixels <= limits.max_still_edge:
            raise InputError(f"{field}: expected 1 to {limits.max_still_edge} pixels, got {pixels}", field)
    if width * height * pictures > limits.max_still_pixels:
        twice = " of a picture without its backdrop" if pictures > 1 else ""
        raise InputError(
            f"width: expected at most {limits.max_still_pixels // pictures} pixels in all{twice}, "
            f"got {width} x {height} = {width * height}",
            "width",
        )


def check_still_work(width: int, height: int, samples: int, bands: int, limits: Limits) -> None:
    """InputError if rendering it is more work than one still may make."""
    work = width * height * samples * bands
    if work > limits.max_still_work:
        raise InputError(
            f"samples: expected at most {limits.max_still_work:g} pixels x samples x bands, "
            f"got {width} x {height} x {samples} x {bands} = {work:.3g}; ask for less of each",
            "samples",
        )


def most_samples(width: int, height: int, bands: int, limits: Limits) -> int:
    """That one still may have."""
    return min(MOST_SAMPLES, int(limits.max_still_work / (width * height * bands)))


def live_size(width: int, height: int, limits: Limits) -> tuple[int, int]:
    """The size, scaled down to the limit if it is beyond; at least 1 x 1."""
    scale = min(1.0, math.sqrt(limits.max_live_pixels / (width * height)))
    return max(1, int(width * scale)), max(1, int(height * scale))

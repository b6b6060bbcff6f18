"""When a picture is good enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from culet.errors import InputError
from culet.scene.film import MOST_SAMPLES, STILL_ERROR, STILL_LEAST, STILL_SAMPLES
from culet.scene.model import Scene


@dataclass(frozen=True)
class Target:
    """At most so many samples of each pixel; fewer, if the picture has an estimated error before."""

    samples: int
    """At most."""
    error: float | None = None
    """Root mean square error of what is shown, from 0 (black) to 1 (white), over pixels and colours; as
    `Picture.shown_error`. None: all samples are taken."""
    least: int = 2
    """Samples that are taken whatever the error is."""

    def __post_init__(self) -> None:
        """InputError for what no picture can have."""
        if not 1 <= self.samples <= MOST_SAMPLES:
            raise InputError(f"samples: expected 1 to {MOST_SAMPLES}, got {self.samples}", "samples")
        if self.error is not None and not 0 < self.error <= 1:
            raise InputError(f"error: expected a number above 0 and up to 1, got {self.error:g}", "error")

    @classmethod
    def of(cls, samples: int | None, error: float | None, scene: Scene) -> Self:
        """Of what somebody asks for: with an error the samples are a limit; without either the picture is to look
        right, and has at least the samples that the scene says."""
        if samples is None and error is None:
            own = scene.sampling.samples_per_pixel
            return cls(max(STILL_SAMPLES, own), STILL_ERROR, least=max(STILL_LEAST, own))
        return cls(MOST_SAMPLES if samples is None else samples, error)

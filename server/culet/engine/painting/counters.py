"""What the painter has done since the engine started, and how long it took."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from culet.engine.painting.histogram import Histogram


@dataclass
class Counters:
    """Since the engine started."""

    frames_rendered: int = 0
    """Live pictures drawn."""
    frames_given_up: int = 0
    """For something newer, or because they took too long."""
    refinements: int = 0
    frames_sent: int = 0
    frames_repeated: int = 0
    stills_rendered: int = 0
    problems: int = 0
    """Pictures that could not be rendered, stones that could not be moved."""
    render_seconds: float = 0.0
    """Of the render thread."""


@dataclass
class Durations:
    """Since the engine started, s."""

    render_hold: Histogram = field(default_factory=Histogram)
    """That a piece of work held the render thread."""
    frame_wait: Histogram = field(default_factory=Histogram)
    """From when a frame was due until it was begun."""
    frame: Histogram = field(default_factory=Histogram)
    """From when a frame was begun until it was sent."""
    encode_wait: Histogram = field(default_factory=Histogram)
    """From when a frame was drawn until it was encoded."""
    still_wait: Histogram = field(default_factory=Histogram)
    """From when a still was asked for until it was begun."""

    def as_json(self) -> dict[str, Any]:
        """By name, of seconds."""
        return {f"{name}_seconds": histogram.as_json() for name, histogram in vars(self).items()}


@dataclass(frozen=True)
class SharedCounters:
    """Both, as all parts of the painter share them."""

    counters: Counters = field(default_factory=Counters)
    durations: Durations = field(default_factory=Durations)

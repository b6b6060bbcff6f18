"""Receiving frames into a folder: a few, or all of some time."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from culet_client.errors import SilenceError
from culet_client.frame_folder import FrameFolder
from culet_client.subscription import FrameSubscription
from culet_protocol.frame import Frame

Shown = Callable[[Frame, Path], None]
"""Called with every frame and the file that it went to."""


def view(
    endpoint: str, watch: str, frames: int, folder: Path, *, timeout_seconds: float = 10, shown: Shown | None = None
) -> int:
    """Write the next frames, each the latest when it is taken; the number written.

    A picture at rest comes again once a second, and counts each time. SilenceError if none comes in the time allowed.
    """
    target = FrameFolder(folder)
    with FrameSubscription(endpoint, watch) as subscription:
        while target.count < frames:
            frame = subscription.receive(timeout_seconds)
            path = target.write(frame)
            if shown:
                shown(frame, path)
    return target.count


def record(
    endpoint: str,
    watch: str,
    seconds: float,
    folder: Path,
    *,
    timeout_seconds: float = 10,
    shown: Shown | None = None,
) -> int:
    """Write every frame that comes in some seconds, counted from the first, once each; the number written.

    SilenceError if not even one comes in the time allowed.
    """
    target = FrameFolder(folder)
    with FrameSubscription(endpoint, watch, latest_only=False) as subscription:
        frame = subscription.receive(timeout_seconds)
        end = time.monotonic() + seconds
        last: int | None = None
        while True:
            if frame.sequence != last:
                last = frame.sequence
                path = target.write(frame)
                if shown:
                    shown(frame, path)
            try:
                frame = subscription.receive(max(0.0, end - time.monotonic()))
            except SilenceError:
                break
            if time.monotonic() >= end:
                break
    return target.count

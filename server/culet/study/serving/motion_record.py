"""What the headers of a moving session's frames say: whether the rate was held, how good and how steady they were."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import chain, pairwise
from typing import Any

from culet.engine.governing.measured_errors import SettingErrors
from culet_protocol.frame import Flags, Frame

LATE_MS = 50.0
"""Of render time: two such frames in a row are seen as a jerk."""
HELD = 0.95
"""Part of the rate asked for at which a session counts as settled,"""
SETTLED_FRAMES = 15
"""over so many frames."""


@dataclass(frozen=True)
class SeenFrame:
    """A frame's header, and when it came."""

    arrived: float
    """s, steady clock."""
    sequence: int
    """Of the session's frames; one that is sent again keeps its own."""
    moving: bool
    simulation_time: float
    """s."""
    width: int
    height: int
    bands: int
    max_bounces: int
    cutoff: float
    simulate_ms: float
    render_ms: float
    encode_ms: float
    error: float

    @classmethod
    def of(cls, frame: Frame, arrived: float) -> SeenFrame:
        """From the frame itself."""
        return cls(
            arrived, frame.sequence, Flags.MOVING in frame.flags, frame.simulation_time, frame.width, frame.height,
            frame.bands, frame.max_bounces, frame.cutoff, frame.simulate_ms, frame.render_ms, frame.encode_ms,
            frame.error,
        )  # fmt: skip

    @property
    def stages_ms(self) -> float:
        """Of simulation, rendering and encoding."""
        return self.simulate_ms + self.render_ms + self.encode_ms

    @property
    def setting(self) -> tuple[int, int, float, int]:
        """What the governor chose."""
        return self.width, self.height, round(self.cutoff, 6), self.max_bounces


@dataclass(frozen=True)
class SettingShare:
    """Of the time for which a moving stone was seen."""

    width: int
    height: int
    cutoff: float
    max_bounces: int
    share: float
    """0 to 1, of the time until the frame after it came."""
    error: float
    """Root mean square of what is shown, 0 to 1, that the ladder measured of such a setting; NaN beyond it."""


@dataclass(frozen=True)
class SceneChange:
    """Of what is shown, after which the governor has to find its setting anew."""

    name: str
    made_at: float
    """s, steady clock."""


@dataclass(frozen=True)
class Settled:
    """How long it took after a change until frames came at the rate asked for."""

    name: str
    seconds: float | None
    """None if they did not before the next change."""
    setting_changes: int
    """Until the next change."""


@dataclass(frozen=True)
class Summary:
    """Of the frames of a moving stone; the pauses between two falls do not count."""

    frames: int
    moving_seconds: float
    frames_per_second: float
    late_intervals: float
    """Part of the intervals that took over one and a half times as long as asked for."""
    out_of_order: int
    """Frames that came after a later one, of all."""
    pace: float
    """Seconds of simulation that were shown in a second: 1 in real time."""
    lowest_size: tuple[int, int]
    largest_cutoff: float
    fewest_bounces: int
    fewest_bands: int
    render_ms_median: float
    render_ms_99: float
    render_ms_longest: float
    longest_late_run: int
    """Frames in a row of over LATE_MS of render time."""
    setting_changes_per_minute: float
    simulate_ms_median: float
    encode_ms_median: float
    """Of developing and encoding, from a frame's last sample on, with all that it waited for."""
    side_by_side: float
    """Time of all stages of frames over the time between them: 1 if they come one after the other without a pause, more
    if they go on beside each other."""
    error_mean: float | None
    """Mean of the frontier's errors, of radiance; None if none is known."""

    def as_json(self) -> dict[str, Any]:
        """For a report."""
        return asdict(self)


def summarise(seen: Sequence[SeenFrame], rate: float) -> Summary | None:
    """Of frames in order; None if no two of them are of the same fall."""
    moving = [frame for frame in seen if frame.moving]
    pairs = moving_pairs(seen)
    if not pairs:
        return None
    intervals = [after.arrived - before.arrived for before, after in pairs]
    render = sorted(frame.render_ms for frame in moving)
    errors = [frame.error for frame in moving if not math.isnan(frame.error)]
    minutes = sum(intervals) / 60
    return Summary(
        frames=len(moving),
        moving_seconds=sum(intervals),
        frames_per_second=len(intervals) / sum(intervals),
        late_intervals=sum(interval > 1.5 / rate for interval in intervals) / len(intervals),
        out_of_order=sum(after.sequence < before.sequence for before, after in pairwise(seen)),
        pace=sum(after.simulation_time - before.simulation_time for before, after in pairs) / sum(intervals),
        lowest_size=min((frame.width, frame.height) for frame in moving),
        largest_cutoff=max(frame.cutoff for frame in moving),
        fewest_bounces=min(frame.max_bounces for frame in moving),
        fewest_bands=min(frame.bands for frame in moving),
        render_ms_median=statistics.median(render),
        render_ms_99=render[int(0.99 * (len(render) - 1))],
        render_ms_longest=render[-1],
        longest_late_run=longest_run([frame.render_ms > LATE_MS for frame in moving]),
        setting_changes_per_minute=setting_changes(seen) / minutes,
        simulate_ms_median=statistics.median(frame.simulate_ms for frame in moving),
        encode_ms_median=statistics.median(frame.encode_ms for frame in moving),
        side_by_side=sum(after.stages_ms for _, after in pairs) / 1e3 / sum(intervals),
        error_mean=statistics.fmean(errors) if errors else None,
    )


def setting_shares(
    seen: Sequence[SeenFrame], wanted: tuple[int, int], errors: SettingErrors
) -> tuple[list[SettingShare], float]:
    """How long each setting was seen, the longest first, and the mean error of all, by time: NaN if that of one of them
    is not known. `wanted` are the pixels that the viewer asked for."""
    times = dict[tuple[int, int, float, int], float]()
    for before, after in moving_pairs(seen):
        times[before.setting] = times.get(before.setting, 0.0) + after.arrived - before.arrived
    total, shares = sum(times.values()), list[SettingShare]()
    for setting, seconds in sorted(times.items(), key=lambda item: -item[1]):
        width, height, cutoff, bounces = setting
        error = errors.shown(min(1.0, width / wanted[0]), cutoff, bounces)
        shares.append(SettingShare(width, height, cutoff, bounces, seconds / total, error))
    return shares, sum(share.share * share.error for share in shares) if shares else math.nan


def settle(seen: Sequence[SeenFrame], changes: Sequence[SceneChange], rate: float) -> list[Settled]:
    """For each change: how long until SETTLED_FRAMES moving frames in a row came at HELD of the rate."""
    ends = chain((change.made_at for change in changes[1:]), (math.inf,))
    found = []
    for change, end in zip(changes, ends, strict=False):
        until_next = [frame for frame in seen if change.made_at < frame.arrived <= end]
        pairs = moving_pairs(until_next)
        intervals = [after.arrived - before.arrived for before, after in pairs]
        seconds = None
        for first in range(len(intervals) - SETTLED_FRAMES + 1):
            if sum(intervals[first : first + SETTLED_FRAMES]) <= SETTLED_FRAMES / (HELD * rate):
                seconds = pairs[first][0].arrived - change.made_at
                break
        found.append(Settled(change.name, seconds, setting_changes(until_next)))
    return found


def moving_pairs(seen: Sequence[SeenFrame]) -> list[tuple[SeenFrame, SeenFrame]]:
    """Neighbours of the same fall."""
    return [
        (before, after)
        for before, after in pairwise(seen)
        if before.moving and after.moving and after.simulation_time > before.simulation_time
    ]


def setting_changes(seen: Sequence[SeenFrame]) -> int:
    """How often the setting of a moving frame differs from that of the one before."""
    return sum(before.setting != after.setting for before, after in pairwise(f for f in seen if f.moving))


def longest_run(flags: Sequence[bool]) -> int:
    """The most that are true in a row."""
    longest = run = 0
    for flag in flags:
        run = run + 1 if flag else 0
        longest = max(longest, run)
    return longest

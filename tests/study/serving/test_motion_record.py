"""What is read out of a moving session's headers, on records made by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import accumulate, chain, repeat

import pytest

from culet.engine.governing.governor import ERRORS
from culet.study.serving.motion_record import (
    SETTLED_FRAMES,
    SceneChange,
    SeenFrame,
    Summary,
    longest_run,
    moving_pairs,
    setting_shares,
    settle,
    summarise,
)

FRAME = SeenFrame(
    arrived=0, sequence=0, moving=True, simulation_time=0, width=1024, height=576, bands=3, max_bounces=48, cutoff=0.02,
    simulate_ms=1, render_ms=20, encode_ms=2, error=0.05,
)  # fmt: skip
RATE = 25.0
INTERVAL = 1 / RATE


def falling(intervals: list[float]) -> list[SeenFrame]:
    """Frames of one fall that came so far apart."""
    times = accumulate(intervals, initial=0.0)
    return [replace(FRAME, arrived=t, sequence=number, simulation_time=t) for number, t in enumerate(times)]


def summary_of(frames: list[SeenFrame]) -> Summary:
    summary = summarise(frames, RATE)
    assert summary is not None
    return summary


def test_a_steady_fall_has_the_rate_at_which_its_frames_came() -> None:
    summary = summary_of(falling([INTERVAL] * 50))
    assert summary.frames_per_second == pytest.approx(RATE)
    assert summary.moving_seconds == pytest.approx(50 * INTERVAL)
    assert (summary.late_intervals, summary.setting_changes_per_minute) == (0, 0)
    assert (summary.lowest_size, summary.largest_cutoff, summary.fewest_bounces) == ((1024, 576), 0.02, 48)
    assert (summary.fewest_bands, summary.error_mean) == (3, 0.05)


def test_stages_that_go_on_beside_each_other_are_told_from_such_that_wait() -> None:
    waiting, beside = (replace(FRAME, render_ms=17), replace(FRAME, render_ms=57))  # 20 ms, and 60, of 40
    for frame, expected in ((waiting, 0.5), (beside, 1.5)):
        frames = [replace(each, render_ms=frame.render_ms) for each in falling([INTERVAL] * 10)]
        assert summary_of(frames).side_by_side == pytest.approx(expected)


def test_settings_count_by_the_time_for_which_they_were_seen() -> None:
    """And not by their frames: of a setting that is too dear fewer come."""
    frames = falling([0.1, 0.1, 0.2, 0.4, 0.2])
    for number in (2, 3):  # seen for 0.6 s of 1.0
        frames[number] = replace(frames[number], width=1280, height=720, cutoff=0.01, max_bounces=256)
    shares, mean = setting_shares(frames, (1280, 720), ERRORS)
    assert [(share.width, share.height, share.cutoff, share.max_bounces) for share in shares] == [
        (1280, 720, 0.01, 256), (1024, 576, 0.02, 48)
    ]  # fmt: skip
    assert [share.share for share in shares] == pytest.approx([0.6, 0.4])
    best, coarse = ERRORS.shown(1, 0.01, 256), ERRORS.shown(0.8, 0.02, 48)
    assert best < coarse
    assert [share.error for share in shares] == pytest.approx([best, coarse])
    assert mean == pytest.approx(0.6 * best + 0.4 * coarse)
    assert setting_shares(frames[:1], (1280, 720), ERRORS)[0] == []


def test_frames_in_order_and_in_real_time_are_told_from_others() -> None:
    frames = falling([INTERVAL] * 10)
    assert summary_of(frames).out_of_order == 0
    assert summary_of(frames).pace == pytest.approx(1)
    assert summary_of([*frames, frames[-1]]).out_of_order == 0, "the last one was sent again"
    assert summary_of([*frames[:4], frames[5], frames[4], *frames[6:]]).out_of_order == 1
    slow = [replace(frame, simulation_time=0.75 * frame.simulation_time) for frame in frames]
    assert summary_of(slow).pace == pytest.approx(0.75)


def test_the_mean_error_is_of_the_frames_whose_error_is_known() -> None:
    frames = falling([INTERVAL] * 4)
    assert summary_of([replace(frames[0], error=math.nan), *frames[1:]]).error_mean == pytest.approx(0.05)
    assert summary_of([replace(frame, error=math.nan) for frame in frames]).error_mean is None


def test_the_pause_between_two_falls_does_not_count() -> None:
    first = falling([INTERVAL] * 10)
    rest = replace(first[-1], moving=False, arrived=first[-1].arrived + 0.1)
    second = [replace(frame, arrived=frame.arrived + 3) for frame in first]
    assert summary_of([*first, rest, *second]).frames_per_second == pytest.approx(RATE)
    assert len(moving_pairs([*first, *second])) == 20, "nor if no frame at rest was sent between them"


def test_late_frames_are_counted_by_how_many_follow_each_other() -> None:
    times = [60, 20, 55, 51, 70, 20, 90]
    frames = [replace(f, render_ms=ms) for f, ms in zip(falling([INTERVAL] * 6), times, strict=True)]
    summary = summary_of(frames)
    assert (summary.longest_late_run, summary.render_ms_longest, summary.render_ms_median) == (3, 90, 55)
    assert longest_run([]) == 0


def test_settings_that_change_are_counted_by_the_minute() -> None:
    sizes = chain(repeat(640, 25), repeat(1280, 26))
    frames = [replace(frame, width=width) for frame, width in zip(falling([INTERVAL] * 50), sizes, strict=True)]
    assert summary_of(frames).setting_changes_per_minute == pytest.approx(60 / (50 * INTERVAL))


def test_a_session_settles_when_its_frames_come_at_the_rate_again() -> None:
    late = 7
    frames = falling([*[INTERVAL] * 20, *[3 * INTERVAL] * late, *[INTERVAL] * 40])
    (settled,) = settle(frames, [SceneChange("walls", made_at=frames[20].arrived - 0.01)], RATE)
    assert settled.seconds == pytest.approx(0.01 + 3 * late * INTERVAL)


def test_a_session_that_never_settles_before_the_next_change_says_so() -> None:
    frames = falling([2 * INTERVAL] * 40 + [INTERVAL] * 2 * SETTLED_FRAMES)
    changes = [SceneChange("walls", frames[0].arrived), SceneChange("none", frames[40].arrived)]
    first, second = settle(frames, changes, RATE)
    assert first.seconds is None
    assert second.seconds is not None


def test_a_record_in_which_nothing_moves_has_no_summary() -> None:
    assert summarise([replace(FRAME, moving=False)] * 3, RATE) is None

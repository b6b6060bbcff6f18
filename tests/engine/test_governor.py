"""The governor holds the frame rate, and does not flicker."""

from __future__ import annotations

import pytest

from culet.engine.governor import PATIENCE, Governor, Setting, read_ladder

WANTED = 1280, 720
LADDER = (
    Setting(scale=1.0, cutoff=0.01, cost=1.0, error=0.02),
    Setting(scale=0.8, cutoff=0.05, cost=0.4, error=0.03),
    Setting(scale=0.5, cutoff=0.05, cost=0.2, error=0.04),
)


def play(governor: Governor, full_cost: float, frames: int, rate: float = 30) -> list[tuple[float, Setting]]:
    """(seconds, setting) of each frame, of a scene whose best frame takes `full_cost` seconds."""
    played = []
    for _ in range(frames):
        setting, size = governor.setting, governor.size(*WANTED)
        seconds = full_cost * setting.cost / setting.scale**2 * size[0] * size[1] / (WANTED[0] * WANTED[1])
        played.append((seconds, setting))
        governor.rendered(seconds, size, WANTED, rate)
    return played


def test_an_easy_scene_keeps_the_best_setting() -> None:
    assert {setting for _, setting in play(Governor(LADDER), 0.02, 100)} == {LADDER[0]}


def test_a_hard_scene_is_at_its_rate_after_one_frame() -> None:
    played = play(Governor(LADDER), 0.06, 60)
    assert played[0][1] == LADDER[0]
    assert all(seconds <= 0.8 / 30 for seconds, _ in played[1:])
    assert len({setting for _, setting in played[1:]}) == 1, "a steady scene must not flicker"


def test_quality_comes_back_within_a_second_when_the_scene_gets_easy() -> None:
    governor = Governor(LADDER)
    play(governor, 0.3, 10)
    assert governor.setting == LADDER[2]
    play(governor, 0.01, 2 * PATIENCE + 6)
    assert governor.setting == LADDER[0]


def test_one_slow_frame_lowers_quality_for_a_while_only() -> None:
    governor = Governor(LADDER)
    play(governor, 0.02, 10)
    governor.rendered(0.2, governor.size(*WANTED), WANTED, 30)
    assert governor.setting != LADDER[0]
    play(governor, 0.02, 3 * PATIENCE)
    assert governor.setting == LADDER[0]


@pytest.mark.parametrize(
    ("wanted", "least"), [((1280, 720), (640, 360)), ((700, 400), (640, 366)), ((320, 180), (320, 180))]
)
def test_no_frame_is_smaller_than_the_limit_unless_the_viewer_is(
    wanted: tuple[int, int], least: tuple[int, int]
) -> None:
    governor = Governor(LADDER)
    for _ in range(5):
        governor.rendered(10.0, governor.size(*wanted), wanted, 30)
    width, height = governor.size(*wanted)
    assert (width, height) == least


def test_the_measured_ladder_trades_time_for_error() -> None:
    ladder = read_ladder()
    costs = [setting.cost for setting in ladder]
    errors = [setting.error for setting in ladder[1:]]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] == 1
    assert errors == sorted(errors)
    assert all(setting.cutoff <= 0.05 and 0 < setting.scale <= 1 for setting in ladder)

"""The governor holds the frame rate, and does not flicker: on a simulated clock, with a model of what frames cost."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import pytest

from culet.engine.governor import (
    PATIENCE,
    TRIAL,
    Governor,
    Plan,
    Setting,
    asked_rate,
    read_ladder,
)
from culet.scene import Scene
from culet_protocol.messages import BALANCED, EXACTEST_RATE, FASTEST_RATE, Balance

WANTED = 1280, 720
RATE = 30.0
BALANCE = Balance(exactness=BALANCED, pinned=False)
LADDER = (
    Setting(scale=1.0, cutoff=0.01, max_bounces=256, cost=1.0, error=0.02, radiance_error=0.04),
    Setting(scale=0.8, cutoff=0.05, max_bounces=256, cost=0.4, error=0.03, radiance_error=0.05),
    Setting(scale=0.5, cutoff=0.05, max_bounces=16, cost=0.2, error=0.04, radiance_error=0.06),
)
MEASURED = read_ladder()


@dataclass(frozen=True)
class Played:
    """One moving frame."""

    seconds: float
    plan: Plan


def seconds_of(plan: Plan, full_cost: float) -> float:
    """Of a frame, when one in the best setting takes `full_cost`."""
    assert plan.setting is not None
    return full_cost * plan.setting.pixel_cost * plan.size[0] * plan.size[1] / (plan.wanted[0] * plan.wanted[1])


def play(
    governor: Governor, costs: Iterable[float], *, rate: float = RATE, overhead: float = 0.0, balance: Balance = BALANCE
) -> list[Played]:
    """The frames of a scene whose best frames take these seconds to render."""
    played = []
    for full_cost in costs:
        plan = governor.plan(Scene(), WANTED, balance)
        seconds = seconds_of(plan, full_cost)
        played.append(Played(seconds, plan))
        governor.rendered(plan, seconds, overhead, rate)
    return played


def settings(played: Iterable[Played]) -> list[Setting | None]:
    return [frame.plan.setting for frame in played]


def changes(played: Iterable[Played]) -> int:
    """How often the setting changed."""
    return sum(before != after for before, after in pairwise(settings(played)))


def steady(cost: float, frames: int) -> list[float]:
    return [cost] * frames


def test_an_easy_scene_keeps_the_best_setting() -> None:
    assert set(settings(play(Governor(LADDER), steady(0.02, 100)))) == {LADDER[0]}


def test_a_hard_scene_is_at_its_rate_after_one_frame() -> None:
    played = play(Governor(LADDER), steady(0.06, 60))
    assert played[0].plan.setting == LADDER[0]
    assert all(frame.seconds <= 0.8 / RATE for frame in played[1:])
    assert changes(played) == 1, "a steady scene must not flicker"


def test_quality_comes_back_within_a_second_when_the_scene_gets_easy() -> None:
    governor = Governor(MEASURED)
    worst = play(governor, steady(0.3, 10))[-1].plan
    assert (worst.size, worst.setting) == (
        (640, 360),
        next(s for s in MEASURED if s.scale == 0.5 and s.max_bounces == 16),
    )
    play(governor, steady(0.01, int(RATE)))
    assert governor.setting == MEASURED[0]


def test_one_slow_frame_lowers_quality_for_a_while_only() -> None:
    governor = Governor(LADDER)
    play(governor, [*steady(0.018, 10), 0.2])
    assert governor.setting != LADDER[0]
    play(governor, steady(0.018, 3 * PATIENCE))
    assert governor.setting == LADDER[0]


def test_a_frame_that_is_a_little_late_changes_nothing() -> None:
    governor = Governor(LADDER)
    assert changes(play(governor, [*steady(0.02, 10), 0.04, *steady(0.02, 10)])) == 0


def test_time_spent_besides_rendering_leaves_less_for_it() -> None:
    frame = 1 / RATE
    without, with_overhead = Governor(LADDER), Governor(LADDER)
    play(without, steady(0.7 * frame, 60))
    play(with_overhead, steady(0.7 * frame, 60), overhead=0.3 * frame)
    assert without.setting == LADDER[0]
    assert with_overhead.setting == LADDER[1]


def test_a_better_setting_that_did_not_hold_is_tried_less_and_less_often() -> None:
    # Cheap whenever quality is low, dear when it is high: no model foresees that, only experience.
    governor, rises = Governor(LADDER), []
    for number in range(40 * PATIENCE):
        plan = governor.plan(Scene(), WANTED, BALANCE)
        assert plan.setting is not None
        before = governor.setting
        governor.rendered(plan, seconds_of(plan, 0.08 if plan.setting == LADDER[0] else 0.01), 0.0, RATE)
        if governor.setting == LADDER[0] != before:
            rises.append(number)
    between = [later - earlier for earlier, later in pairwise(rises)]
    assert between[0] > PATIENCE
    assert between[-1] > 1.8 * between[0], "measured 26 frames at first, 50 at last"


def noisy(cost: Callable[[int], float], frames: int, seed: int) -> Iterator[float]:
    """Log-normal noise of 10 %, and one frame of fifty that takes twice as long."""
    chance = random.Random(seed)  # noqa: S311 - no secret
    for number in range(frames):
        yield cost(number) * chance.lognormvariate(0, 0.1) * (2 if chance.random() < 0.02 else 1)


@pytest.mark.parametrize("seed", range(20))
def test_a_minute_of_falls_and_new_scenes_has_never_two_late_frames_in_a_row(seed: int) -> None:
    """The default scene takes 60 to 90 ms at 1280x720, more or less as the stone falls; every 4 s another scene."""
    scenes = random.Random(seed).choices((0.03, 0.06, 0.075, 0.09), k=15)  # noqa: S311 - as above

    def cost(frame: int) -> float:
        return scenes[frame // 120] * (1 + 0.3 * abs(1 - frame % 60 / 30))

    played = play(Governor(MEASURED), noisy(cost, 1800, seed), overhead=0.003)
    late = [frame.seconds > 0.05 for frame in played]
    assert not any(before and after for before, after in pairwise(late))
    in_time = sum(frame.seconds + 0.003 <= 1 / RATE for frame in played) / len(played)
    assert in_time > 0.95, "measured 0.974 to 0.985"
    assert all(frame.plan.size[0] >= 640 and frame.plan.size[1] >= 360 for frame in played)
    assert changes(played) <= 60, "measured 25 to 54 a minute, of up to 14 new scenes and 30 falls"


@pytest.mark.parametrize(
    ("wanted", "least"),
    [((1280, 720), (640, 360)), ((700, 400), (635, 363)), ((320, 180), (320, 180)), ((780, 1688), (326, 706))],
)
def test_no_frame_is_smaller_than_the_limit_unless_the_viewer_is(
    wanted: tuple[int, int], least: tuple[int, int]
) -> None:
    governor = Governor((*LADDER, replace(LADDER[-1], scale=0.1, cost=0.01)))
    for _ in range(5):
        governor.rendered(governor.plan(Scene(), wanted, BALANCE), 10.0, 0.0, RATE)
    assert governor.plan(Scene(), wanted, BALANCE).size == least


def test_moving_frames_have_three_indices_and_no_polarisation() -> None:
    scene = Scene.read({"optics": {"bands": 16, "polarised": True, "cutoff": 0.02, "max_bounces": 8}})
    plan = Governor(LADDER).plan(scene, WANTED, BALANCE)
    assert (plan.scene.optics.bands, plan.scene.optics.polarised) == (3, False)
    assert plan.scene.optics.cutoff == 0.02, "the scene's own, which is more than the setting's"
    assert plan.scene.optics.max_bounces == 8, "likewise, which is less"
    assert plan.error == LADDER[0].radiance_error


@pytest.mark.parametrize(
    ("exactness", "most", "rate"),
    [(0.0, 240, FASTEST_RATE), (BALANCED, 240, 30), (1.0, 240, EXACTEST_RATE), (0.0, 24, 24), (1.0, 5, 5)],
)
def test_the_balance_asks_for_a_rate_that_viewers_can_take(exactness: float, most: float, rate: float) -> None:
    assert asked_rate(Balance(exactness=exactness, pinned=False), most) == pytest.approx(rate)


def test_pinned_frames_come_as_fast_as_viewers_take_them() -> None:
    assert asked_rate(Balance(exactness=1, pinned=True), 60) == 60


def test_a_balance_pinned_to_exact_draws_the_scene_as_it_is() -> None:
    scene = Scene.read({"optics": {"bands": 16, "polarised": True}})
    plan = Governor(LADDER).plan(scene, WANTED, Balance(exactness=1, pinned=True))
    assert (plan.scene, plan.size) == (scene, WANTED)


@pytest.mark.parametrize(("exactness", "rung"), [(0.0, 2), (0.34, 1), (0.67, 0)])
def test_a_pinned_balance_keeps_its_rung_whatever_it_costs(exactness: float, rung: int) -> None:
    pinned = Balance(exactness=exactness, pinned=True)
    played = play(Governor(LADDER), noisy(lambda frame: 0.001 if frame % 60 < 30 else 3.0, 120, 0), balance=pinned)
    assert set(settings(played)) == {LADDER[rung]}


def test_the_measured_ladder_trades_time_for_error() -> None:
    costs = [setting.cost for setting in MEASURED]
    errors = [setting.error for setting in MEASURED[1:]]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] == 1
    assert errors == sorted(errors)
    assert all(setting.cutoff <= 0.05 and 0 < setting.scale <= 1 for setting in MEASURED)
    assert all(setting.max_bounces <= 256 for setting in MEASURED)
    assert all(setting.radiance_error > 0 for setting in MEASURED)
    assert TRIAL > PATIENCE

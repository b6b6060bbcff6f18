"""A motion goes on by the clock while somebody looks on, and who looks on never waits for a step."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from culet.engine.session.motion import StonesMotion
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.simulation.clock import MAX_CATCH_UP
from culet.stage import Stage
from shared import patience

HIGH = legacy({"stones": [{"position": [0, 100, 0]}]})
STEP = Scene().simulation.time_step
PATIENCE = patience.PATIENCE


def falling(scene: Scene = HIGH) -> StonesMotion:
    motion = StonesMotion(Stage.of(scene))
    motion.set_falling(True)
    return motion


def height(motion: StonesMotion, now: float) -> float:
    ((position, _),) = motion.seen(now).poses.values()
    return position[1]


@contextmanager
def step_under_way(motion: StonesMotion, now: float) -> Iterator[threading.Event]:
    """A step is being taken in another thread until the event is set, which is so afterwards at the latest."""
    begun, go, step = threading.Event(), threading.Event(), motion.world.step

    def slow() -> None:
        begun.set()
        assert go.wait(PATIENCE)
        step()

    motion.world.step = slow  # type: ignore[method-assign]
    thread = threading.Thread(target=motion.run, args=(now,))
    thread.start()
    try:
        assert begun.wait(PATIENCE)
        motion.world.step = step  # type: ignore[method-assign]
        yield go
    finally:
        go.set()
        thread.join(PATIENCE)


def test_steps_taken_by_the_clock_are_those_taken_at_frames() -> None:
    by_frames, by_clock = falling(), falling()
    by_frames.advance(0)
    by_frames.advance(0.2)
    by_clock.look_on(0, 1)
    due, taken = by_clock.run(0), 0
    while due is not None and due < 0.2:
        due, taken = by_clock.run(due), taken + 1
    by_clock.run(0.2)
    assert taken == 23  # 24 steps of 1/120 s, of which rounding may leave one for the end
    assert by_clock.world.state == by_frames.world.state
    for one, other in zip(by_clock.seen(0.2).poses["stone"], by_frames.seen().poses["stone"], strict=True):
        assert one == pytest.approx(other, abs=1e-12)  # measured 1e-16


def test_between_two_steps_the_pose_follows_the_clock() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    motion.run(10.0 * STEP)
    heights = [height(motion, (10 + part) * STEP) for part in (0.0, 0.25, 0.5, 1.0, 5.0)]
    end, start = heights[-1], heights[0]
    assert [(start - h) / (start - end) for h in heights] == pytest.approx([0, 0.25, 0.5, 1, 1])  # and waits there


def test_who_looks_on_does_not_wait_for_a_step() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    with step_under_way(motion, 2.5 * STEP) as go:
        assert motion.look_on(3 * STEP, 1)
        assert height(motion, 3 * STEP) == 100  # no step is done yet
        assert motion.moving
        assert motion.run(3 * STEP) is not None  # of one motion never two steps at a time
        go.set()
    assert height(motion, 3 * STEP) < 100


def test_nothing_moves_on_unseen_for_longer_than_one_look_lasts() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    assert motion.run(MAX_CATCH_UP) is None
    assert motion.run(60) is None
    assert motion.world.state.time == pytest.approx(MAX_CATCH_UP, abs=STEP)


def test_time_between_two_looks_beyond_that_is_lost_and_the_pace_says_so() -> None:
    motion = falling()
    for second in range(5):
        motion.look_on(second, 1)
        motion.run(second)
    assert motion.world.state.time == pytest.approx(4 * MAX_CATCH_UP, abs=STEP)
    assert motion.pace.slow
    assert motion.pace.dropped == pytest.approx(4 * (1 - MAX_CATCH_UP), abs=STEP)


def test_time_that_nobody_saw_after_the_last_step_is_not_made_up_for() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    motion.run(MAX_CATCH_UP)
    taken = motion.world.state.step
    motion.look_on(10, 1)
    motion.run(10)
    assert motion.world.state.step <= taken + 1
    assert motion.pace.dropped == pytest.approx(10 - MAX_CATCH_UP)


def test_a_pause_is_neither_made_up_for_nor_lost() -> None:
    motion = falling()
    for now in (0.0, 0.1):
        motion.look_on(now, 1)
        motion.run(now)
    before, state = height(motion, 0.1), motion.world.state
    motion.pause()
    assert height(motion, 50) == before
    motion.look_on(50, 1)
    motion.run(50)
    assert motion.world.state == state
    assert motion.pace.dropped == 0


def test_stones_pause_where_they_were_seen_between_two_steps() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    motion.run(10.0 * STEP)
    seen = motion.seen(10.75 * STEP)
    motion.set_falling(False)
    paused = motion.seen()
    assert paused.time == pytest.approx(seen.time, abs=1e-12)
    assert paused.poses["stone"][0] == pytest.approx(seen.poses["stone"][0], abs=1e-12)
    assert motion.seen(60) == paused


def test_what_was_seen_before_a_reset_has_no_part_in_a_pause() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    motion.run(10.0 * STEP)
    motion.seen(10.75 * STEP)
    motion.reset()
    motion.set_falling(True)
    motion.set_falling(False)
    assert motion.fraction == 0


def test_who_looks_away_keeps_the_motion_where_it_is_even_while_a_step_is_taken() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    with step_under_way(motion, 2.5 * STEP):
        motion.look_away()
    assert motion.run(5 * STEP) is None
    stopped = motion.seen(5 * STEP)
    motion.look_on(60, 1)
    motion.run(60)
    assert motion.seen(60) == stopped
    assert motion.pace.dropped == 0


async def test_however_many_wait_for_a_step_they_take_one_thread() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    waited = 0

    async def wait() -> None:
        nonlocal waited
        async with motion.still():
            waited += 1

    with step_under_way(motion, 2 * STEP) as go:
        waiting = [asyncio.create_task(wait()) for _ in range(64)]
        for _ in range(10):
            await asyncio.sleep(0)
        async with asyncio.timeout(PATIENCE):
            assert await asyncio.to_thread(lambda: "there is a thread") == "there is a thread"
            assert waited == 0
            go.set()
            await asyncio.gather(*waiting)
    assert waited == 64


async def test_a_change_waits_for_the_step_that_is_taken_without_keeping_the_loop() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    changed = asyncio.Event()

    async def change() -> None:
        async with motion.still():
            motion.set_falling(False)
            changed.set()

    with step_under_way(motion, 2 * STEP) as go:
        changing = asyncio.create_task(change())
        for _ in range(10):
            await asyncio.sleep(0)
        assert not changed.is_set()
        go.set()
        await asyncio.wait_for(changing, PATIENCE)
    assert not motion.moving
    assert motion.world.state.step > 0


async def test_who_gives_up_waiting_for_a_step_keeps_nobody_else_from_the_motion() -> None:
    motion = falling()
    motion.look_on(0, 1)
    motion.run(0)
    with step_under_way(motion, 2 * STEP) as go:
        waiting = asyncio.create_task(motion.still().__aenter__())
        await asyncio.sleep(0)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        go.set()
    async with asyncio.timeout(PATIENCE), motion.still():
        assert motion.moving


def test_stones_whose_step_fails_stop_and_the_problem_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = falling()

    def failing() -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(motion.world, "step", failing)
    motion.look_on(0, 1)
    motion.run(0)
    assert motion.run(0.1) is None
    assert not motion.moving
    assert isinstance(motion.take_problem(), ZeroDivisionError)
    assert motion.take_problem() is None

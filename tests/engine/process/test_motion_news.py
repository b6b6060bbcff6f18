"""What is told of sessions that change by themselves."""

from __future__ import annotations

import asyncio
from itertools import count

import pytest

from culet.engine.painting.live_picture import LivePicture
from culet.engine.process.motion_news import MotionNews
from culet.engine.session.session import Session
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import SessionChange, SessionMotion
from gateway.running import eventually


def asleep(session: Session) -> bool:
    return session.motion.asleep


async def test_that_all_sleep_is_told_however_late_the_step_after_the_last_fell_asleep() -> None:
    session = Session("0" * 32, Stage.of(Scene()))
    told: list[SessionChange | SessionMotion] = []
    news = asyncio.create_task(MotionNews([LivePicture(session)], told.append).run())

    async def a_change_is_told() -> bool:
        return any(isinstance(each, SessionChange) for each in told)

    motion = session.motion
    motion.set_falling(True)
    times = (number * motion.clock.time_step / 2 for number in count())  # at most a step at a time
    while not motion.world.state.asleep:
        session.advance(next(times))
    assert not asleep(session), "its last two states are not the same yet"
    await eventually(a_change_is_told)
    told.clear()
    while not asleep(session):
        session.advance(next(times))
    await eventually(a_change_is_told)
    assert [each.asleep for each in told if isinstance(each, SessionChange)] == [True]
    news.cancel()


async def test_a_session_that_cannot_be_told_of_keeps_no_other_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    odd, other = (Session(digit * 32, Stage.of(Scene())) for digit in "01")
    told: list[SessionChange | SessionMotion] = []
    news = asyncio.create_task(MotionNews([LivePicture(odd), LivePicture(other)], told.append).run())

    def failing(**_: object) -> None:
        raise ZeroDivisionError

    async def the_fall_is_told() -> bool:
        return any(isinstance(each, SessionChange) and each.falling for each in told)

    for name in ("change_told", "motion_told"):
        monkeypatch.setattr(odd, name, failing)
    for session in (odd, other):
        session.set_falling(True)
    await eventually(the_fall_is_told)
    assert {each.session for each in told} == {other.name}
    news.cancel()

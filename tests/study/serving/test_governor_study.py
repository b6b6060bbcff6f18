"""The governor's study: when it drops the stone, on frames made by hand; and in miniature, with a real engine."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from command_line import invoke
from culet.engine.governing.governor import ERRORS
from culet.gateway.engine.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet.scene import Scene
from culet.study.serving import governor_study as governor
from culet.study.serving.governor_study import GovernorRecord, Play, Recorder
from culet.study.serving.motion_record import SceneChange, SeenFrame
from culet_protocol.engine import Control
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Message, ResetStone, ToggleFall, ToggleMirror

SIZE = 64, 36
FLAT = Scene.read(
    {
        "stones": [{"position": [0, 0, 0], "orientation": [0, 1, 0, 0]}],
        "simulation": {"restitution": 0},
    }
)
"""Lands on its table, and sleeps half a second later."""


def frame(step: int, flags: Flags) -> Frame:
    return Frame(
        watch=bytes(16), codec=Codec.JPEG, flags=flags, sequence=step, width=64, height=36, samples=1, bands=3,
        max_bounces=48, cutoff=0.01, step=step, simulation_time=step / 30, timestamp=0, simulate_ms=1, render_ms=1,
        encode_ms=1, cut=0, error=0.05, payload=b"",
    )  # fmt: skip


class Staged(EngineLink):
    """An engine whose every frame the test sends."""

    def __init__(self, recorder: Recorder) -> None:
        super().__init__(GatewaySettings(control="ipc:///nowhere", frames="ipc:///nowhere"))
        self.recorder = recorder
        self.step = 0
        self.falling = False
        self.drops = 0
        self.answer_seconds = 0.0
        self.while_answering: Callable[[], None] = lambda: None

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes]:
        del payload, patient
        assert isinstance(message, Control)
        self.step += 1
        match message.event:
            case ResetStone():
                self.falling = False
            case ToggleFall():
                self.falling = not self.falling
                self.drops += self.falling
        await asyncio.sleep(self.answer_seconds)
        self.while_answering()
        return {"step": self.step, "falling": self.falling}, b""

    def move(self) -> None:
        """A frame of the falling stone comes."""
        self.step += 1
        self.recorder.frame_came(frame(self.step, Flags.MOVING), b"")

    def rest(self) -> None:
        """A frame of the stone that has come to rest comes."""
        self.step += 1
        self.recorder.frame_came(frame(self.step, Flags.NONE), b"")


class Stage:
    """A play, with a stone that falls."""

    def __init__(self) -> None:
        self.recorder = Recorder()
        self.link = Staged(self.recorder)
        self.play = Play(self.link, self.recorder)

    async def begin(self) -> None:
        await self.play.drop()
        self.link.move()
        assert self.link.drops == 1


BRIEF = 0.01
"""s of falling: time for some turns of the loop."""


async def test_a_stone_that_comes_to_rest_while_the_scene_changes_falls_anew() -> None:
    stage = Stage()
    await stage.begin()
    stage.link.while_answering = stage.link.rest
    await stage.play.control(ToggleMirror())
    stage.link.while_answering = lambda: None
    await stage.play.fall(BRIEF)
    assert stage.link.drops == 2


async def test_a_stone_that_comes_to_rest_between_two_stretches_falls_anew() -> None:
    stage = Stage()
    await stage.begin()
    await stage.play.fall(BRIEF)
    stage.link.rest()
    await stage.play.fall(BRIEF)
    assert stage.link.drops == 2


async def test_a_stone_that_comes_to_rest_after_its_record_was_emptied_falls_anew() -> None:
    stage = Stage()
    await stage.begin()
    stage.recorder.seen.clear()
    stage.link.rest()
    await stage.play.fall(BRIEF)
    assert stage.link.drops == 2


async def test_a_drop_is_not_broken_off_when_the_time_is_over() -> None:
    stage = Stage()
    await stage.begin()
    stage.link.rest()
    stage.link.answer_seconds = 2 * BRIEF
    await stage.play.fall(BRIEF)
    assert (stage.link.drops, stage.link.falling) == (2, True)


async def test_a_frame_from_before_the_drop_does_not_count_as_rest() -> None:
    """Another drop would stop the stone that has just begun to fall, or make it fall twice."""
    stage = Stage()
    await stage.begin()
    before = stage.link.step
    stage.link.rest()
    await stage.play.drop()
    stage.recorder.frame_came(frame(before, Flags.NONE), b"")
    await stage.play.fall(BRIEF)
    assert stage.link.drops == 2


def test_a_run_in_which_nothing_moved_is_told_like_any_other() -> None:
    still = tuple(SeenFrame.of(frame(step, Flags.NONE), arrived=step) for step in range(3))
    measured = GovernorRecord(still, (), (SceneChange("walls", 1.0),), 1.0)
    text = governor.described(measured, SIZE, 30)
    assert text.count("no two frames came of the same fall") == 2
    assert json.loads(governor.document(measured, SIZE, 30))["steady"] is None


def test_a_run_without_changes_tells_of_the_steady_scene_alone() -> None:
    seen = tuple(SeenFrame.of(frame(step, Flags.MOVING), arrived=step / 30) for step in range(3))
    measured = GovernorRecord(seen, (), (), 1.0)
    text = governor.described(measured, SIZE, 30)
    assert "out of order         0 frames" in text
    assert "simulated            1.000 s a second" in text
    assert "100.0%               64x36       0.01     48" in text
    assert f"of 48x27 at 0.03 {governor.goal_error():.4f}" in text
    assert "change" not in text.replace("changes of setting", "")
    report = json.loads(governor.document(measured, SIZE, 30))
    assert report["changes"] == []
    assert report["shown_error_mean"] == ERRORS.shown(1, 0.01, 48) < report["shown_error_goal"]


def test_a_file_that_cannot_be_written_is_refused_before_anything_is_measured(tmp_path: Path) -> None:
    run = invoke("study", "governor", "-o", tmp_path / "missing" / "out.json")
    assert run.returncode == 1
    (line,) = run.stderr.splitlines()
    assert "cannot write" in line


async def test_a_stone_falls_again_and_again_and_every_change_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(governor, "WARM_SECONDS", 0.2)
    monkeypatch.setattr(governor, "CHANGE_SECONDS", 0.5)
    monkeypatch.setattr(governor, "CHANGES", (("checker", ToggleMirror()), ("mirror again", ToggleMirror())))
    measured = await governor.measure(FLAT, 4, SIZE, 0.5)
    times = [seen.simulation_time for seen in measured.steady if seen.moving]
    assert any(after < before for before, after in pairwise(times)), "it never fell anew"
    assert measured.processor_seconds > 0
    assert [change.name for change in measured.changes] == ["checker", "mirror again"]
    text = governor.described(measured, SIZE, governor.rate_of(0.5))
    for words in ("64x36, 30 frames/s", "least size           64x36", "checker ", "mirror again "):
        assert words in text
    report = json.loads(governor.document(measured, SIZE, governor.rate_of(0.5)))
    assert len(report["frames"]) == len(measured.steady)
    assert report["steady"]["lowest_size"] == [64, 36]

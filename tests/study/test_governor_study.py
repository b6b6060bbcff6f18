"""The governor's study, played in miniature to a real engine."""

from __future__ import annotations

import json
from itertools import pairwise

import pytest

from culet.scene import Scene
from culet.study import governor
from culet_protocol.messages import ToggleMirror

SIZE = 64, 36
FLAT = Scene.read(
    {
        "stones": [{"position": [0, 0, 0], "orientation": [0, 1, 0, 0]}],
        "simulation": {"restitution": 0, "spin": [0, 0, 0]},
    }
)
"""Lands on its table, and sleeps half a second later."""


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

"""The study of the engine's memory: what it counts, and in miniature, with a real engine."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from culet.scene.presets import preset
from culet.study.serving import memory_study
from culet.study.serving.memory_study import Held, described, document, measure, proportional_set_size

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/smaps_rollup").exists(), reason="the system does not tell what processes share"
)

TAKEN = 2**26


def test_what_a_process_and_its_children_have_is_counted() -> None:
    taking = f"held = bytearray(b'x') * {TAKEN}; print(flush=True); input()"
    before = proportional_set_size(os.getpid())
    with subprocess.Popen(
        [sys.executable, "-c", taking], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        assert TAKEN < proportional_set_size(os.getpid()) - before < 2 * TAKEN
        child.communicate("\n")


def test_a_table_says_what_the_engine_accounts_for() -> None:
    table = described([Held("falling", (2**20, 5 * 2**20, 3 * 2**20), 7, {"pictures": 2**21, "skies": 12})])
    assert table.splitlines()[1].split() == ["falling", "3", "5", "7", "pictures", "2"]


async def test_falling_refined_and_final_pictures_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("THROW_SECONDS", "WARM_SECONDS", "SETTLE_SECONDS"):
        monkeypatch.setattr(memory_study, name, 0.5)
    monkeypatch.setattr(memory_study, "SAMPLE_SECONDS", 0.1)
    found = json.loads(document(await measure(preset("falling"), 2, (64, 36), 2.0), 2, (64, 36)))
    assert (found["sessions"], found["size"]) == (2, [64, 36])
    assert [held["state"] for held in found["held"]] == ["nothing open", "falling", "refined", "final"]
    nothing, falling, *_ = found["held"]
    assert nothing["frames"] == 0
    assert falling["frames"] > 2
    assert min(nothing["bytes"]) > 2**25

"""Where a frame's time goes: the counts, by hand, and each stage once."""

from __future__ import annotations

import pytest

from command_line import invoke
from culet.rendering.renderer import Renderer
from culet.study.bench.cases import CASES
from culet.study.bench.profile import Profile, StageCost, stages
from culet.study.bench.roofline import Roofline
from culet.study.bench.tables import profile_table

LIMITS = Roofline(single_flops=4e9, double_flops=2e9, bandwidth_per_second=1e9)


def test_a_share_is_the_time_that_the_work_would_take_at_the_limit() -> None:
    assert StageCost("tracing", 1.0, "", instructions=1e9).share(LIMITS) == pytest.approx(0.5)
    assert StageCost("developing", 0.1, "", bytes=5e6).share(LIMITS) == pytest.approx(0.05)
    assert StageCost("preparing", 0.1, "").share(LIMITS) is None


def test_every_stage_of_a_frame_is_timed_and_its_work_counted() -> None:
    found = {stage.name: stage for stage in stages(Renderer(), CASES["checker"], 64, 36, repeats=2)}
    assert list(found) == ["preparing, on the host", "tracing", "developing", "JPEG of quality 85"]
    assert all(stage.seconds > 0 for stage in found.values())
    tracing = found["tracing"]
    assert tracing.instructions is not None
    each = 9 * 31 + 22 + 12  # of the brilliant's nine eights, its four and its one
    assert f"{tracing.instructions / each:.0f} segments inside stones, {each} instructions each" in tracing.work
    assert found["developing"].bytes == 64 * 36 * 31
    table = profile_table(Profile("checker", tuple(found.values()), LIMITS))
    assert table.row_count == len(found) + 1


def test_a_profile_is_not_mixed_with_what_can_be_compared() -> None:
    run = invoke("bench", "--profile", "--light")
    assert run.returncode == 1
    assert "expected --profile by itself" in run.stderr

"""Which program a picture gets while the special one is made, or cannot be: no device, nothing is compiled."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import pytest

from culet.errors import DeviceError
from culet.rendering.features import Features
from culet.rendering.opencl import apart
from culet.rendering.programs import precompile, program
from culet.rendering.programs.build import Variant
from culet.rendering.programs.program import Programs
from shared.patience import PATIENCE

GENERAL = Features()
SPECIAL = Features(floor=0)


class Bench(Programs):
    """Kernels are the features they are for."""

    def __init__(self, *, broken: Features | None = None, apart: bool = False) -> None:
        super().__init__(None, apart=apart)  # type: ignore[arg-type]
        self.broken = broken
        self.made: list[Features] = []
        self.uncached = True

    def _make(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401 - as it is of Programs
        self.made.append(features)
        if features == self.broken:
            raise DeviceError("it does not build")
        return features

    def _is_uncached(self, _features: Features, _variant: Variant) -> bool:
        return self.uncached


def ask(programs: Programs, times: int) -> list[Any]:
    """What frames get, one after the other, each after all compilers have come to an end."""
    got = []
    for _ in range(times):
        got.append(programs.best(SPECIAL, Variant()))
        for thread in threading.enumerate():
            if thread.name == "culet-compile":
                thread.join()
    return got


@pytest.fixture(autouse=True)
def compiled_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "precompile", lambda _features, _variant, **_how: True)


def test_the_general_program_serves_until_the_special_one_is_ready() -> None:
    programs = Bench()
    assert ask(programs, 3) == [GENERAL, SPECIAL, SPECIAL]
    assert programs.made == [GENERAL, SPECIAL]


def test_a_special_program_that_cannot_be_made_is_not_tried_again_with_every_frame(
    caplog: pytest.LogCaptureFixture,
) -> None:
    programs = Bench(broken=SPECIAL)
    assert ask(programs, 3) == [GENERAL] * 3
    assert programs.made == [GENERAL, SPECIAL]
    assert "it does not build" in caplog.text


def test_a_compiler_that_never_ends_is_ended_and_the_general_program_goes_on(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.undo()
    monkeypatch.setattr(apart, "MOST_SECONDS", 0.1)
    monkeypatch.setattr(precompile, "COMMAND", (sys.executable, "-c", "import time; time.sleep(600)"))
    programs = Bench()
    assert ask(programs, 2) == [GENERAL] * 2
    assert programs.made == [GENERAL], "the driver that hung there would hang here too, and frames with it"
    assert "did not end" in caplog.text


def test_where_no_process_can_be_begun_an_engine_compiles_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """As without memory: a picture that is refused for it would stay so."""
    monkeypatch.undo()

    def begin(*_given: object, **_how: object) -> None:
        raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))

    monkeypatch.setattr(subprocess, "run", begin)
    programs = Bench()
    assert ask(programs, 2) == [GENERAL, SPECIAL]
    assert programs.made == [GENERAL, SPECIAL]


def test_what_many_wait_for_is_made_once_and_one_program_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    programs, compilers, most = Bench(), [0], [0]
    programs.exact(GENERAL, Variant())

    def compile_apart(*_given: object, **_how: object) -> bool:
        compilers[0] += 1
        most[0] = max(most[0], compilers[0])
        time.sleep(0.02)  # that others may come to it if they can
        compilers[0] -= 1
        return True

    monkeypatch.setattr(program, "precompile", compile_apart)
    wanted = [SPECIAL, replace(SPECIAL, glare=0)] * 3
    together = threading.Barrier(len(wanted))

    def ask_for(features: Features) -> None:
        together.wait(PATIENCE)
        programs.prepare(features, Variant())

    with ThreadPoolExecutor(len(wanted)) as pool:
        for each in [pool.submit(ask_for, features) for features in wanted]:
            each.result(PATIENCE)
    assert most == [1]
    assert programs.made[0] == GENERAL
    assert sorted(map(repr, programs.made[1:])) == sorted(map(repr, wanted[:2]))


@pytest.mark.parametrize(
    ("is_apart", "uncached", "compiled_apart"),
    [
        (False, True, [SPECIAL]),
        (True, True, [GENERAL, SPECIAL]),
        (True, False, []),
        (False, False, []),
    ],
)
def test_another_process_compiles_what_the_cache_does_not_have(
    monkeypatch: pytest.MonkeyPatch, is_apart: bool, uncached: bool, compiled_apart: list[Features]
) -> None:
    """The first program too where that is asked for: an engine keeps the memory that its compiler took."""
    started: list[Features] = []
    monkeypatch.setattr(program, "precompile", lambda features, _variant, **_how: started.append(features))
    programs = Bench(apart=is_apart)
    programs.uncached = uncached
    for features in (GENERAL, SPECIAL, GENERAL):
        programs.prepare(features, Variant())
    assert started == compiled_apart
    assert programs.made == [GENERAL, SPECIAL], "whether that process did it or not"

"""The long forms, each on a server of its own, all bounded. `make reliability` makes a table of the same trials."""

from __future__ import annotations

import asyncio

import pytest

from hostile.reliability import Trial, trials

pytestmark = pytest.mark.soak


@pytest.mark.parametrize("trial", trials(), ids=lambda trial: trial.name)
def test_it_holds_for_long(trial: Trial) -> None:
    for found in asyncio.run(trial.run()):
        assert found.holds, found.row

"""Processes die while people watch: small forms. `make soak` has the long ones."""

from __future__ import annotations

from hostile import faults
from hostile.serving import PATIENCE, Serving


async def test_an_engine_that_dies_is_back_with_the_same_sessions(serving: Serving) -> None:
    found = await faults.killed(serving, "engine", 1, within=PATIENCE)
    assert found.holds, found.row


async def test_a_gateway_that_dies_is_back_with_the_same_sessions(serving: Serving) -> None:
    found = await faults.killed(serving, "gateway", 1, within=PATIENCE)
    assert found.holds, found.row


async def test_a_short_chaos_ends_with_everybody_watching(serving: Serving) -> None:
    found = await faults.chaos(serving, viewers=6, sessions=2, seconds=6, between=3, seed=1)
    assert found.holds, found.row

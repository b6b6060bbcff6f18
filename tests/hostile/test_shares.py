"""Nothing that one client does stops the others: small forms. `make soak` has the long ones."""

from __future__ import annotations

import pytest

from hostile import shares
from hostile.serving import PATIENCE, Serving

SECONDS = 2.0
"""Of each measurement."""
PARSED_AT_ONCE = 30.0
"""s that the form of 4 MiB stops the loop for which parses it in one go; 6 were measured without other load."""


async def test_viewers_of_one_session_get_the_same(serving: Serving) -> None:
    found = await shares.viewers_of_one_session(serving, 6, SECONDS)
    assert found.holds, found.row


async def test_half_sent_requests_keep_no_visitor_out(serving: Serving) -> None:
    found = await shares.half_sent_requests(serving, 400, within=PATIENCE)
    assert found.holds, found.row


@pytest.mark.timed
async def test_a_form_of_nothing_but_delimiters_keeps_nobody_waiting(serving: Serving) -> None:
    found = await shares.form(serving, "empty parts", 4, within=PARSED_AT_ONCE / 10)
    assert found.holds, found.row


@pytest.mark.timed
async def test_a_flood_of_messages_leaves_another_session_its_rate(serving: Serving) -> None:
    found = await shares.beside(serving, "a flood of resize", shares.resizes, 0.8, SECONDS)
    assert found.holds, found.row


@pytest.mark.timed
async def test_a_session_that_asks_for_everything_leaves_another_its_share(serving: Serving) -> None:
    found = await shares.beside(serving, "the dearest scene", shares.dearest_scene, 0.4, SECONDS)
    assert found.holds, found.row

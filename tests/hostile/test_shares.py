"""Nothing that one client does stops the others: small forms, which ask whether there is a share at all. `make soak`
has the long ones, which ask how large it is."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from hostile import shares
from hostile.finding import Finding
from hostile.serving import PATIENCE, Serving

SECONDS = 2.0
"""Of each measurement."""
ATTEMPTS = 3
"""What else the machine does comes and goes, and takes from one stretch what it leaves another: one of these holds."""
NOT_STOPPED = 0.15
"""Of its rate: what another viewer keeps at least. Measured 0.5 beside the dearest scene (a frame of it takes minutes)
and 0.9 beside a flood; without turns it keeps nothing."""


async def one_holds(attempt: Callable[[], Awaitable[Finding]]) -> None:
    """Of some attempts."""
    found = [await attempt()]
    while not found[-1].holds and len(found) < ATTEMPTS:
        found.append(await attempt())
    assert found[-1].holds, "\n".join(str(one.row) for one in found)


async def test_viewers_of_one_session_get_the_same(serving: Serving) -> None:
    await one_holds(lambda: shares.viewers_of_one_session(serving, 6, SECONDS))


async def test_half_sent_requests_keep_no_visitor_out(serving: Serving) -> None:
    found = await shares.half_sent_requests(serving, 400, within=PATIENCE)
    assert found.holds, found.row


async def test_a_form_of_nothing_but_delimiters_leaves_others_time(serving: Serving) -> None:
    """One that is parsed in one go stops the loop for most of the time that it takes: 6 of 8 s, measured."""
    for _ in range(ATTEMPTS):
        sent = await shares.sent_form(serving, "empty parts", 4)
        assert sent.status == 201 or 400 <= sent.status < 500
        if max(sent.waits) < 0.5 * sent.seconds:
            break
    else:
        raise AssertionError(f"others waited {max(sent.waits):.1f} of {sent.seconds:.1f} s")


async def test_a_flood_of_messages_leaves_another_session_a_share(serving: Serving) -> None:
    await one_holds(lambda: shares.beside(serving, "a flood of resize", shares.resizes, NOT_STOPPED, SECONDS))


async def test_a_session_that_asks_for_everything_leaves_another_a_share(serving: Serving) -> None:
    await one_holds(lambda: shares.beside(serving, "the dearest scene", shares.dearest_scene, NOT_STOPPED, SECONDS))

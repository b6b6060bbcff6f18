"""Bytes that mean harm end nothing: small forms. `make soak` has the long ones."""

from __future__ import annotations

from hostile import inputs
from hostile.serving import Serving

SEED = 1


async def test_control_messages_of_every_shape_are_answered(serving: Serving) -> None:
    found = await inputs.control_messages(serving, 300, SEED)
    assert found.holds, found.row


async def test_malformed_websocket_frames_end_their_connection_alone(serving: Serving) -> None:
    found = await inputs.websocket_frames(serving, 12, SEED)
    assert found.holds, found.row


async def test_mutated_files_are_read_or_refused(serving: Serving) -> None:
    found = await inputs.mutated_files(serving, 7, SEED)
    assert found.holds, found.row


async def test_small_files_of_large_pictures_take_no_more_than_they_may(serving: Serving) -> None:
    for found in await inputs.bombs(serving, (4096, 2048)):
        assert found.holds, found.row

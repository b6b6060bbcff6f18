"""One budget: what is held counts, what nobody needs is given back, what does not fit is refused by its figures."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.painting.frame_sender import Outgoing
from culet.engine.painting.painter import Painter
from culet.engine.painting.video_track import VideoTrack
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.staging import Staging
from culet.engine.session.history import History
from culet.errors import BusyError
from culet.stage import Library
from culet_protocol.frame import Codec
from engine.painting.test_frame_sender import Telling

MEBIBYTE = 2**20


def test_all_kinds_count_against_one_budget() -> None:
    memory = Memory(10 * MEBIBYTE)
    skies = [3 * MEBIBYTE]
    memory.count("skies", lambda: sum(skies))
    memory.count("meshes", lambda: MEBIBYTE)
    assert memory.free == 6 * MEBIBYTE
    skies.append(2 * MEBIBYTE)
    assert memory.held() == {"skies": 5 * MEBIBYTE, "meshes": MEBIBYTE}
    with memory.reserved("reading", 3 * MEBIBYTE, "reading"), memory.reserved("reading", MEBIBYTE, "reading"):
        assert memory.held()["reading"] == 4 * MEBIBYTE
        assert memory.free == 0
    assert memory.free == 4 * MEBIBYTE


def test_only_as_much_is_given_back_as_is_needed_the_first_named_first() -> None:
    memory = Memory(10)
    held = {"cache": 4, "uploads": 6}
    for kind in held:
        memory.count(kind, lambda kind=kind: held[kind])  # type: ignore[misc]

    def give(kind: str, size: int) -> None:
        held[kind] -= min(size, held[kind])

    memory.give_back(lambda size: give("cache", size))
    memory.give_back(lambda size: give("uploads", size))
    assert memory.make_room(3) == 3
    assert held == {"cache": 1, "uploads": 6}
    assert memory.make_room(3) == 3
    assert held == {"cache": 1, "uploads": 6}
    assert memory.make_room(8) == 8
    assert held == {"cache": 0, "uploads": 2}


def test_what_does_not_fit_is_refused_with_what_is_free_and_what_there_is() -> None:
    memory = Memory(100 * MEBIBYTE)
    memory.count("sessions", lambda: 60 * MEBIBYTE)
    refusal = "a still needs 50 MiB of memory, 40 MiB of the 100 MiB that this server may take are free"
    with pytest.raises(BusyError, match=refusal), memory.reserved("stills", 50 * MEBIBYTE, "a still"):
        pass
    assert memory.free == 40 * MEBIBYTE, "nothing stays reserved"


def test_what_failed_is_not_reserved_any_more() -> None:
    memory = Memory(10)
    with pytest.raises(ZeroDivisionError), memory.reserved("reading", 5, "it"):
        raise ZeroDivisionError
    assert memory.free == 10


def test_encoders_of_sessions_at_rest_are_given_back_and_those_of_moving_ones_are_not() -> None:
    now = time.monotonic()
    memory, resting, moving = Memory(10**9), Outgoing(sent_at=now), Outgoing(sent_at=now, encoded_at=now)
    edits = SimpleNamespace(nbytes=0)
    lives = [
        SimpleNamespace(outgoing=each, session=SimpleNamespace(history=History(), edits=edits))
        for each in (moving, resting)
    ]
    painter = cast(Painter, SimpleNamespace(pictures=dict(enumerate(lives))))
    OpenSessions(painter, Limits(), memory, Staging(Library()))
    for each in (resting, moving):
        each.watch(Codec.H264, subscribed=True)
        each.tracks[Codec.H264] = VideoTrack(Codec.H264, Telling)
        each.tracks[Codec.H264].encode(np.zeros((18, 32, 3), np.uint8), 30, 0)
    memory.make_room(memory.budget)
    assert resting.nbytes == 0 < moving.nbytes

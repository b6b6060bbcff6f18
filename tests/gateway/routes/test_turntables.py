"""Turntables by REST: what is in them, what they say, and that they are bounded and given up."""

from __future__ import annotations

import asyncio
import contextlib
import io
import threading
import zipfile
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence

from culet.errors import BusyError
from culet.gateway.limits.still_places import StillPlaces
from culet.gateway.routes.turntables import TurntableFormat, TurntableQuery, _made
from culet.gateway.state import CLIENT_TURNTABLES, MOST_TURNTABLES
from gateway.running import PATIENCE, Gateway, eventually
from gateway.test_rest import assert_problem

QUERY: dict[str, Any] = {"preset": "matte", "width": 48, "height": 32, "samples": 1}


async def test_an_animation_has_the_frames_and_the_time_asked_for(gateway: Gateway) -> None:
    answer = await gateway.http.get("/api/turntable.webp", params=QUERY | {"frames": 7, "seconds": 1})
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/webp")
    animation = Image.open(io.BytesIO(answer.content))
    assert (animation.size, animation.n_frames, animation.info["loop"]) == ((48, 32), 7, 0)  # type: ignore[attr-defined]
    assert sum(frame.info["duration"] for frame in ImageSequence.Iterator(animation) if frame.load()) == 1000
    assert answer.headers["Culet-Samples"] == "1"
    assert "Culet-Error" not in answer.headers, "of one sample nothing is known"


async def test_the_first_frame_is_the_still_and_others_are_from_elsewhere(gateway: Gateway) -> None:
    answer = await gateway.http.get("/api/turntable.zip", params=QUERY | {"frames": 4})
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/zip")
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert archive.namelist() == ["000.png", "001.png", "002.png", "003.png"]
        frames = [np.asarray(Image.open(archive.open(name)), int) for name in archive.namelist()]
    still = await gateway.http.get("/api/render.png", params=QUERY)
    assert np.array_equal(frames[0], np.asarray(Image.open(io.BytesIO(still.content)), int))
    for one in range(4):
        for other in range(one):
            assert np.abs(frames[one] - frames[other]).mean() > 1, (one, other)


async def test_a_transparent_one_has_alpha_in_every_frame(gateway: Gateway) -> None:
    answer = await gateway.http.get(
        "/api/turntable.webp", params=QUERY | {"frames": 2, "background": "transparent", "floor": "none"}
    )
    for frame in ImageSequence.Iterator(Image.open(io.BytesIO(answer.content))):
        alpha = np.asarray(frame.convert("RGBA"))[..., 3]
        assert (alpha.min(), alpha.max()) == (0, 255)


async def test_what_a_cache_has_is_not_made_again(gateway: Gateway) -> None:
    query = QUERY | {"frames": 2}
    answer = await gateway.http.get("/api/turntable.webp", params=query)
    known = {"If-None-Match": answer.headers["ETag"]}
    assert "max-age" in answer.headers["Cache-Control"]
    assert (await gateway.http.get("/api/turntable.webp", params=query, headers=known)).status_code == 304
    for other in ({"frames": 3}, {"seconds": 2}, {"preset": "white"}):
        assert (await gateway.http.get("/api/turntable.webp", params=query | other, headers=known)).status_code == 200
    assert (await gateway.http.get("/api/turntable.zip", params=query, headers=known)).status_code == 200


async def test_without_samples_frames_are_refined_to_an_error(gateway: Gateway) -> None:
    query = {name: value for name, value in QUERY.items() if name != "samples"} | {"frames": 2, "error": 0.05}
    answer = await gateway.http.get("/api/turntable.webp", params=query)
    assert answer.headers["Culet-Target"] == "met"
    assert float(answer.headers["Culet-Error"]) <= 0.05


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"frames": 1}, "frames"),
        ({"frames": 361}, "frames"),
        ({"seconds": 0}, "seconds"),
        ({"frames": 100, "width": 640, "height": 480}, "frames"),
        ({"width": 2048, "height": 1024}, "frames"),  # of which 36 are too many
        ({"preset": "rubby"}, None),
    ],
)
async def test_what_is_too_much_or_wrong_is_refused_by_its_name(
    gateway: Gateway, wrong: dict[str, Any], field: str | None
) -> None:
    assert_problem(
        await gateway.http.get("/api/turntable.webp", params=QUERY | wrong), 404 if field is None else 422, field
    )


async def test_all_frames_together_may_be_as_much_work_as_one_still(gateway: Gateway) -> None:
    """7e10 pixels x samples x bands: 12 million pixels of 3 bands may have some 1900 samples."""
    query = QUERY | {"frames": 300, "width": 200, "height": 200, "samples": 4000}
    assert_problem(await gateway.http.get("/api/turntable.webp", params=query), 422, "samples")


def test_one_client_leaves_turntables_to_others() -> None:
    places = StillPlaces(CLIENT_TURNTABLES, "turntables", MOST_TURNTABLES)
    with contextlib.ExitStack() as held:
        for _ in range(CLIENT_TURNTABLES):
            held.enter_context(places.place("192.0.2.1"))
        with pytest.raises(BusyError, match="waits for 2 turntables already"), places.place("192.0.2.1"):
            pass
        for _ in range(MOST_TURNTABLES - CLIENT_TURNTABLES):
            held.enter_context(places.place("192.0.2.2"))
        with pytest.raises(BusyError, match="as many turntables are being made"), places.place("192.0.2.3"):
            pass
    assert len(places) == 0


async def test_a_client_with_its_turntables_under_way_gets_no_further_one(gateway: Gateway) -> None:
    query = QUERY | {"frames": 2}
    with contextlib.ExitStack() as held:
        for _ in range(CLIENT_TURNTABLES):
            held.enter_context(gateway.parts.turntables.place("127.0.0.1"))
        assert_problem(await gateway.http.get("/api/turntable.zip", params=query), 429)
    assert (await gateway.http.get("/api/turntable.zip", params=query)).status_code == 200
    assert len(gateway.parts.turntables) == 0


async def test_a_turntable_keeps_its_place_until_nobody_packs_its_frames(gateway: Gateway) -> None:
    """A thread goes on when its client has left, and with it the memory of the frames."""
    begun, let = threading.Event(), threading.Event()

    def packed(_: Sequence[bytes | memoryview], _seconds: float) -> bytes:
        begun.set()
        let.wait(PATIENCE)
        return b""

    query = TurntableQuery.model_validate(QUERY | {"frames": 2})
    kind, place = TurntableFormat("image/webp", packed), contextlib.ExitStack()
    place.enter_context(gateway.parts.turntables.place("127.0.0.1"))
    with place:
        making = asyncio.create_task(_made(gateway.parts, query.scene(), query, kind, "127.0.0.1", place))
        assert await asyncio.to_thread(begun.wait, PATIENCE)
        making.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await making
    assert len(gateway.parts.turntables) == 1
    let.set()

    async def given_back() -> bool:
        return len(gateway.parts.turntables) == 0

    await eventually(given_back)


async def test_who_leaves_is_not_waited_for_and_others_come_in_between(gateway: Gateway) -> None:
    """Of few samples: a frame may take 1/360 of a still's time, on a machine that does much else too."""
    query = QUERY | {"frames": 360, "width": 200, "height": 200, "samples": 16}
    asking = asyncio.create_task(gateway.http.get("/api/turntable.webp", params=query))

    async def under_way() -> bool:
        return len(gateway.parts.stills) == 1

    async def given_up() -> bool:
        return len(gateway.parts.stills) == 0

    await eventually(under_way)
    assert (await gateway.http.get("/api/render.png", params=QUERY)).status_code == 200
    assert not asking.done()
    asking.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await asking
    await eventually(given_up)

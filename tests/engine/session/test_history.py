"""What is kept of shown states: all of each, in little memory."""

from __future__ import annotations

import gc
import math
import tracemalloc
from collections.abc import Callable, Iterator

import pytest

from culet.engine.session.history import History, Past
from culet.errors import NotFoundError
from culet.scene import Scene

SCENES = {
    stones: Scene.read({"stones": [{"id": f"s{i}", "position": (3 * i, 0, 0)} for i in range(stones)]})
    for stones in (0, 1, 12, 64)
}
NOW = Past(-1, Scene())


def falling(scene: Scene, frame: int) -> Scene:
    """All stones are elsewhere in each frame."""
    turn = (math.cos(frame / 100), 0.0, math.sin(frame / 100), 0.0)
    return scene.moved(*(((3.0 * i, -0.001 * frame, 0.1), turn) for i in range(len(scene.stones))))


def orbited(scene: Scene, frame: int) -> Scene:
    """The camera is elsewhere in each frame, as an object of its own."""
    return scene.model_copy(update={"camera": scene.camera.model_copy(update={"position": (1.0, frame, 9.0)})})


def painted(scene: Scene, frame: int) -> Scene:
    """The first stone has another colour in each frame, read from the whole scene's JSON."""
    first, *others = scene.model_dump(mode="json")["stones"]
    stones = [first | {"absorption": (frame / 100, 0, 0)}, *others]
    return Scene.read(scene.model_dump(mode="json") | {"stones": stones})


def shown(vary: Callable[[Scene, int], Scene], stones: int, frames: range) -> Iterator[Past]:
    for frame in frames:
        yield Past(frame, vary(SCENES[stones], frame))


def bytes_of(vary: Callable[[Scene, int], Scene], stones: int) -> tuple[float, float]:
    """Of one state in a row of them: bytes that Python holds for it, and those that the history counts."""
    history = History()
    for past in shown(vary, stones, range(2)):
        history.add(past)
    frames = range(2, 202)
    tracemalloc.start()
    try:
        gc.collect()
        before, counted = tracemalloc.get_traced_memory()[0], history.nbytes
        for past in shown(vary, stones, frames):
            history.add(past)
        del past
        gc.collect()
        held = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    return held / len(frames), (history.nbytes - counted) / len(frames)


@pytest.mark.parametrize(("stones", "most"), [(1, 320), (12, 1024), (64, 4352)])
def test_of_a_falling_stone_its_pose_alone_is_kept(stones: int, most: int) -> None:
    """Measured 252, 906 and 4056 bytes; whole scenes took 2.0, 13.4 and 68 KiB. A pose has 56."""
    held, _ = bytes_of(falling, stones)
    assert 56 * stones < held < most


@pytest.mark.parametrize("stones", [0, 12, 64])
def test_of_an_orbit_around_stones_at_rest_the_view_alone_is_kept(stones: int) -> None:
    """Measured 816 to 1000 bytes."""
    held, _ = bytes_of(orbited, stones)
    assert held < 1280


@pytest.mark.parametrize("vary", [falling, orbited, painted])
@pytest.mark.parametrize("stones", [1, 12])
def test_no_less_is_counted_than_is_held(vary: Callable[[Scene, int], Scene], stones: int) -> None:
    held, counted = bytes_of(vary, stones)
    assert held < counted < 3 * held


def test_a_state_is_had_again_as_it_was_shown() -> None:
    """Whatever the states before and after it share with it: poses, view, stones, or nothing."""
    scenes = [
        vary(SCENES[stones], frame)
        for stones in (12, 1, 0, 12)
        for vary in (falling, orbited, painted)
        for frame in (0, 0, 1, 2)
        if stones or vary is not painted
    ]
    dark = SCENES[12].model_copy(update={"environment": Scene.read({"environment": {"kind": "dark"}}).environment})
    scenes += [SCENES[64], falling(SCENES[64], 5), dark, SCENES[12]]
    history = History()
    for step, scene in enumerate(scenes):
        history.add(Past(step, scene))
    for step, scene in enumerate(scenes):
        again = history.at(step, NOW)
        assert (again.step, again.scene) == (step, scene)
        assert again.scene.model_dump_json() == scene.model_dump_json()


def test_what_is_forgotten_is_not_counted_any_more() -> None:
    history, latest = History(5), History()
    for number, vary in enumerate((painted, falling, orbited)):
        for past in shown(vary, 12, range(4)):
            history.add(Past(4 * number + past.step, past.scene))
    for step in range(7, 12):
        latest.add(history.at(step, NOW))
    assert len(history) == len(latest) == 5
    assert history.nbytes == latest.nbytes


def test_the_oldest_are_forgotten_where_they_would_take_too_much_memory() -> None:
    history = History(600, 80_000)
    for past in shown(painted, 1, range(100)):
        history.add(past)
    assert 1 < len(history) < 12
    assert history.nbytes <= 80_000
    assert history.at(99, NOW).scene == painted(SCENES[1], 99)
    with pytest.raises(NotFoundError, match=rf"keeps the last {len(history)} that it showed"):
        history.at(99 - len(history), NOW)


def test_the_latest_is_kept_however_much_it_takes() -> None:
    history = History(600, 1)
    for past in shown(falling, 64, range(3)):
        history.add(past)
    assert len(history) == 1
    assert history.at(2, NOW).scene == falling(SCENES[64], 2)

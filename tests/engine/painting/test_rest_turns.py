"""Pictures at rest of many sessions: who holds memory, and for how long others wait."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator

import pytest

from culet.engine.painting import rest_turns
from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.engine.painting.live_picture import LivePicture, PictureState
from culet.engine.painting.rest_turn import LONGEST, TURN_SECONDS, RestTurn
from culet.engine.painting.rest_turns import BOUND, resting_bytes, take_turns, waits_to_settle
from culet.engine.session.session import Session
from culet.geometry.mesh import shape_from_mesh
from culet.rendering.cut_out import CuttingRenderer
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.scene import Scene
from engine.peer import TETRAHEDRON
from shared.stages import staged

LIT = staged(Scene.read({"floor": {"kind": "matte"}, "walls": {"kind": "matte"}}), shape_from_mesh(TETRAHEDRON, "off"))
LARGE, SMALL = (960, 540), (64, 36)
UNLIT = staged(Scene.read({"floor": {"kind": "none"}}), shape_from_mesh(TETRAHEDRON, "off"))


@pytest.fixture(scope="module")
def own() -> Iterator[CuttingRenderer]:
    """Whose pool nothing else uses."""
    yield CuttingRenderer()
    gc.collect()


def at_rest(renderer: CuttingRenderer, size: tuple[int, int] = LARGE) -> LivePicture:
    """Drawn in full, without its light."""
    live = LivePicture(Session("0" * 32, LIT if size == LARGE else UNLIT), watched=True, size=size)
    live.picture = renderer.picture(live.session.shown.stage, *size, effort=LightEffort.RESTING)
    live.painted, live.painted_size, live.state = live.session.shown, size, PictureState.FULL
    return live


def having(pictures: list[LivePicture]) -> list[int]:
    """Who has a turn."""
    return [number for number, live in enumerate(pictures) if live.turn.has]


def test_large_pictures_are_refined_one_at_a_time_and_others_hold_no_memory(own: CuttingRenderer) -> None:
    pictures = [at_rest(own) for _ in range(6)]
    alone = own.pool.active_bytes / 6
    take_turns(pictures, now=100)
    assert having(pictures) == [0]
    assert [live.picture is not None for live in pictures] == [True] + [False] * 5
    assert own.pool.active_bytes == pytest.approx(alone)
    assert [live.wants_refinement() for live in pictures] == [True] + [False] * 5
    assert all(live.state is PictureState.FULL for live in pictures), "what is seen of them stays"
    take_turns(pictures, now=101)
    assert having(pictures) == [0]


def test_small_pictures_are_refined_side_by_side(own: CuttingRenderer) -> None:
    pictures = [at_rest(own, SMALL) for _ in range(6)]
    assert sum(map(resting_bytes, pictures)) < BOUND
    take_turns(pictures, now=100)
    assert having(pictures) == list(range(6))
    assert all(live.picture is not None for live in pictures)


def test_a_picture_larger_than_the_bound_is_refined_by_itself(own: CuttingRenderer) -> None:
    pictures = [at_rest(own, (1280, 1100)), at_rest(own, SMALL)]
    assert resting_bytes(pictures[0]) > BOUND
    take_turns(pictures, now=100)
    assert having(pictures) == [0]


def test_a_turn_ends_when_it_has_had_its_time_and_others_wait(own: CuttingRenderer) -> None:
    pictures = [at_rest(own) for _ in range(3)]
    order = []
    for turn in range(6):
        take_turns(pictures, now=100 + turn)
        (has,) = having(pictures)
        order.append(has)
        pictures[has].turn.spent = 0.9 * pictures[has].turn.seconds
        take_turns(pictures, now=100 + turn)
        assert having(pictures) == [has]
        pictures[has].turn.spent = pictures[has].turn.seconds
    assert order == [0, 1, 2, 0, 1, 2]
    take_turns(pictures, now=106)
    assert pictures[1].turn.seconds == 4 * TURN_SECONDS, "twice as long each time"
    alone = pictures[:1]
    take_turns(alone, now=106)
    alone[0].turn.spent = 1e9
    take_turns(alone, now=107)
    assert having(alone) == [0], "nobody waits"


def test_who_has_taken_more_than_its_turn_has_twice_as_much_the_next_time() -> None:
    turn = RestTurn()
    turn.begin(now=100)
    turn.spent = 3 * TURN_SECONDS
    turn.end(now=101)
    assert turn.seconds == 6 * TURN_SECONDS


def test_who_needs_little_goes_first_but_nobody_waits_for_ever(own: CuttingRenderer) -> None:
    dear = at_rest(own)
    dear.turn.end(now=100)
    assert dear.turn.seconds == 2 * TURN_SECONDS
    pictures = [at_rest(own), dear]
    pictures[0].turn.since = 101
    take_turns(pictures, now=101 + TURN_SECONDS / 2)
    assert having(pictures) == [0]
    pictures[0].turn.end(now=102)
    pictures.insert(0, at_rest(own))
    take_turns(pictures, now=101 + 2 * TURN_SECONDS)
    assert having(pictures) == [2], "it has waited for so long"


def test_who_comes_back_has_not_waited_while_nobody_watched(own: CuttingRenderer) -> None:
    left, has, waits = pictures = [at_rest(own) for _ in range(3)]
    take_turns(pictures, now=100)
    assert having(pictures) == [0]
    left.watched = False
    take_turns(pictures, now=101)
    assert having(pictures) == [1]
    left.watched = True
    take_turns(pictures, now=1000)
    has.turn.spent = TURN_SECONDS
    take_turns(pictures, now=1001)
    assert waits.turn.has, "who has waited since"


def test_a_viewer_that_takes_nothing_does_not_keep_its_turn(own: CuttingRenderer) -> None:
    pictures = [at_rest(own) for _ in range(2)]
    take_turns(pictures, now=100)
    take_turns(pictures, now=99 + LONGEST * TURN_SECONDS)
    assert having(pictures) == [0]
    take_turns(pictures, now=100 + LONGEST * TURN_SECONDS)
    assert having(pictures) == [1]


def test_work_that_is_under_way_is_not_interrupted_by_a_turn_s_end(own: CuttingRenderer) -> None:
    pictures = [at_rest(own) for _ in range(2)]
    take_turns(pictures, now=100)
    first = pictures[0]
    first.making = FrameWork(WorkKind.REFINED, first.session.shown, LARGE, first.rest, begun_at=100)
    first.turn.spent = math.inf
    take_turns(pictures, now=101)
    assert having(pictures) == [0]
    first.making = None
    take_turns(pictures, now=101)
    assert having(pictures) == [1]


@pytest.mark.parametrize("end", ["final", "unwatched", "moving"])
def test_a_turn_ends_with_what_it_is_for(own: CuttingRenderer, end: str) -> None:
    pictures = [at_rest(own) for _ in range(2)]
    take_turns(pictures, now=100)
    match end:
        case "final":
            pictures[0].state = PictureState.FINAL
        case "unwatched":
            pictures[0].watched = False
        case _:
            pictures[0].session.set_falling(True)
    take_turns(pictures, now=101)
    assert having(pictures) == [1]


def settled(renderer: CuttingRenderer, size: tuple[int, int]) -> LivePicture:
    """Reduced, and come to rest."""
    live = at_rest(renderer, size)
    live.state, live.picture = PictureState.REDUCED, None
    return live


def test_of_large_pictures_that_have_come_to_rest_one_is_drawn_in_full_at_a_time(own: CuttingRenderer) -> None:
    for size, waits in ((LARGE, True), (SMALL, False)):
        drawn, next_one = settled(own, size), settled(own, size)
        assert not waits_to_settle(next_one, [drawn, next_one])
        work = FrameWork(WorkKind.FULL, drawn.session.shown, size, drawn.rest, begun_at=100)
        drawn.making = work
        assert waits_to_settle(next_one, [drawn, next_one]) == waits
        assert not waits_to_settle(drawn, [drawn, next_one]), "it goes on"
        changed = at_rest(own, size)
        changed.state = PictureState.BLANK
        assert not waits_to_settle(changed, [drawn, changed]), "nothing of it has been seen"
        work.spent = rest_turns.SETTLING_SECONDS
        assert not waits_to_settle(next_one, [drawn, next_one]), "that takes long"


@pytest.mark.parametrize("seen", [0, 6])
def test_a_picture_that_is_begun_anew_is_seen_when_it_is_no_worse_than_before(own: CuttingRenderer, seen: int) -> None:
    live = at_rest(own, SMALL)
    shown = live.session.shown
    picture = own.picture(shown.stage, *SMALL)
    picture.refine()
    work = FrameWork(
        WorkKind.REFINED, shown, SMALL, live.rest, begun_at=0.0, aim=Target(64), now=lambda: 1e9, over=picture.rgb(),
        seen_at=0.0, seen_samples=seen,
    )  # fmt: skip
    work.start(own)
    for _ in work.pieces:
        pass
    assert work.frame is not None
    assert work.frame.samples >= max(1, seen)
    assert work.frame.samples <= max(1, 2 * seen)

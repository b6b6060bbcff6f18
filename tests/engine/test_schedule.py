"""Pictures of real sessions in given situations; what is to be done next."""

import pytest

from culet.engine import schedule
from culet.engine.live import REPEAT_SECONDS, LivePicture
from culet.engine.session import Session
from culet.engine.still import Still
from culet.geometry.mesh import stone_from_mesh
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from engine.peer import TETRAHEDRON

SCENE = Scene()
STONE = stone_from_mesh(TETRAHEDRON, "off")
RENDERER = Renderer()


def live(*, watched: bool = True, begun_at: float = 0, rate: float = 10) -> LivePicture:
    return LivePicture(Session("0" * 32, SCENE, STONE), watched=watched, begun_at=begun_at, rate=rate)


def painted(picture: LivePicture, *, final: bool) -> LivePicture:
    picture.picture = None if final else RENDERER.picture(SCENE, STONE, 16, 16)
    picture.painted, picture.painted_size = picture.session.shown, picture.size
    picture.final, picture.message, picture.sent_at = final, b"frame", 0
    return picture


def test_a_picture_that_nobody_watches_is_never_due() -> None:
    assert schedule.next_frame([live(watched=False)], now=1e9) is None
    assert schedule.idle_seconds([live(watched=False)], now=1e9) is None


def test_a_frame_is_due_one_interval_after_the_one_before() -> None:
    picture = live(begun_at=5, rate=10)
    assert schedule.next_frame([picture], now=5.09) is None
    assert abs((schedule.idle_seconds([picture], now=5.04) or 0) - 0.06) < 1e-9
    assert schedule.next_frame([picture], now=5.11) is picture


def test_a_frame_that_is_a_little_late_does_not_make_the_next_one_late() -> None:
    picture = live(begun_at=5, rate=10)
    picture.begin(now=5.17)
    assert picture.begun_at == pytest.approx(5.1)
    assert picture.due_at() == pytest.approx(5.2)
    picture.begin(now=5.31)
    assert picture.begun_at == 5.31, "more than a frame is not made up for"


def test_of_two_frames_due_the_one_begun_longest_ago_goes_first() -> None:
    older, newer = live(begun_at=1), live(begun_at=2)
    assert schedule.next_frame([newer, older], now=100) is older


def test_a_picture_at_rest_is_refined_until_it_is_final() -> None:
    refining, final = painted(live(), final=False), painted(live(), final=True)
    assert schedule.next_frame([refining, final], now=100) is None
    assert schedule.next_background([refining, final], None) is refining


def test_a_change_a_new_size_or_motion_make_it_due_again() -> None:
    changed, resized, falling = (painted(live(), final=True) for _ in range(3))
    changed.session.change(SCENE.model_copy(update={"lights": ()}))
    resized.size = (32, 32)
    falling.session.set_falling(True)
    for picture in (changed, resized, falling):
        assert schedule.next_frame([picture], now=100) is picture
        assert schedule.next_background([picture], None) is None


def test_what_could_not_be_rendered_is_tried_again_only_when_it_changed() -> None:
    picture = live()
    picture.refused = picture.session.shown
    assert schedule.next_frame([picture], now=100) is None
    picture.session.change(SCENE.model_copy(update={"lights": ()}))
    assert schedule.next_frame([picture], now=100) is picture


async def test_nobody_waits_for_a_session_whose_stone_is_being_made() -> None:
    picture = live()
    async with picture.session.lock:
        assert schedule.next_frame([picture], now=100) is None
    assert schedule.next_frame([picture], now=100) is picture


async def test_stills_and_refinements_take_turns() -> None:
    refining = painted(live(), final=False)
    still = Still(SCENE, STONE, 16, 16, 1, "tga")
    refining.served_at, still.served_at = 1, 2
    assert schedule.next_background([refining], still) is refining
    refining.served_at = 3
    assert schedule.next_background([refining], still) is still


def test_a_frame_at_rest_is_repeated_after_a_second_of_silence() -> None:
    picture = painted(live(), final=True)
    assert schedule.next_repeat([picture], now=REPEAT_SECONDS * 0.99) is None
    assert schedule.next_repeat([picture], now=REPEAT_SECONDS) is picture
    assert schedule.idle_seconds([picture], now=0.25) == REPEAT_SECONDS - 0.25

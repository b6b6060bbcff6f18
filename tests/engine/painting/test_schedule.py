"""Pictures of real sessions in given situations; what is to be done next."""

import pytest

from culet.engine.painting import schedule
from culet.engine.painting.frame_sender import REPEAT_SECONDS, UNSENT_FRAMES
from culet.engine.painting.frame_work import FrameWork, WorkKind
from culet.engine.painting.live_picture import ANSWER_PART, REST_WEIGHT, STEERED_SECONDS, LivePicture, PictureState
from culet.engine.painting.shares import Shares
from culet.engine.painting.still import STILLS_WEIGHT, Still, StillQueue
from culet.engine.session.session import Session
from culet.geometry.mesh import shape_from_mesh
from culet.rendering.film.target import Target
from culet.rendering.renderer import Renderer
from culet.scene import PointLight, Scene
from culet.stage import Stage
from engine.peer import TETRAHEDRON
from shared.stages import staged

SCENE = Scene()
LAMP = PointLight(position=(1, 2, 3), colour=(1, 1, 1))
STAGE = staged(SCENE, shape_from_mesh(TETRAHEDRON, "off"))
RENDERER = Renderer()


def live(*, watched: bool = True, begun_at: float = 0, rate: float = 10) -> LivePicture:
    return LivePicture(Session("0" * 32, STAGE), watched=watched, begun_at=begun_at, rate=rate)


def painted(picture: LivePicture, *, final: bool) -> LivePicture:
    picture.picture = None if final else RENDERER.picture(STAGE, 16, 16)
    picture.turn.has = not final
    picture.painted, picture.painted_size = picture.session.shown, picture.size
    picture.state = PictureState.FINAL if final else PictureState.FULL
    picture.outgoing.message, picture.outgoing.sent_at = b"frame", 0
    return picture


def in_work(picture: LivePicture, kind: WorkKind = WorkKind.FULL) -> LivePicture:
    picture.making = FrameWork(kind, picture.session.shown, picture.size, picture.frames, begun_at=0)
    return picture


def next_of(
    pictures: list[LivePicture], now: float, *, stills: StillQueue | None = None, shares: Shares | None = None
) -> LivePicture | StillQueue | None:
    return schedule.next_work(pictures, stills or StillQueue(4, 2**25), shares or Shares(), now)


def test_a_picture_that_nobody_watches_is_never_due() -> None:
    assert next_of([live(watched=False)], now=1e9) is None
    assert schedule.idle_seconds([live(watched=False)], now=1e9) is None


def test_a_frame_is_due_one_interval_after_the_one_before() -> None:
    picture = live(begun_at=5, rate=10)
    assert next_of([picture], now=5.09) is None
    assert abs((schedule.idle_seconds([picture], now=5.04) or 0) - 0.06) < 1e-9
    assert next_of([picture], now=5.11) is picture


def test_a_frame_that_is_a_little_late_does_not_make_the_next_one_late() -> None:
    picture = live(begun_at=5, rate=10)
    picture.begin(now=5.17)
    assert picture.begun_at == pytest.approx(5.1)
    assert picture.due_at() == pytest.approx(5.2)
    picture.begin(now=5.31)
    assert picture.begun_at == 5.31, "more than a frame is not made up for"


def moved(picture: LivePicture, number: int) -> None:
    """Somebody moves the camera."""
    camera = SCENE.camera.model_copy(update={"position": (0.0, 2.0, 13.0 + number)})
    picture.session.change(STAGE.showing(SCENE.model_copy(update={"camera": camera})))


def drawn(picture: LivePicture, now: float) -> None:
    """A frame of what falls is begun and done."""
    picture.begin(now)
    picture.session.look(now)
    picture.painted, picture.painted_size, picture.state = picture.session.shown, picture.size, PictureState.REDUCED


def falling_since(now: float, rate: float = 10) -> LivePicture:
    picture = live(begun_at=now - 1 / rate, rate=rate)
    picture.session.set_falling(True)
    picture.session.motion.look_on(now, 1.0)
    drawn(picture, now)
    return picture


def test_an_input_that_comes_alone_is_answered_by_a_frame_begun_early() -> None:
    picture = falling_since(5.0)
    assert picture.due_at() == pytest.approx(5.1)
    moved(picture, 1)
    assert picture.due_at() == pytest.approx(5.0 + ANSWER_PART * 0.1)
    assert picture.answers_early(5.07)
    drawn(picture, 5.07)
    assert picture.due_at() == pytest.approx(5.17), "the rate is held from there"


@pytest.mark.parametrize("rate", [2, 5, 8, 10, 30])
@pytest.mark.parametrize("apart", [0.005, 0.06])
def test_inputs_of_a_hand_that_goes_on_are_answered_at_the_rate_that_is_held(rate: float, apart: float) -> None:
    picture, now, frames, seconds = falling_since(5.0, rate), 5.0, 0, 4
    for number in range(round(seconds / 0.005)):
        now += 0.005
        if (number * 0.005) % apart < 0.004:
            moved(picture, number)
        if next_of([picture], now) is picture:
            drawn(picture, now)
            frames += 1
    assert 0.85 * rate * seconds <= frames <= rate * seconds + 2


def test_what_moves_by_itself_is_no_input() -> None:
    picture = falling_since(5.0)
    drawn(picture, 5.1)
    assert not picture.unanswered
    assert picture.due_at() == pytest.approx(5.2)


def test_somebody_steers_from_an_input_s_frame_on_until_there_was_none_for_a_while() -> None:
    picture = falling_since(5.0)
    assert not picture.steered(5.05)
    moved(picture, 1)
    drawn(picture, 5.07)
    assert picture.steered(5.08)
    drawn(picture, 5.17)  # of what moves by itself
    assert picture.steered(5.07 + 0.9 * STEERED_SECONDS)
    assert not picture.steered(5.07 + STEERED_SECONDS)


def test_of_two_frames_due_the_one_begun_longest_ago_goes_first() -> None:
    older, newer = live(begun_at=1), live(begun_at=2)
    assert next_of([newer, older], now=100) is older


def test_a_picture_at_rest_is_refined_until_it_is_final() -> None:
    refining, final = painted(live(), final=False), painted(live(), final=True)
    assert next_of([refining, final], now=100) is refining
    assert refining.next_account is refining.rest
    assert next_of([final], now=100) is None


def test_a_reduced_picture_is_drawn_in_full_when_things_have_settled() -> None:
    reduced = painted(live(begun_at=4), final=False)
    reduced.state, reduced.settles_at = PictureState.REDUCED, 5
    assert next_of([reduced], now=4.9) is None
    assert next_of([reduced], now=5) is reduced
    assert reduced.next_account is reduced.rest, "something is to be seen of it already"


def test_a_change_a_new_size_or_motion_make_it_due_again() -> None:
    changed, resized, falling = (painted(live(), final=True) for _ in range(3))
    changed.session.change(STAGE.showing(SCENE.model_copy(update={"emitters": (LAMP,)})))
    resized.size = (32, 32)
    falling.session.set_falling(True)
    for picture in (changed, resized, falling):
        assert next_of([picture], now=100) is picture
        assert not picture.wants_refinement()
        assert picture.next_account is picture.frames


def test_what_could_not_be_rendered_is_tried_again_only_when_it_changed() -> None:
    picture = live()
    picture.refuse(picture.session.shown)
    assert next_of([picture], now=100) is None
    picture.session.change(STAGE.showing(SCENE.model_copy(update={"emitters": (LAMP,)})))
    assert next_of([picture], now=100) is picture


async def test_nobody_waits_for_a_session_whose_stone_is_being_made() -> None:
    picture = live()
    async with picture.session.lock:
        assert next_of([picture], now=100) is None
    assert next_of([picture], now=100) is picture


def test_a_frame_in_the_making_goes_on_as_long_as_somebody_watches() -> None:
    picture = in_work(live(begun_at=100))
    assert next_of([picture], now=100) is picture, "though the next one is not due"
    picture.watched = False
    assert next_of([picture], now=100) is None


def test_no_frame_is_begun_while_those_before_it_wait_to_be_sent() -> None:
    picture = live()
    picture.outgoing.unsent = UNSENT_FRAMES
    assert next_of([picture], now=100) is None
    picture.outgoing.unsent -= 1
    assert next_of([picture], now=100) is picture


def test_of_two_frames_the_one_of_who_has_had_less_goes_on() -> None:
    dear, cheap, shares = in_work(live()), live(begun_at=99), Shares()
    shares.charge(dear.frames, 0.03, 100)
    assert next_of([dear, cheap], now=100, shares=shares) is cheap
    shares.charge(cheap.frames, 0.05, 100)
    assert next_of([dear, cheap], now=100, shares=shares) is dear


async def test_refinements_and_stills_get_their_smaller_share_beside_a_moving_picture() -> None:
    moving, refining = in_work(live()), painted(live(), final=False)
    stills, shares, now = StillQueue(4, 2**25), Shares(), 100.0
    still = Still(STAGE, 16, 16, Target(1), "tga")
    stills.put(still)
    had: dict[int, float] = {}
    for _ in range(7000):
        chosen = next_of([moving, refining], now, stills=stills, shares=shares)
        assert chosen is not None
        now += 0.01
        shares.charge(chosen.account if isinstance(chosen, StillQueue) else chosen.next_account, 0.01, now)
        had[id(chosen)] = had.get(id(chosen), 0) + 1
    assert had[id(refining)] / had[id(moving)] == pytest.approx(REST_WEIGHT, rel=0.01)
    assert had[id(stills)] / had[id(moving)] == pytest.approx(STILLS_WEIGHT, rel=0.01)


LIT = staged(Scene.read({"floor": {"kind": "matte"}}), shape_from_mesh(TETRAHEDRON, "off"))
"""Its stone throws light onto the floor."""


def falling(stage: Stage, seconds: float) -> LivePicture:
    """Whose frames take so long."""
    picture = LivePicture(Session("0" * 32, stage), watched=True, rate=10)
    picture.session.set_falling(True)
    picture.quality.planned_seconds = seconds
    return picture


def most_under_way(pictures: list[LivePicture], frames: int) -> tuple[int, dict[int, int]]:
    """Of so many frames, drawn in pieces of 10 ms: how many were under way at a time, and how many each picture had."""
    shares, now, most, done = Shares(), 100.0, 0, dict.fromkeys(map(id, pictures), 0)
    while sum(done.values()) < frames:
        chosen = next_of(pictures, now, shares=shares)
        assert isinstance(chosen, LivePicture)
        chosen.frames.payers = schedule.payers(chosen, pictures, now)
        if chosen.work is None:
            chosen.begin(now)
            in_work(chosen, WorkKind.PLANNED)
        assert chosen.work is not None
        now += 0.01
        chosen.work.spent += 0.01
        shares.charge(chosen.frames, 0.01, now)
        most = max(most, sum(picture.work is not None for picture in pictures))
        if chosen.work.spent > chosen.quality.planned_seconds - 1e-9:
            chosen.making = None
            done[id(chosen)] += 1
    return most, done


def test_of_alike_frames_with_their_own_light_two_are_under_way_and_each_has_its_turn() -> None:
    most, done = most_under_way([falling(LIT, 0.05) for _ in range(10)], frames=100)
    assert most == schedule.WITH_LIGHT
    assert max(done.values()) - min(done.values()) <= 1
    most, done = most_under_way([falling(STAGE, 0.05) for _ in range(10)], frames=100)
    assert most == 10, "without light there is nothing to be spared"


def test_of_first_frames_with_their_own_light_two_are_under_way_too() -> None:
    """As after an engine's start, when all sessions come at once and nobody knows what their frames take."""
    begun = [in_work(falling(LIT, 0.0), WorkKind.PLANNED) for _ in range(2)]
    for picture in begun:
        assert picture.work is not None
        picture.work.spent = 0.01
    shares = Shares()
    for picture in begun:
        shares.charge(picture.frames, 0.01, 100)
    assert next_of([*begun, falling(LIT, 0.0)], now=101, shares=shares) in begun


def test_a_frame_with_light_that_is_under_way_does_not_take_the_turn_of_one_to_be_begun() -> None:
    shares = Shares()
    under_way, own = in_work(falling(LIT, 0.02), WorkKind.PLANNED), falling(LIT, 0.02)
    under_way.begun_at, own.begun_at = 1, 2
    shares.charge(under_way.frames, 0.01, 100)
    assert next_of([under_way, own], now=101, shares=shares) is own


@pytest.mark.parametrize("seconds", [0.2, 0.001])
def test_nobody_waits_for_the_light_of_dearer_or_cheaper_frames(seconds: float) -> None:
    others = [in_work(falling(LIT, seconds), WorkKind.PLANNED) for _ in range(3)]
    own, shares = falling(LIT, 0.02), Shares()
    for picture in others:
        shares.charge(picture.frames, 0.01, 100)
    assert next_of([*others, own], now=101, shares=shares) is own


def test_a_frame_that_takes_much_longer_than_it_did_is_waited_for_no_more() -> None:
    alike, own, shares = [in_work(falling(LIT, 0.03), WorkKind.PLANNED) for _ in range(2)], falling(LIT, 0.02), Shares()
    for picture in alike:
        shares.charge(picture.frames, 0.01, 100)
    assert next_of([*alike, own], now=101, shares=shares) in alike
    for picture in alike:
        assert picture.work is not None
        picture.work.spent = 0.05
    assert next_of([*alike, own], now=101, shares=shares) is own


@pytest.mark.parametrize("stage", [LIT, STAGE], ids=["with light", "without"])
def test_of_alike_frames_with_light_the_one_that_waits_longest_is_begun_first(stage: Stage) -> None:
    """All that wait pay alike, so that who has had a little less would stay ahead for ever."""
    older, newer, shares = falling(stage, 0.02), falling(stage, 0.02), Shares()
    older.begun_at, newer.begun_at = 1, 2
    shares.charge(older.frames, 0.001, 100)
    assert next_of([newer, older], now=101, shares=shares) is (older if stage is LIT else newer)


def test_who_waits_for_light_has_a_part_in_what_it_costs() -> None:
    under_way = [in_work(falling(LIT, 0.03), WorkKind.PLANNED) for _ in range(2)]
    waiting, dear, dark = [falling(LIT, 0.02) for _ in range(2)], falling(LIT, 0.5), falling(STAGE, 0.02)
    everyone = [*under_way, *waiting, dear, dark]
    assert schedule.payers(under_way[0], everyone, 100) == [
        (under_way[0].frames, 0.5), (waiting[0].frames, 0.25), (waiting[1].frames, 0.25)
    ]  # fmt: skip
    assert schedule.payers(dear, everyone, 100) == [(dear.frames, 1)]
    assert schedule.payers(dark, everyone, 100) == [(dark.frames, 1)]


def test_sessions_with_cheap_and_with_dear_light_have_the_same_time() -> None:
    pictures = [*(falling(LIT, 0.2) for _ in range(4)), *(falling(LIT, 0.02) for _ in range(4))]
    most, done = most_under_way(pictures, frames=440)
    assert most == 2 * schedule.WITH_LIGHT, "two of each kind"
    dear, cheap = ([done[id(picture)] for picture in kind] for kind in (pictures[:4], pictures[4:]))
    assert max(dear) - min(dear) <= 1
    assert max(cheap) - min(cheap) <= 2
    assert 0.75 < sum(cheap) / 10 / sum(dear) < 1.33, "measured: 0.82"


@pytest.mark.parametrize("seconds", [0.0, 0.05])
def test_only_what_moves_and_was_timed_waits_for_light(seconds: float) -> None:
    with_light = [in_work(falling(LIT, 0.05), WorkKind.PLANNED) for _ in range(2)]
    assert schedule.waits_for_light(falling(LIT, seconds), with_light) == (seconds > 0)
    resting = LivePicture(Session("0" * 32, LIT), watched=True)
    resting.quality.planned_seconds = seconds
    assert not schedule.waits_for_light(painted(resting, final=False), with_light)
    assert not schedule.waits_for_light(in_work(falling(LIT, seconds), WorkKind.PLANNED), with_light), "it goes on"


def test_a_frame_at_rest_is_repeated_after_a_second_of_silence() -> None:
    picture = painted(live(), final=True)
    assert schedule.next_repeat([picture], now=REPEAT_SECONDS * 0.99) is None
    assert schedule.next_repeat([picture], now=REPEAT_SECONDS) is picture
    assert schedule.idle_seconds([picture], now=0.25) == REPEAT_SECONDS - 0.25

import json
import math
from typing import Any

import numpy as np
import pytest

from culet.engine.session import events
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.errors import InputError, SceneError
from culet.optics.sky_files.picture import SkyPicture
from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from culet.scene.room import FLOOR_Y
from culet.simulation.rigid_body.rotation import rotate
from culet.stage import Library, Sky, Stage
from culet_protocol import messages
from culet_protocol.messages import SessionEvent
from shared.stones import skew_block

SKIES = {
    name: SkyPicture(np.full((4, 8, 3), grey, np.float32)) for name, grey in {"sunrise": 0.5, "sunset": 0.25}.items()
}
LIBRARY = Library({}, SKIES)
MESHES = Library({"block": skew_block()}, SKIES)


def session(**scene: Any) -> Session:  # noqa: ANN401
    settings = legacy(scene)
    stage = Stage.of(settings, LIBRARY)
    return Session("0" * 32, stage, sky=events.own_sky(stage.sky))


def after(subject: Session, *happened: SessionEvent) -> Scene:
    for event in happened:
        events.apply(subject, event, LIBRARY)
    return subject.scene


def falling(subject: Session, seconds: float = 0.2) -> Session:
    after(subject, messages.ToggleFall())
    subject.advance(0)
    subject.advance(seconds)
    return subject


def test_the_camera_orbits_moves_and_goes_home() -> None:
    subject = session()
    start = subject.scene.camera
    moved = after(
        subject, messages.Orbit(yaw=1, pitch=0.1), messages.Translate(right=1, up=0), messages.Dolly(forward=1)
    )
    assert moved.camera != start
    assert after(subject, messages.ResetCamera()).camera == start


def test_the_camera_is_kept_out_of_stones_by_moves_and_refused_in_them_by_patches() -> None:
    subject = session(
        stones=[{"id": "gem", "position": [0, 1, 0]}], camera={"position": [0, 1, 5], "target": [0, 1, 0]}
    )
    near = after(subject, messages.Dolly(forward=100)).camera.position
    assert 1 - 0.7 < near[2] < 1.1, "before the stone, on its girdle or its crown"
    assert after(subject, messages.Dolly(forward=1)).camera.position == pytest.approx(near, abs=1e-9)
    before = subject.scene
    with pytest.raises(InputError, match=r"outside of the stones.*'gem'") as refused:
        after(subject, messages.PatchScene(patch={"camera": {"position": [0, 1.1, 0.1]}}))
    assert refused.value.field == "camera.position"
    assert subject.scene == before
    after(subject, messages.PatchScene(patch={"camera": {"position": [0, 1.1, 0.1]}, "stones": {"gem": None}}))
    with_stone = {"stones": {"gem": {"cut": "brilliant", "position": [0, 1, 0]}}}
    inside = after(subject, messages.PatchScene(patch=with_stone)).camera.position
    assert inside == pytest.approx((0, 1.1, 0.1)), "a stone may come about the camera"
    after(subject, messages.PatchScene(patch={"camera": {"fov_degrees": 20}}))
    assert after(subject, messages.Dolly(forward=-3)).camera.position != inside


def test_a_patch_of_the_camera_minds_stones_where_they_are_now() -> None:
    subject = falling(session(stones=[{"id": "gem", "position": [0, 8, 0], "velocity": [0, -20, 0]}]))
    x, y, z = subject.shown.scene.stones[0].position
    assert y < 7
    with pytest.raises(InputError, match="outside of the stones"):
        after(subject, messages.PatchScene(patch={"camera": {"position": [x + 0.05, y, z + 0.05]}}))
    after(subject, messages.PatchScene(patch={"camera": {"position": [0, 8.1, 0.05]}}))
    moved = {"camera": {"position": [3, 8, 0.1]}, "stones": {"gem": {"position": [3, 8, 0]}}}
    with pytest.raises(InputError, match="outside of the stones"):
        after(subject, messages.PatchScene(patch=moved))


def test_the_camera_looks_at_the_stone_where_that_is_now_and_goes_home_again() -> None:
    subject = falling(session(stones=[{"position": [5, 8, 0]}]))
    start, shown = subject.scene.camera, subject.shown.scene.stones[0].position
    assert shown[1] < 8
    camera = after(subject, messages.LookAtStone()).camera
    assert camera.target == shown
    assert np.subtract(camera.position, camera.target) == pytest.approx(np.subtract(start.position, start.target))
    assert after(subject, messages.ResetCamera()).camera == start


def test_without_a_stone_there_is_nothing_to_look_at() -> None:
    with pytest.raises(InputError, match="expected a scene with a stone, got none"):
        after(session(stones=[]), messages.LookAtStone())


@pytest.mark.parametrize(("target", "number"), [("light_1", 0), ("light_2", 1)])
def test_each_light_moves_alone(target: Any, number: int) -> None:  # noqa: ANN401
    subject = session()
    before = subject.scene
    moved = after(subject, messages.Translate(target=target, right=0.5, up=0))
    assert math.dist(moved.points[number].position, before.points[number].position) == pytest.approx(0.5)
    assert moved.points[1 - number] == before.points[1 - number]
    assert moved.points[number].colour == before.points[number].colour
    assert moved.camera == before.camera


def test_a_light_that_is_not_there_cannot_be_moved() -> None:
    subject = session(emitters=[])
    with pytest.raises(InputError, match="0 point lights, no light_2") as caught:
        after(subject, messages.Orbit(target="light_2", yaw=1, pitch=0))
    assert caught.value.field == "target"


def test_nothing_can_be_moved_out_of_the_world() -> None:
    subject = session(camera={"position": [0, 0, 9.999e8], "target": [0, 0, 0]})
    before = subject.shown
    with pytest.raises(InputError, match="out of the world"):
        after(subject, messages.Dolly(forward=-1e6))
    assert subject.shown is before


def test_mirror_switches_floor_and_those_walls_that_are_shown() -> None:
    assert kinds(after(session(), messages.ToggleMirror())) == ("matte", "none")
    walled = session(walls={"kind": "mirror"})
    assert kinds(after(walled, messages.ToggleMirror())) == ("matte", "matte")
    assert kinds(after(walled, messages.ToggleMirror())) == ("mirror", "mirror")


def test_a_surface_that_was_a_mirror_or_away_has_its_own_albedo_and_checker_again() -> None:
    painted = {"kind": "matte", "albedo": [0.1, 0.2, 0.3], "checker": {"cell": 2}}
    subject = session(floor=painted, walls={**painted, "checker": "off"})
    start = subject.scene
    mirrored = after(subject, messages.ToggleMirror(), messages.ToggleWalls())
    assert kinds(mirrored) == ("mirror", "none")
    back = after(subject, messages.ToggleWalls(), messages.ToggleMirror())
    assert (back.floor, back.walls) == (start.floor, start.walls)


def test_walls_come_in_the_floors_kind_and_go() -> None:
    subject = session(floor={"kind": "mirror"})
    assert kinds(after(subject, messages.ToggleWalls())) == ("mirror", "mirror")
    assert kinds(after(subject, messages.ToggleWalls())) == ("mirror", "none")
    assert kinds(after(session(floor={"kind": "none"}), messages.ToggleWalls())) == ("none", "matte")


def kinds(scene: Scene) -> tuple[str, str]:
    return scene.floor.kind, scene.walls.kind


@pytest.mark.parametrize(
    "own", [{}, {"environment": {"kind": "dark"}}, {"environment": {"kind": "image", "image": "sunset"}}]
)
def test_the_sky_switches_between_light_and_the_scenes_own(own: dict[str, Any]) -> None:
    subject = session(**own)
    before = subject.shown
    assert after(subject, messages.ToggleEnvironment()).environment.kind == "light"
    assert after(subject, messages.ToggleEnvironment()).environment == before.scene.environment
    assert subject.shown.stage.panorama is before.stage.panorama


def test_a_scene_that_is_light_itself_switches_to_dark() -> None:
    subject = session(environment={"kind": "light"})
    assert after(subject, messages.ToggleEnvironment()).environment.kind == "dark"
    assert after(subject, messages.ToggleEnvironment()).environment.kind == "light"


def test_a_new_sky_is_the_scenes_own_from_then_on() -> None:
    subject = session()
    after(subject, messages.ToggleEnvironment(), messages.PatchScene(patch={"environment": {"kind": "half"}}))
    assert after(subject, messages.ToggleEnvironment()).environment.kind == "light"
    assert after(subject, messages.ToggleEnvironment()).environment.kind == "half"


def test_a_switched_sky_survives_in_another_engine() -> None:
    subject = session()
    own = subject.scene.environment
    after(subject, messages.ToggleEnvironment())
    snapshot = SessionSnapshot.read(json.loads(subject.snapshot().model_dump_json()))
    assert snapshot.environment is not None
    sky = LIBRARY.sky(snapshot.environment)
    other = Session.restored(subject.name, subject.stage, snapshot, sky=sky)
    assert after(other, messages.ToggleEnvironment()).environment == own


def test_the_light_sky_is_seen_in_the_atelier_too_and_goes_back_to_it_in_another_engine() -> None:
    subject = lying_session()
    before = subject.scene
    light = after(subject, messages.ToggleEnvironment())
    assert (light.environment.kind, light.backdrop.kind, kinds(light)) == ("light", "none", ("mirror", "none"))
    snapshot = SessionSnapshot.read(json.loads(subject.snapshot().model_dump_json()))
    other = Session.restored(subject.name, subject.stage, snapshot, sky=Sky(before.environment))
    for one in (subject, other):
        assert after(one, messages.ToggleEnvironment()) == before
    after(subject, messages.ToggleEnvironment(), messages.PatchScene(patch={"floor": {"kind": "matte"}}))
    assert kinds(after(subject, messages.ToggleEnvironment())) == ("matte", "none"), "chosen under the light sky"


def test_a_patched_sky_brings_its_panorama_and_another_edit_keeps_it() -> None:
    subject = session(environment={"kind": "image", "image": "sunrise"})
    sunrise, sunset = LIBRARY.skies["sunrise"].pixels, LIBRARY.skies["sunset"].pixels
    assert subject.shown.stage.panorama is sunrise
    after(subject, messages.PatchScene(patch={"environment": {"image": "sunset"}}))
    assert subject.shown.stage.panorama is sunset
    after(subject, messages.PatchScene(patch={"environment": {"turn_degrees": 90}}))
    after(subject, messages.ToggleMirror())
    assert subject.shown.stage.panorama is sunset
    after(subject, messages.SetScene(scene={"environment": {"kind": "image", "image": "sunrise"}}))
    assert subject.shown.stage.panorama is sunrise


def test_the_stone_falls_pauses_and_goes_back() -> None:
    subject = session()
    start = subject.pose()
    falling(subject)
    fallen = subject.pose()
    assert fallen is not None
    assert start is not None
    assert fallen["position"][1] < start["position"][1] - 0.1
    after(subject, messages.ToggleFall())
    subject.advance(10)
    assert subject.pose() == fallen
    after(subject, messages.ResetStone())
    assert subject.pose() == start
    assert not subject.motion.falling


def test_a_stone_that_sleeps_is_dropped_anew_by_the_same_key() -> None:
    subject = falling(session(simulation={"restitution": 0, "gravity": 100}))
    for tenth in range(20):  # it sleeps after 1 s
        subject.advance(tenth / 10)
    assert (subject.motion.asleep, subject.motion.falling, subject.motion.moving) == (True, True, False)
    assert subject.described()["asleep"]
    after(subject, messages.ToggleFall())
    assert subject.pose() == session().pose(), "its start"
    assert (subject.motion.asleep, subject.motion.falling, subject.motion.moving) == (False, True, True)
    subject.advance(100)
    subject.advance(100.2)
    assert 0 < subject.shown.simulation_time <= 0.2


def test_nothing_falls_in_a_scene_without_a_stone() -> None:
    with pytest.raises(InputError, match="nothing can fall"):
        after(session(stones=[]), messages.ToggleFall())


def test_a_patch_of_what_is_not_about_motion_leaves_the_stone_in_the_air() -> None:
    subject = falling(session())
    pose = subject.pose()
    material: dict[str, Any] = subject.scene.model_dump(mode="json")["stones"][0] | {"material": "classic"}
    after(subject, messages.PatchScene(patch={"stones": [material], "floor": {"kind": "matte"}}))
    assert subject.pose() == pose
    assert subject.motion.falling
    assert subject.shown.scene.stones[0].material == "classic"


def test_another_shape_is_put_at_the_start_at_rest() -> None:
    subject = falling(session())
    scene = after(subject, messages.PatchScene(patch={"stones": [{"cut": {"table_percent": 60}}]}))
    assert subject.shown.scene.stones[0].position == scene.stones[0].position
    assert not subject.motion.falling


def lying_session() -> Session:
    """The default scene, whose stone lies on the floor."""
    return Session("0" * 32, Stage.of(Scene(), MESHES))


def lowest(subject: Session) -> float:
    """y of the stone's lowest corner, R."""
    placed = subject.shown.scene.stones[0]
    corners = (rotate(placed.orientation, (a, b, c)) for a, b, c in subject.stage.shapes[0].vertices.tolist())
    return placed.position[1] + min(y for _, y, _ in corners)


@pytest.mark.parametrize("change", [{"cut": {"pavilion_degrees": 46}}, {"mesh": "block"}])
def test_another_shape_lies_on_the_floor_as_the_one_before_did(change: dict[str, Any]) -> None:
    subject = lying_session()
    before = subject.scene
    whole = before.model_dump(mode="json")["stones"][0]
    events.apply(subject, messages.PatchScene(patch={"stones": [whole | change]}), MESHES)
    assert lowest(subject) == pytest.approx(FLOOR_Y, abs=1e-9)
    assert subject.scene.stones[0].position == subject.shown.scene.stones[0].position, "R puts it there too"
    events.apply(subject, messages.PatchScene(patch={"stones": [whole]}), MESHES)
    assert subject.scene == before, "what is put back is as it was"


def test_another_shape_goes_where_the_patch_says() -> None:
    subject = lying_session()
    after(subject, messages.PatchScene(patch={"stones": [{"cut": {"table_percent": 60}, "position": [0, -0.5, 0]}]}))
    assert subject.scene.stones[0].position == (0, -0.5, 0)


@pytest.mark.parametrize(
    "patch",
    [
        {"stones": [{"position": [0, 3, 0]}]},
        {"stones": [{"orientation": [1, 0, 0, 0]}]},
        {"stones": {"stone": {"spin": [0, 9, 0]}}},
        {"stones": {"stone": {"velocity": [1, 0, 0]}}},
    ],
)
@pytest.mark.parametrize("falls", [True, False])
def test_another_start_is_shown_and_a_falling_stone_falls_from_there(patch: dict[str, Any], falls: bool) -> None:
    subject = falling(session(), 0.204)  # between two steps
    if not falls:
        after(subject, messages.ToggleFall())
    scene = after(subject, messages.PatchScene(patch=patch))
    assert subject.pose() == session(**scene.model_dump(mode="json")).pose()
    assert subject.shown.simulation_time == 0
    assert (subject.motion.falling, subject.motion.moving) == (falls, falls)
    fresh = session(**scene.model_dump(mode="json"))
    fresh.set_falling(falls)
    for one in (subject, fresh):
        one.advance(50)
        one.advance(50.2)
    assert subject.pose() == fresh.pose()


def test_a_patched_camera_is_shown_and_becomes_home() -> None:
    subject = session()
    after(subject, messages.Orbit(yaw=1, pitch=0))
    orbited = subject.scene.camera
    after(subject, messages.PatchScene(patch={"camera": {"fov_degrees": 30}}))
    assert subject.scene.camera == orbited.model_copy(update={"fov_degrees": 30})
    home = after(subject, messages.ResetCamera()).camera
    assert home == LEGACY_DEFAULT.camera.model_copy(update={"fov_degrees": 30})


def test_a_new_scene_replaces_camera_and_stone() -> None:
    subject = falling(session())
    after(subject, messages.Orbit(yaw=1, pitch=0))
    scene = after(subject, messages.SetScene(scene={"stones": [{"position": [0, 2, 0]}]}))
    assert scene == Scene.read({"stones": [{"position": [0, 2, 0]}]})
    assert subject.shown.scene == scene
    assert not subject.motion.falling


@pytest.mark.parametrize(
    ("event", "field"),
    [
        (messages.PatchScene(patch={"camera": {"fov_degrees": 500}}), "camera.fov_degrees"),
        (messages.PatchScene(patch={"camera": {"fov_degrees": math.nan}}), "camera.fov_degrees"),
        (messages.PatchScene(patch={"colour": 1}), "colour"),
        (messages.SetScene(scene={"floor": {"kind": "lava"}}), "floor.kind"),
        (messages.SetScene(scene={"stones": [{"mesh": "nowhere"}]}), "stones.0.mesh"),
        (messages.SetScene(scene={"stones": [{"mesh": "../etc/passwd"}]}), "stones.0.mesh"),
        (messages.SetScene(scene={"environment": {"kind": "image", "image": "nowhere"}}), "environment.image"),
        (messages.SetScene(scene={"environment": {"kind": "image", "image": "../sky"}}), "environment.image"),
    ],
)
def test_a_bad_scene_is_refused_by_field_and_changes_nothing(event: SessionEvent, field: str) -> None:
    subject = falling(session())
    shown, scene = subject.shown, subject.scene
    with pytest.raises(SceneError) as caught:
        after(subject, event)
    assert caught.value.field == field
    assert (subject.shown, subject.scene, subject.motion.falling) == (shown, scene, True)

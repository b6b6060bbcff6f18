"""What each event does to a session. An event that cannot be applied raises InputError and changes nothing."""

from __future__ import annotations

from typing import Any, Literal, assert_never

from pydantic import ValidationError

from culet.engine.session import viewpoint
from culet.engine.session.clearance import entered, stepped_back, stopped
from culet.engine.session.edits import Edit, Moment, paths_of
from culet.engine.session.hand import by_hand
from culet.engine.session.history import Past
from culet.engine.session.picking import placed
from culet.engine.session.session import Session
from culet.errors import InputError, NotFoundError, SceneError
from culet.scene import Camera, Plane, Scene
from culet.scene.emitters import PointLight
from culet.scene.patch import read_patched, sharing
from culet.scene.sky import DarkEnvironment, LightEnvironment
from culet.scene.sky_seen import Surroundings, back_under, under
from culet.simulation.lying import put_down
from culet.stage import Library, Sky, Stage
from culet_protocol import messages
from culet_protocol.messages import SessionEvent, Target

LIGHT = Sky(LightEnvironment(kind="light"))


def apply(session: Session, event: SessionEvent, library: Library) -> None:
    """Apply an event; a stone is made (which may take a while) only if its shape changes. Edits may be undone."""
    before = session.moment
    _apply(session, event, library)
    what = _edited_by(event)
    if what is not None:
        session.edits.note(what, before, session.moment)


def _edited_by(event: SessionEvent) -> str | None:
    """What an event edits: the same for events that count as one edit while they follow each other soon, empty for one
    that is always an edit by itself; None if it is none."""
    match event:
        case messages.Orbit() | messages.Translate() | messages.Dolly():
            return None if event.target == "camera" else event.target
        case messages.PatchScene():
            return None if event.patch.keys() == {"camera"} else paths_of(event.patch)
        case messages.MoveStone() | messages.DragStone() | messages.TurnStone():
            return f"hand {event.stone}"
        case messages.ToggleMirror() | messages.ToggleEnvironment() | messages.ToggleWalls() | messages.SetScene():
            return ""
        case messages.ResetCamera() | messages.LookAtStone() | messages.Balance() | messages.Undo() | messages.Redo():
            return None
        case messages.ToggleFall() | messages.ResetStone() | messages.Push():
            return None
        case _:
            assert_never(event)


def _apply(session: Session, event: SessionEvent, library: Library) -> None:
    match event:
        case messages.Orbit() | messages.Translate() | messages.Dolly():
            _move(session, event)
        case messages.ResetCamera():
            session.change(session.stage.showing(session.scene.model_copy(update={"camera": session.home})))
        case messages.LookAtStone():
            _look_at_stone(session, event.stone)
        case messages.ToggleFall():
            session.toggle_fall(event.stone)
        case messages.ResetStone():
            session.reset_stone(event.stone)
        case messages.Push():
            session.push(event.x, event.y, event.right, event.up)
        case messages.MoveStone() | messages.DragStone() | messages.TurnStone():
            by_hand(session, event)
        case messages.ToggleMirror():
            session.change(session.stage.showing(_with_mirror_toggled(session.scene)))
        case messages.ToggleEnvironment():
            _toggle_environment(session)
        case messages.ToggleWalls():
            session.change(session.stage.showing(_with_walls_toggled(session.scene)))
        case messages.PatchScene():
            _patch(session, event.patch, library)
        case messages.Balance():
            session.balance = event
        case messages.SetScene():
            stage = Stage.of(Scene.read(event.scene), library, before=known_to(session))
            session.replace(stage, home=stage.scene.camera, sky=own_sky(stage.sky))
        case messages.Undo():
            edit, left = session.edits.to_undo(), session.moment
            _go(session, edit, edit.after, edit.before, library)
            session.edits.undone(left, session.moment)
        case messages.Redo():
            edit, left = session.edits.to_redo(), session.moment
            _go(session, edit, edit.before, edit.after, library)
            session.edits.redone(left, session.moment)
        case _:
            assert_never(event)


def known_to(session: Session) -> Stage:
    """The shapes that the session has, and the picture of its own sky, for another stage to be made of."""
    return session.stage.under(session.sky)


def past_stage(past: Past, before: Stage, library: Library) -> Stage:
    """What a session showed at a step, by what is `known_to` the session; NotFoundError if that is not kept any more.
    May make shapes, which takes a while."""
    try:
        return Stage.of(past.scene, library, before=before)
    except SceneError as error:
        raise NotFoundError(f"what was shown at step {past.step} is not kept any more: {error}") from error


def own_sky(sky: Sky) -> Sky:
    """The sky that a switch from the light sky goes to: the scene's own sky, or the dark if that is the light."""
    return Sky(DarkEnvironment(kind="dark")) if sky.environment.kind == "light" else sky


def _go(session: Session, edit: Edit, here: Moment, there: Moment, library: Library) -> None:
    """From one of an edit's two moments to the other: only what the edit changed changes.

    The view stays unless the edit moved the camera, stones go on unless the edit moved them, and time goes on, or not,
    as it does now unless the edit has stopped it.
    """
    camera, home = (there.scene.camera, there.home) if edit.moved_camera else (session.scene.camera, session.home)
    falling = session.motion.falling if here.falling == there.falling else there.falling
    try:
        own = session.sky if there.own == session.sky.environment else library.sky(there.own)
        scene = there.scene.model_copy(update={"camera": camera})
        stage = Stage.of(scene, library, before=known_to(session))
    except SceneError as error:
        raise InputError(f"a file that the scene had then is not kept any more: {error}", error.field) from error
    sky = own._replace(surroundings=there.surroundings)
    session.change(stage, home=home, sky=sky, states=there.states, falling=falling)


def _move(session: Session, event: messages.Orbit | messages.Translate | messages.Dolly) -> None:
    try:
        if event.target == "camera":
            scene = session.scene.model_copy(update={"camera": _moved_camera(session, event)})
        else:
            scene = _with_light_moved(session.scene, event, event.target)
    except ValidationError as error:
        raise InputError(
            f"{event.type} would move the {event.target} out of the world: {error.errors()[0]['msg']}"
        ) from error
    session.change(session.stage.showing(scene))


def _look_at_stone(session: Session, name: str | None = None) -> None:
    """Look at the stone of that id, or at all stones."""
    there = placed(session.shown.stage)
    stones = [stone for stone in there if name in (None, stone.name)]
    if not stones:
        raise _no_stone(session.scene, name, "there is nothing to look at")
    centre, radius = viewpoint.ball_about([(stone.position, stone.scale) for stone in stones])
    try:
        looking = viewpoint.look_at(session.scene.camera, centre, radius)
        camera = stepped_back(session.scene.camera, looking, there)
        scene = session.scene.model_copy(update={"camera": camera})
    except ValidationError as error:
        raise InputError(f"the stone is beyond where a camera can be: {error.errors()[0]['msg']}") from error
    session.change(session.stage.showing(scene))


def _no_stone(scene: Scene, name: str | None, consequence: str) -> InputError:
    """For an event that needs a stone, or the stone of that id."""
    if name is None or not scene.stones:
        return InputError(f"expected a scene with a stone, got none: {consequence}", None if name is None else "stone")
    ids = ", ".join(repr(stone.id) for stone in scene.stones)
    return InputError(f"stone: expected the id of a stone ({ids}), got {name!r}", "stone")


def _moved_camera(session: Session, event: messages.Orbit | messages.Translate | messages.Dolly) -> Camera:
    """The session's camera, moved, but into no stone."""
    camera, stones = session.scene.camera, placed(session.shown.stage)
    match event:
        case messages.Orbit():
            return stepped_back(camera, viewpoint.orbit(camera, event.yaw, event.pitch), stones)
        case messages.Translate():
            return stopped(camera, viewpoint.translate(camera, event.right, event.up), stones)
        case messages.Dolly():
            return stopped(camera, viewpoint.dolly(camera, event.forward), stones)
        case _:
            assert_never(event)


def _with_light_moved(
    scene: Scene, event: messages.Orbit | messages.Translate | messages.Dolly, target: Target
) -> Scene:
    number = {"light_1": 0, "light_2": 1}[target]
    points = scene.points
    if number >= len(points):
        raise InputError(f"target: the scene has {len(points)} point lights, no {target}", "target")
    light = points[number]
    match event:
        case messages.Orbit():
            position = viewpoint.orbit_light(light.position, event.yaw, event.pitch)
        case messages.Translate():
            position = viewpoint.shift_light(light.position, scene.camera, event.right, event.up, 0)
        case messages.Dolly():
            position = viewpoint.shift_light(light.position, scene.camera, 0, 0, event.forward)
        case _:
            assert_never(event)
    moved = PointLight(position=position, colour=light.colour)
    emitters = tuple(moved if emitter is light else emitter for emitter in scene.emitters)
    return scene.model_copy(update={"emitters": emitters})


def _with_mirror_toggled(scene: Scene) -> Scene:
    kind: Literal["matte", "mirror"] = "matte" if scene.floor.kind == "mirror" else "mirror"
    floor = scene.floor if isinstance(scene.floor, Plane) else Plane()
    walls = scene.walls if scene.walls.kind == "none" else _of_kind(scene.walls, kind)
    return scene.model_copy(update={"floor": _of_kind(floor, kind), "walls": walls})


def _of_kind(surface: Plane, kind: Literal["none", "matte", "mirror"]) -> Plane:
    """With the albedo and the checker that it has when it is matte."""
    return surface.model_copy(update={"kind": kind})


def _toggle_environment(session: Session) -> None:
    """To the light sky, which is seen then, or back to the scene's own as that was seen."""
    stage, own = session.stage, session.sky
    if stage.scene.environment.kind == "light":
        scene = back_under(stage.scene, own.environment, own.surroundings)
        session.change(stage.under(own).showing(scene))
    else:
        sky = own._replace(surroundings=Surroundings.of(stage.scene))
        session.change(stage.under(LIGHT).showing(under(stage.scene, LIGHT.environment)), sky=sky)


def _with_walls_toggled(scene: Scene) -> Scene:
    if scene.walls.kind != "none":
        walls = _of_kind(scene.walls, "none")
    else:
        walls = _of_kind(scene.walls, "mirror" if scene.floor.kind == "mirror" else "matte")
    return scene.model_copy(update={"walls": walls})


def _patch(session: Session, patch: dict[str, Any], library: Library) -> None:
    """Apply a merge patch to the scene as it is now, and to the camera that a reset goes back to."""
    before = session.scene
    document = before.model_dump(mode="json")
    after = read_patched(document, patch)
    home = session.home
    if "camera" in patch:
        at_home = document | {"camera": home.model_dump(mode="json")}
        home = read_patched(at_home, patch).camera
    stage = put_down(Stage.of(after, library, before=known_to(session)), session.stage)
    _check_camera(session, stage)
    sky = None if after.environment == before.environment else own_sky(stage.sky)
    session.change(stage.showing(sharing(stage.scene, before)), home=home, sky=sky)


def _check_camera(session: Session, stage: Stage) -> None:
    """InputError if the camera of a stage is put into a stone: where that is now, or is put."""
    before, camera = session.scene.camera, stage.scene.camera
    if camera.kind != "pinhole" or camera.position == before.position:
        return
    starts, seen = ({stone.id: stone for stone in scene.stones} for scene in (session.scene, session.shown.scene))
    poses = []
    for stone in stage.scene.stones:
        old = starts.get(stone.id)
        stays = old is not None and (old.position, old.orientation) == (stone.position, stone.orientation)
        now = seen[stone.id] if stays else stone
        poses.append((now.position, now.orientation))
    name = entered(before.position, camera.position, placed(stage.posed(poses)))
    if name is not None:
        raise InputError(
            f"camera.position: expected a place outside of the stones, got {camera.position}, inside of {name!r}",
            "camera.position",
        )

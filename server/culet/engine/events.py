"""What each event does to a session. An event that cannot be applied raises InputError and changes nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, assert_never

from pydantic import ValidationError

from culet.engine import viewpoint
from culet.engine.assets import Assets
from culet.engine.merge_patch import merge_patch
from culet.engine.session import Past, Session, Sky
from culet.errors import InputError, NotFoundError, SceneError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.scene import Camera, Environment, Light, Plane, Scene
from culet.scene.model import DarkEnvironment, LightEnvironment
from culet.scene.sky_seen import Surroundings, back_under, under
from culet.simulation.lying import on_the_floor
from culet_protocol import messages
from culet_protocol.messages import SessionEvent, Target


def apply(session: Session, event: SessionEvent, assets: Assets) -> None:
    """Apply an event; a stone is made (which may take a while) only if its shape changes."""
    match event:
        case messages.Orbit() | messages.Translate() | messages.Dolly():
            _move(session, event)
        case messages.ResetCamera():
            session.change(session.scene.model_copy(update={"camera": session.home}))
        case messages.LookAtStone():
            _look_at_stone(session)
        case messages.ToggleFall():
            session.toggle_fall()
        case messages.ResetStone():
            session.reset_stone()
        case messages.Push():
            session.push(event.x, event.y, event.right, event.up)
        case messages.ToggleMirror():
            session.change(_with_mirror_toggled(session.scene))
        case messages.ToggleEnvironment():
            _toggle_environment(session)
        case messages.ToggleWalls():
            session.change(_with_walls_toggled(session.scene))
        case messages.PatchScene():
            _patch(session, event.patch, assets)
        case messages.Balance():
            session.balance = event
        case messages.SetScene():
            scene = Scene.read(event.scene)
            stone, sky = stone_for(scene, session, assets), sky_for(scene, session, assets)
            session.replace_stone(scene, stone, home=scene.camera, sky=sky)
        case _:
            assert_never(event)


def stone_for(scene: Scene, session: Session | None, assets: Assets) -> Stone | None:
    """The shape of a scene's stone: the session's, if that is the same shape."""
    if not scene.stones:
        return None
    if session is not None and session.stone is not None and _shape(scene) == _shape(session.scene):
        return session.stone
    return assets.stone(scene.stones[0])


def sky_for(scene: Scene, session: Session | None, assets: Assets) -> Sky:
    """A scene's own sky, or the session's if the scene is under that one."""
    if session is not None and session.sky.environment == scene.environment:
        return session.sky
    return own_sky(scene.environment, assets)


def past_subject(past: Past, session: Session, assets: Assets) -> tuple[Stone | None, Panorama | None]:
    """The stone and the picture of the sky that a session showed at a step; NotFoundError if they are not kept any
    more. May make the stone, which takes a while."""
    try:
        stone = stone_for(past.scene, session, assets)
        return stone, sky_for(past.scene, session, assets).panorama
    except SceneError as error:
        raise NotFoundError(f"what was shown at step {past.step} is not kept any more: {error}") from error


def own_sky(environment: Environment, assets: Assets) -> Sky:
    """The other sky than the light one: the environment, or, if that is light itself, the dark."""
    if environment.kind == "light":
        return Sky(DarkEnvironment(kind="dark"))
    return Sky(environment, assets.panorama(environment))


def _move(session: Session, event: messages.Orbit | messages.Translate | messages.Dolly) -> None:
    try:
        if event.target == "camera":
            session.change(session.scene.model_copy(update={"camera": _moved_camera(session.scene.camera, event)}))
        else:
            session.change(_with_light_moved(session.scene, event, event.target))
    except ValidationError as error:
        raise InputError(
            f"{event.type} would move the {event.target} out of the world: {error.errors()[0]['msg']}"
        ) from error


def _look_at_stone(session: Session) -> None:
    if not session.shown.scene.stones:
        raise InputError("expected a scene with a stone, got none: there is nothing to look at")
    camera, position = session.scene.camera, session.shown.scene.stones[0].position
    try:
        session.change(session.scene.model_copy(update={"camera": viewpoint.look_at(camera, position)}))
    except ValidationError as error:
        raise InputError(f"the stone is beyond where a camera can be: {error.errors()[0]['msg']}") from error


def _moved_camera(camera: Camera, event: messages.Orbit | messages.Translate | messages.Dolly) -> Camera:
    match event:
        case messages.Orbit():
            return viewpoint.orbit(camera, event.yaw, event.pitch)
        case messages.Translate():
            return viewpoint.translate(camera, event.right, event.up)
        case messages.Dolly():
            return viewpoint.dolly(camera, event.forward)
        case _:
            assert_never(event)


def _with_light_moved(
    scene: Scene, event: messages.Orbit | messages.Translate | messages.Dolly, target: Target
) -> Scene:
    number = {"light_1": 0, "light_2": 1}[target]
    if number >= len(scene.lights):
        raise InputError(f"target: the scene has {len(scene.lights)} lights, no {target}", "target")
    light = scene.lights[number]
    match event:
        case messages.Orbit():
            position = viewpoint.orbit_light(light.position, event.yaw, event.pitch)
        case messages.Translate():
            position = viewpoint.shift_light(light.position, scene.camera, event.right, event.up, 0)
        case messages.Dolly():
            position = viewpoint.shift_light(light.position, scene.camera, 0, 0, event.forward)
        case _:
            assert_never(event)
    lights = list(scene.lights)
    lights[number] = Light(position=position, colour=light.colour)
    return scene.model_copy(update={"lights": tuple(lights)})


def _with_mirror_toggled(scene: Scene) -> Scene:
    kind: Literal["matte", "mirror"] = "matte" if scene.floor.kind == "mirror" else "mirror"
    walls = scene.walls if scene.walls.kind == "none" else Plane(kind=kind)
    return scene.model_copy(update={"floor": Plane(kind=kind), "walls": walls})


def _toggle_environment(session: Session) -> None:
    """To the light sky, which is seen then, or back to the scene's own as that was seen."""
    scene, sky = session.scene, session.sky
    if scene.environment.kind == "light":
        session.change(back_under(scene, sky.environment, sky.surroundings))
    else:
        light = under(scene, LightEnvironment(kind="light"))
        session.change(light, sky=replace(sky, surroundings=Surroundings.of(scene)))


def _with_walls_toggled(scene: Scene) -> Scene:
    if scene.walls.kind != "none":
        walls = Plane(kind="none")
    else:
        walls = Plane(kind="mirror" if scene.floor.kind == "mirror" else "matte")
    return scene.model_copy(update={"walls": walls})


def _patch(session: Session, patch: dict[str, Any], assets: Assets) -> None:
    """Apply a merge patch to the scene as it is now, and to the camera that a reset goes back to."""
    before = session.scene
    document = before.model_dump(mode="json")
    after = Scene.read(merge_patch(document, patch))
    home = session.home
    if "camera" in patch:
        at_home = document | {"camera": home.model_dump(mode="json")}
        home = Scene.read(merge_patch(at_home, patch)).camera
    sky = None if after.environment == before.environment else sky_for(after, session, assets)
    if _shape(after) != _shape(before):
        stone = stone_for(after, session, assets)
        if stone is not None and session.stone is not None and _pose(after) == _pose(before):
            after = on_the_floor(after, stone, session.stone)
        session.replace_stone(after, stone, home=home, sky=sky)
    elif _start(after) != _start(before):
        session.start_anew(after, home=home, sky=sky)
    else:
        session.change(after, home=home, sky=sky)


def _shape(scene: Scene) -> object:
    """What the stone's shape depends on."""
    return [(stone.cut, stone.mesh) for stone in scene.stones]


def _start(scene: Scene) -> object:
    """Where and how the stone starts: a patch of anything else leaves it where it is."""
    return _pose(scene), scene.simulation.velocity, scene.simulation.spin


def _pose(scene: Scene) -> object:
    """Of the stone at the start."""
    return [(stone.position, stone.orientation) for stone in scene.stones]

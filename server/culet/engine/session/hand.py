"""Stones moved and turned by a viewer's hand."""

from __future__ import annotations

from typing import assert_never

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from culet.engine.session.session import Session
from culet.engine.session.viewpoint import axes, half_height
from culet.errors import InputError
from culet.scene import Camera
from culet.simulation.placing import moved_by_hand
from culet.simulation.rigid_body.state import Triple
from culet_protocol.messages import DragStone, MoveStone, TurnStone

Array = NDArray[np.float64]
STILL: Triple = (0.0, 0.0, 0.0)


def by_hand(session: Session, event: MoveStone | DragStone | TurnStone) -> None:
    """Put the stone where the hand moves it, as far as there is room. InputError without that stone, or if it would go
    beyond the range of coordinates."""
    world, camera = session.motion.world, session.scene.camera
    place = world.state.bodies[world.number(event.stone)].position
    match event:
        case MoveStone():
            pose = moved_by_hand(world, event.stone, _shift(camera, event.right, event.up, event.forward), STILL)
        case DragStone():
            half = _half_height_at(camera, place)
            pose = moved_by_hand(world, event.stone, _shift(camera, half * event.right, half * event.up, 0.0), STILL)
        case TurnStone():
            pose = moved_by_hand(world, event.stone, STILL, _turn(camera, event.yaw, event.pitch, event.roll))
        case _:
            assert_never(event)
    if pose is None:
        return
    try:
        session.place(event.stone, pose)
    except ValidationError as error:
        raise InputError(f"{event.type} would move the stone out of the world: {error.errors()[0]['msg']}") from error


def _shift(camera: Camera, right: float, up: float, forward: float) -> Triple:
    """R, in the world."""
    along = axes(camera)
    return _triple(right * along[0] + up * along[1] + forward * along[2])


def _turn(camera: Camera, yaw: float, pitch: float, roll: float) -> Triple:
    """In the world, as long as the angle in radians."""
    right, _, forward = axes(camera)
    up = np.array(camera.up, float)
    return _triple(yaw * up / np.linalg.norm(up) - pitch * right - roll * forward)


def _half_height_at(camera: Camera, place: Triple) -> float:
    """R that half of the picture's height is at a place; 0 behind the camera."""
    if camera.kind == "orthographic":
        return half_height(camera)
    _, _, forward = axes(camera)
    return half_height(camera) * max(float(forward @ np.subtract(place, camera.position)), 0.0)


def _triple(array: Array) -> Triple:
    x, y, z = array.tolist()
    return x, y, z

"""Drag, wheel, and fingers: the camera goes about what it looks at, a light about the origin."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest
from playwright.sync_api import CDPSession

from e2e.conftest import SMALL, ViewOf
from e2e.server import Server
from e2e.view import View, difference

START, DX, DY = (60, 100), 54, 27
"""CSS pixels: where a drag begins, and how far it goes."""
HALF_TURN = SMALL["height"]
"""CSS pixels of a drag by half a turn: the picture's shorter side."""
SEEN = 0.4
"""Mean difference, of 255, that an edit must make. Measured: a light 3.5, the camera 21 to 46."""


def spherical(position: list[float], about: list[float]) -> tuple[float, float, float]:
    """Distance (R), azimuth counter-clockwise seen from above, and elevation (radians)."""
    x, y, z = np.subtract(position, about)
    return math.hypot(x, y, z), math.atan2(x, z), math.atan2(y, math.hypot(x, z))


def drag(view: View) -> None:
    """With the mouse, in three steps."""
    mouse = view.page.mouse
    mouse.move(*START)
    mouse.down()
    mouse.move(START[0] + DX, START[1] + DY, steps=3)
    mouse.up()
    view.settle_messages()


def touch(fingers: CDPSession, kind: str, *points: tuple[float, float]) -> None:
    """A touch event of the DevTools protocol, with all fingers that are down after it."""
    at = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
    fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": at})


def drag_by_touch(view: View) -> None:
    """With one finger, in three steps."""
    fingers = view.page.context.new_cdp_session(view.page)
    x, y = START
    touch(fingers, "touchStart", (x, y))
    for part in (1 / 3, 2 / 3, 1):
        touch(fingers, "touchMove", (x + part * DX, y + part * DY))
    touch(fingers, "touchEnd")
    view.settle_messages()


@pytest.mark.parametrize("by", [drag, drag_by_touch])
def test_a_drag_turns_the_camera_about_its_target_as_if_the_scene_were_held(
    view_of: ViewOf, server: Server, by: Callable[[View], None]
) -> None:
    view = view_of(has_touch=True).open()
    start = view.scene["camera"]
    before, after = view.change(lambda: by(view))
    camera = server.session(view.session)["scene"]["camera"]
    assert camera == view.scene["camera"]
    assert camera["target"] == start["target"]
    distance, azimuth, elevation = spherical(start["position"], start["target"])
    turned = (distance, azimuth - math.pi * DX / HALF_TURN, elevation + math.pi * DY / HALF_TURN)
    # Measured: 1e-15 by mouse; touch positions are rounded on their way, to some 1e-6.
    np.testing.assert_allclose(spherical(camera["position"], camera["target"]), turned, atol=1e-4)
    assert difference(before.pixels, after.pixels) > SEEN
    assert {message["type"] for message in view.sent} == {"orbit"}


def test_a_drag_takes_a_light_along(view: View, server: Server) -> None:
    view.page.keyboard.press("2")
    start = view.scene
    before, after = view.change(lambda: drag(view))
    scene = server.session(view.session)["scene"]
    assert scene["camera"] == start["camera"]
    (still, begun), (same, moved) = (
        [emitter for emitter in each["emitters"] if emitter["shape"] == "point"] for each in (start, scene)
    )
    assert same == still
    origin = [0.0, 0.0, 0.0]
    distance, azimuth, elevation = spherical(begun["position"], origin)
    turned = (distance, azimuth + math.pi * DX / HALF_TURN, elevation - math.pi * DY / HALF_TURN)
    np.testing.assert_allclose(spherical(moved["position"], origin), turned, atol=1e-9)
    assert difference(before.pixels, after.pixels) > SEEN


@pytest.mark.parametrize(("notches", "nearer"), [(-1, 0.5), (1, -0.5), (-2, 1.0)])
def test_a_notch_of_the_wheel_is_a_key_press(view: View, server: Server, notches: int, nearer: float) -> None:
    start = view.scene["camera"]
    view.page.mouse.move(*START)
    before, after = view.change(lambda: view.page.mouse.wheel(0, 100 * notches))
    camera = server.session(view.session)["scene"]["camera"]
    assert math.dist(camera["position"], camera["target"]) == pytest.approx(
        math.dist(start["position"], start["target"]) - nearer
    )
    assert difference(before.pixels, after.pixels) > SEEN


def test_two_fingers_that_part_bring_the_camera_nearer(view_of: ViewOf, server: Server) -> None:
    view = view_of(has_touch=True).open()
    start = view.scene["camera"]
    fingers = view.page.context.new_cdp_session(view.page)

    def pinch() -> None:
        touch(fingers, "touchStart", (120, 100))
        touch(fingers, "touchStart", (120, 100), (160, 100))
        touch(fingers, "touchMove", (110, 100), (170, 100))
        touch(fingers, "touchMove", (100, 100), (180, 100))
        touch(fingers, "touchEnd")
        view.settle_messages()

    before, after = view.change(pinch)
    camera = server.session(view.session)["scene"]["camera"]
    doubled = 2.0  # R for a doubling of the distance between the fingers
    assert math.dist(camera["position"], camera["target"]) == pytest.approx(
        math.dist(start["position"], start["target"]) - doubled, abs=1e-4
    )
    np.testing.assert_allclose(camera["target"], start["target"])
    assert difference(before.pixels, after.pixels) > SEEN
    scale = view.page.evaluate("() => visualViewport.scale")
    assert scale == 1, "the page itself is not zoomed"


OTHER_BUTTONS: tuple[Literal["right", "middle"], ...] = ("right", "middle")


def test_the_other_buttons_do_not_drag(view: View) -> None:
    mouse = view.page.mouse
    for button in OTHER_BUTTONS:
        mouse.move(*START)
        mouse.down(button=button)
        mouse.move(START[0] + DX, START[1])
        mouse.up(button=button)
    mouse.move(*START)
    view.settle_messages()
    assert view.sent == []

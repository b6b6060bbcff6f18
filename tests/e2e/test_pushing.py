"""Shift and drag pushes the stone where it is seen; the camera stays."""

from __future__ import annotations

from e2e.conftest import SMALL
from e2e.view import View


def push_from(view: View, x: float, y: float) -> None:
    """A flick to the right, CSS pixels."""
    mouse = view.page.mouse
    mouse.move(x, y)
    view.page.keyboard.down("Shift")
    mouse.down()
    mouse.move(x + 30, y, steps=3)
    mouse.up()
    view.page.keyboard.up("Shift")


def test_shift_and_drag_pushes_the_stone_and_leaves_the_camera(view: View) -> None:
    start = view.scene["camera"]
    push_from(view, SMALL["width"] / 2, SMALL["height"] / 2)  # the stone fills the middle
    view.until("() => culet.state.falling")
    assert view.scene["camera"] == start
    assert [message["type"] for message in view.sent] == ["push"]
    assert view.sent[0]["right"] > 0
    assert view.sent[0]["up"] == 0


def test_a_push_past_the_stone_does_nothing(view: View) -> None:
    push_from(view, 4, 108)
    view.settle_messages()
    assert [message["type"] for message in view.sent] == ["push"]
    assert not view.state["falling"]
    assert view.problems == []

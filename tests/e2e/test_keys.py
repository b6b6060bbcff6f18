"""Every key of the report's section 2, by place and by letter: what is sent, what the scene becomes, what is seen.

Expected places follow from the camera of the scene alone: the report's half R a key press, along the picture's axes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import expect

from e2e.conftest import WITH_PANEL, ViewOf, bouncing_in
from e2e.server import Server
from e2e.view import View, assert_same, difference

STEP = 0.5
CTRL, META, ALT = 2, 4, 1
"""Bits of the DevTools protocol's Input.dispatchKeyEvent."""

Vector = NDArray[np.float64]
Scene = dict[str, Any]

KEYS: dict[str, tuple[str, dict[str, Any] | str]] = {
    "c": ("KeyC", "camera"),
    "1": ("Digit1", "light_1"),
    "2": ("Digit2", "light_2"),
    "ArrowLeft": ("ArrowLeft", {"type": "translate", "target": "camera", "right": -STEP, "up": 0}),
    "ArrowRight": ("ArrowRight", {"type": "translate", "target": "camera", "right": STEP, "up": 0}),
    "ArrowUp": ("ArrowUp", {"type": "translate", "target": "camera", "right": 0, "up": STEP}),
    "ArrowDown": ("ArrowDown", {"type": "translate", "target": "camera", "right": 0, "up": -STEP}),
    "i": ("KeyI", {"type": "dolly", "target": "camera", "forward": STEP}),
    "o": ("KeyO", {"type": "dolly", "target": "camera", "forward": -STEP}),
    "f": ("KeyF", {"type": "reset_camera"}),
    "p": ("KeyP", {"type": "toggle_fall"}),
    "r": ("KeyR", {"type": "reset_stone"}),
    "m": ("KeyM", {"type": "toggle_mirror"}),
    "l": ("KeyL", {"type": "toggle_environment"}),
    "w": ("KeyW", {"type": "toggle_walls"}),
}
"""Printed letter -> its place on a QWERTY keyboard, and the message, or the target that is moved from then on.
S, which sends no message, has its own tests."""

NO_LETTER_OF_OURS = "\u0436"
"""What a key prints on a layout (here Cyrillic) of which no key is ours by its letter."""


def meaning_of(key: str) -> tuple[list[dict[str, Any]], str]:
    """The messages of a key, and the target after it."""
    meaning = KEYS[key][1]
    return ([], meaning) if isinstance(meaning, str) else ([meaning], "camera")


BY_PLACE_AND_LETTER: dict[str, Callable[[str, str], tuple[str, str]]] = {
    "qwerty": lambda key, code: (code, key),
    "caps-lock": lambda key, code: (code, key.upper() if len(key) == 1 else key),
    "by-place-alone": lambda key, code: (code, NO_LETTER_OF_OURS),
    "by-letter-alone": lambda key, code: ("Unidentified", key),
}


def test_every_key_acts_once_by_its_place_or_by_its_letter(view: View) -> None:
    for layout, place_and_letter in BY_PLACE_AND_LETTER.items():
        for key, (code, _) in KEYS.items():
            messages, target = meaning_of(key)
            if key == "c":
                view.press("Digit2", "2")  # another target, so that the choice is seen
            view.press(*place_and_letter(key, code))
            assert view.sent == messages, (layout, key)
            assert view.state["target"] == target, (layout, key)
            view.sent.clear()
            view.press("KeyC", "c")
    assert view.problems == []


OTHER_LAYOUTS = {
    "azerty-place-of-m": ("KeyM", ",", "m"),
    "azerty-letter-m": ("Semicolon", "m", "m"),
    "azerty-place-of-w": ("KeyW", "z", "w"),
    "azerty-letter-w": ("KeyZ", "w", "w"),
    "azerty-place-of-1": ("Digit1", "&", "1"),
    "dvorak-letter-p-at-the-place-of-r": ("KeyR", "p", "p"),
    "russian-place-of-l": ("KeyL", "\u0434", "l"),
    "number-pad": ("Numpad2", "2", "2"),
}
"""The place that is pressed, what is printed there, and which of our keys is meant."""


def test_another_layout_means_what_is_printed_or_else_the_place(view: View) -> None:
    for layout, (code, key, meant) in OTHER_LAYOUTS.items():
        messages, target = meaning_of(meant)
        view.press(code, key)
        assert view.sent == messages, layout
        assert view.state["target"] == target, layout
        view.sent.clear()
        view.press("KeyC", "c")


def test_a_key_held_down_moves_again_but_does_not_switch_again(view: View) -> None:
    view.press("ArrowUp", "ArrowUp", repeat=True)
    assert len(view.sent) == 1
    view.sent.clear()
    for key in "fprmlw12c":
        view.press(KEYS[key][0], key, repeat=True)
    assert view.sent == []
    assert view.state["target"] == "camera"


def test_keys_with_a_modifier_or_in_a_field_are_not_ours(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    for modifier in (CTRL, META, ALT):
        for key, (code, _) in KEYS.items():
            view.press(code, key, modifiers=modifier)
    view.page.get_by_label("What", exact=True).focus()
    for key in ("ArrowUp", "ArrowLeft"):  # from its first entry, which these keys do not leave
        view.page.keyboard.press(key)
    view.page.evaluate("() => document.body.append(document.createElement('input'))")
    field = view.page.locator("body > input")
    field.focus()
    view.page.keyboard.type("crime")
    view.settle_messages()
    expect(field).to_have_value("crime")
    assert view.sent == []
    assert view.state["target"] == "camera"


def test_a_button_that_was_clicked_does_not_take_the_next_key_twice(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open()
    view.page.get_by_role("button", name="Left", exact=True).click()
    view.settle_messages()
    assert [message["right"] for message in view.sent] == [-STEP]
    view.page.keyboard.press("m")
    view.page.get_by_role("checkbox", name="Walls").click()
    view.page.keyboard.press("l")
    view.settle_messages()
    assert [message["type"] for message in view.sent[1:]] == ["toggle_mirror", "toggle_walls", "toggle_environment"]


def axes(scene: Scene) -> dict[str, Vector]:
    """Right, up and forward of the picture."""
    camera = scene["camera"]
    forward = np.subtract(camera["target"], camera["position"])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera["up"])
    right /= np.linalg.norm(right)
    return {"right": right, "up": np.cross(right, forward), "forward": forward}


MOVES = {
    "ArrowLeft": ("right", -STEP),
    "ArrowRight": ("right", STEP),
    "ArrowUp": ("up", STEP),
    "ArrowDown": ("up", -STEP),
    "i": ("forward", STEP),
    "o": ("forward", -STEP),
}

SEEN = 0.4
"""Mean difference, of 255, that an edit must make. Measured: a light moved by half an R 1.1 to 2.3, the rest 10 to 81;
two finished pictures of one scene differ by 0."""


def point_lights(scene: Scene) -> list[Any]:
    """The emitters that lights 1 and 2 are."""
    return [emitter for emitter in scene["emitters"] if emitter["shape"] == "point"]


PLACES: dict[str, Callable[[Scene], Any]] = {
    "camera": lambda scene: scene["camera"]["position"],
    "light_1": lambda scene: point_lights(scene)[0]["position"],
    "light_2": lambda scene: point_lights(scene)[1]["position"],
}


def test_moves_go_half_r_along_the_axes_of_the_picture(view: View, server: Server) -> None:
    """The camera's, each way; the lights', one way along each axis."""
    for target, chosen_by, keys in (
        ("camera", "c", tuple(MOVES)),
        ("light_1", "1", ("ArrowLeft", "ArrowUp", "i")),
        ("light_2", "2", ("ArrowRight", "ArrowDown", "o")),
    ):
        view.page.keyboard.press(chosen_by)
        for key in keys:
            axis, length = MOVES[key]
            start = view.scene
            before, after = view.change_by(key)
            scene = server.session(view.session)["scene"]
            assert scene == view.scene, "the page knows what the engine has"
            for name, place in PLACES.items():
                shift = length * axes(start)[axis] if name == target else np.zeros(3)
                np.testing.assert_allclose(place(scene), place(start) + shift, atol=1e-9, err_msg=f"{name} by {key}")
            assert difference(before.pixels, after.pixels) > SEEN, (target, key)


def test_switches_go_there_and_back_and_walls_and_floor_become_mirrors_together(view: View, server: Server) -> None:
    start = view.at_rest()
    for key, part, kinds in (
        ("m", "floor", ["mirror", "matte"]),
        ("l", "environment", ["light", "studio"]),
        ("w", "walls", ["matte", "none"]),
    ):
        for kind in kinds:
            before, after = view.change_by(key)
            assert server.session(view.session)["scene"][part]["kind"] == kind
            assert view.scene[part]["kind"] == kind
            assert difference(before.pixels, after.pixels) > SEEN
        assert_same(view.look().pixels, start.pixels)
    view.change_by("w")
    view.change_by("m")
    assert (view.scene["floor"]["kind"], view.scene["walls"]["kind"]) == ("mirror", "mirror")


def test_f_brings_the_camera_back(view: View, server: Server) -> None:
    start = view.at_rest()
    camera = view.scene["camera"]
    for key in ("ArrowLeft", "i"):
        view.change_by(key)
    assert view.scene["camera"] != camera
    before, after = view.change_by("f")
    assert server.session(view.session)["scene"]["camera"] == camera
    assert difference(before.pixels, after.pixels) > SEEN
    assert_same(after.pixels, start.pixels)


def test_p_starts_and_pauses_the_fall_and_r_puts_the_stone_back(view_of: ViewOf, server: Server) -> None:
    view = bouncing_in(view_of, server)
    start = view.at_rest()
    view.page.keyboard.press("p")
    view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.4")
    assert server.session(view.session)["falling"]
    view.page.keyboard.press("p")
    view.until("() => !culet.state.falling")
    paused = view.at_rest(after=start.frame["step"])
    assert not server.session(view.session)["falling"]
    assert paused.frame["simulationTime"] > 0.4
    assert difference(paused.pixels, start.pixels) > SEEN
    view.page.keyboard.press("p")
    view.until("time => culet.lastFrame.simulationTime > time", paused.frame["simulationTime"])
    view.page.keyboard.press("r")
    view.until("() => !culet.state.falling && culet.lastFrame.simulationTime === 0")
    assert_same(view.at_rest(after=paused.frame["step"]).pixels, start.pixels)

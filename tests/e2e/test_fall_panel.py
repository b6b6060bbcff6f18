"""The sliders of the fall: they act on the stone that falls, and every page on the session follows."""

from __future__ import annotations

import pytest

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View

TYPE_AND_PAUSE = """(box, value) => {
  box.value = value;
  box.dispatchEvent(new Event("change"));
  requestAnimationFrame(() => window.dispatchEvent(new KeyboardEvent("keydown", { code: "KeyP", key: "p" })));
}"""
"""The key as soon as the number is sent, so that no time passes between."""


@pytest.fixture
def falling(view_of: ViewOf, server: Server) -> View:
    """A page with the folder open, on a stone that bounces for ever."""
    lively = {"restitution": 1, "tangential_damping": 1, "angular_damping": 1, "random_torque": 0}
    scene = {"floor": {"kind": "matte"}, "simulation": lively}
    session = server.http.post("/api/sessions", json={"scene": scene}).json()["id"]
    view = with_fall(view_of, session)
    view.page.keyboard.press("p")
    view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.1")
    return view


def with_fall(view_of: ViewOf, session: str) -> View:
    view = view_of(viewport=WITH_PANEL).open(f"?session={session}")
    view.page.locator("#panel").get_by_role("button", name="Fall").click()
    return view


def shown(view: View, label: str) -> float:
    return float(view.page.get_by_role("spinbutton", name=label).input_value())


def test_a_slider_acts_on_the_falling_stone_and_on_every_page(view_of: ViewOf, falling: View, server: Server) -> None:
    guest = with_fall(view_of, falling.session)
    falling.record()
    falling.drag_slider("Gravity", 0.3, 0.5, 0.1)
    falling.drag_slider("Friction", 0.25)
    falling.until_told()
    falling.until("before => culet.framesShown > before + 3", falling.number("framesShown"))
    simulation = server.session(falling.session)["scene"]["simulation"]
    assert simulation["gravity"] == pytest.approx(3, abs=0.5)  # a pixel of the slider is 0.45
    assert simulation["friction"] == pytest.approx(0.5, abs=0.04)  # likewise 0.03
    assert shown(falling, "Gravity") == pytest.approx(simulation["gravity"], abs=0.005)
    guest.until("friction => culet.state.scene.simulation.friction === friction", simulation["friction"])
    assert shown(guest, "Gravity") == shown(falling, "Gravity")
    assert shown(guest, "Friction") == shown(falling, "Friction")
    times = [frame["simulationTime"] for frame in falling.recorded]
    assert times == sorted(times), "it was put back"
    assert falling.state["falling"]
    assert {message["type"] for message in falling.sent[1:]} == {"patch_scene"}
    assert falling.problems == guest.problems == []


def test_another_drop_height_or_spin_drops_the_stone_from_there(falling: View, server: Server) -> None:
    before = server.session(falling.session)["scene"]
    falling.drag_slider("Drop height", 0.5)
    falling.until_told()
    falling.drag_slider("Spin", 0, 0.5)
    falling.until_told()
    after = server.session(falling.session)["scene"]
    x, y, z = after["stones"][0]["position"]
    assert y == pytest.approx(4, abs=0.15)  # a pixel is 0.12
    stone, spin = before["stones"][0], after["stones"][0]["spin"]
    assert (x, z) == (stone["position"][0], stone["position"][2])
    assert after["stones"] == [stone | {"position": [x, y, z], "spin": spin}]
    about = [component / stone["spin"][1] for component in stone["spin"]]
    assert spin == pytest.approx([spin[1] * part for part in about])
    assert falling.state["falling"]
    falling.until("() => culet.lastFrame.simulationTime > 1")
    falling.page.get_by_role("spinbutton", name="Spin").evaluate(TYPE_AND_PAUSE, 5)
    falling.until("() => !culet.state.falling")
    began = falling.at_rest(after=falling.until_told() - 1).frame["simulationTime"]
    assert began < 1, "it began anew"
    falling.page.keyboard.press("p")
    falling.until("began => culet.lastFrame.simulationTime > began + 0.1", began)
    assert falling.problems == []


def test_integrator_and_model_are_chosen_and_what_a_model_does_not_know_is_grey(falling: View, server: Server) -> None:
    integrator = falling.page.get_by_label("Integrator")
    friction = falling.page.get_by_role("slider", name="Friction")
    integrator.select_option("midpoint")
    falling.until("() => culet.state.scene.simulation.integrator === 'midpoint'")
    falling.page.get_by_label("Model").select_option("the report's")
    falling.until("() => culet.state.scene.simulation.model === 'classic'")
    assert integrator.is_disabled()
    assert friction.is_disabled()
    simulation = server.session(falling.session)["scene"]["simulation"]
    assert (simulation["integrator"], simulation["model"]) == ("midpoint", "classic")
    falling.page.keyboard.press("m")  # the lists have not kept the keyboard
    falling.until("() => culet.state.mirror")
    assert falling.problems == []


def test_a_merge_patch_by_rest_moves_the_sliders(falling: View, server: Server) -> None:
    patch = {"simulation": {"gravity": 100.5, "restitution": 0.25}}
    assert server.http.patch(f"/api/sessions/{falling.session}", json=patch).status_code == 200
    falling.until("() => culet.state.scene.simulation.gravity === 100.5")
    assert shown(falling, "Gravity") == 100.5  # beyond the slider's end
    assert shown(falling, "Restitution") == 0.25
    assert falling.state["falling"]

"""Material, sky and optics by the panel's lists: the picture follows, and the rest of the scene stays."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import expect

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import Pixels, View, difference

SEEN = 1
"""Mean difference, of 255, that a choice must make. Measured: 2.7 to 60."""


@pytest.fixture
def wide_view(view_of: ViewOf) -> View:
    """With the panel."""
    return view_of(viewport=WITH_PANEL).open()


def choose(view: View, label: str, option: str) -> None:
    view.page.get_by_label(label, exact=True).select_option(label=option)


def magenta(pixels: Pixels) -> float:
    """Part of the picture that is of that colour."""
    red, green, blue = (pixels[..., channel] for channel in range(3))
    return float(((red > 200) & (blue > 200) & (green < 60)).mean())


def test_the_stone_is_made_of_what_one_chooses(wide_view: View, server: Server) -> None:
    view = wide_view
    stone = view.scene["stones"][0]
    before, after = view.change(lambda: choose(view, "Material", "Ruby"))
    assert server.session(view.session)["scene"]["stones"] == [stone | {"material": "ruby"}]
    assert difference(before.pixels, after.pixels) > SEEN
    view.change_by("m")  # the list has not kept the keyboard
    expect(view.page.get_by_label("Material", exact=True)).to_have_value("ruby")


def test_the_words_about_a_choice_are_of_what_is_chosen_and_end_with_its_use(wide_view: View) -> None:
    view = wide_view
    words = view.page.locator("#panel .hint")
    choose(view, "Material", "Ruby")
    expect(words).to_contain_text("Corundum coloured red")
    view.page.keyboard.press("Control+z")
    expect(words).not_to_contain_text("Corundum")
    choose(view, "Material", "Emerald")
    expect(words).to_be_visible()
    view.page.mouse.click(300, 400)
    expect(words).to_be_hidden()


def test_the_sky_is_one_of_the_studios_or_ones_own(wide_view: View, server: Server, tmp_path: Path) -> None:
    view = wide_view
    before, after = view.change(lambda: choose(view, "Sky", "Ring lights"))
    assert server.session(view.session)["scene"]["environment"]["image"] == "ring-lights"
    assert difference(before.pixels, after.pixels) > SEEN
    file = tmp_path / "magenta.png"
    Image.new("RGB", (64, 32), (255, 0, 255)).save(file)
    told: list[str] = []

    def open_the_sky() -> None:
        view.open_file("Open a sky", file)
        told.append(view.page.locator(".toast.finding").inner_text())  # now: it goes by itself

    without, under = view.change(open_the_sky)
    assert "64 \u00d7 32 pixels" in told[0]
    assert magenta(without.pixels) == 0
    assert magenta(under.pixels) > 0.01  # measured 0.035: through the stone, and above the horizon
    chosen = view.page.get_by_label("Sky", exact=True).evaluate("list => list.selectedOptions[0].textContent")
    assert chosen == "magenta.png"
    view.change(lambda: choose(view, "Sky", "studio lamps"))
    assert view.scene["environment"]["kind"] == "studio"
    view.change(lambda: choose(view, "Sky", "magenta.png"))
    assert view.scene["environment"]["kind"] == "image"


def test_a_sky_that_is_not_in_the_list_is_named_until_another_is_chosen(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open("?preset=sun")
    sky = view.page.get_by_label("Sky", exact=True)
    expect(sky).to_have_value("gradient")
    view.change(lambda: choose(view, "Sky", "studio lamps"))
    expect(sky.locator("option", has_text="gradient")).to_have_count(0)
    assert view.problems == []


def test_a_sky_is_seen_in_the_atelier_and_its_own_comes_back(view_of: ViewOf, server: Server) -> None:
    view = view_of(viewport=WITH_PANEL).open("")
    own = view.scene
    before, after = view.change(lambda: choose(view, "Sky", "light"))
    assert before.pixels[-1, 300].max() < 100 < 150 < after.pixels[-1, 300].min()  # beside the stone
    view.change(lambda: choose(view, "Sky", "Light box"))
    assert (view.scene["backdrop"]["kind"], view.scene["floor"]["kind"]) == ("none", "none")
    view.change(lambda: choose(view, "Sky", "studio lamps"))
    assert server.session(view.session)["scene"] == own


def test_light_is_followed_as_one_chooses(wide_view: View, server: Server) -> None:
    view = wide_view
    view.page.get_by_role("button", name="Optics").click()

    def choose_all() -> None:  # and wait for a picture but once: each of these has a program of its own
        choose(view, "Tone map", "filmic")
        choose(view, "Cut-off", "0.001")
        choose(view, "Below it", "by chance")
        view.page.get_by_label("Polarised").click()
        choose(view, "Bands", "8")

    view.change(choose_all)
    assert view.scene["optics"]["bands"] == 8
    scene = server.session(view.session)["scene"]
    chosen = {"bands": 8, "polarised": True, "cutoff": 0.001, "end": "roulette"}
    assert scene["optics"] | chosen == scene["optics"]
    assert scene["film"]["tone_map"] == "filmic"
    view.until("() => document.getElementById('status').textContent.includes('error 0.')")
    assert view.problems == []


def test_every_choice_is_explained(wide_view: View) -> None:
    for label in ("Material", "Below it", "Tone map", "Integrator"):
        options = wide_view.page.locator(".control", has_text=label).locator("option")
        options.first.wait_for(state="attached")
        titles = options.evaluate_all("options => options.map(({title}) => title)")
        assert titles
        assert all(titles), label

"""The sliders of the cut's proportions and of the stone's size: the stone follows, and the rest of the scene stays."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.test_accessibility import violations
from e2e.view import View, difference

SEEN = 1
"""Mean difference, of 255, that a change must make. Measured: 4.1 (pavilion), 1.7 (size)."""
TETRAHEDRON = "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.fixture
def wide_view(view_of: ViewOf) -> View:
    """With the panel, and the folder open."""
    view = view_of(viewport=WITH_PANEL).open()
    view.page.get_by_role("button", name="Cut").click()
    return view


def type_in(view: View, label: str, value: str) -> None:
    box = view.page.get_by_role("spinbutton", name=label, exact=True)
    box.fill(value)
    box.press("Enter")


def test_the_sliders_are_the_proportions_that_the_server_lists(wide_view: View, server: Server) -> None:
    cut = server.http.get("/api/cuts").json()["cuts"][0]
    numbers = [schema for schema in cut["proportions"].values() if schema["type"] == "number"]
    boxes = wide_view.page.locator("#panel .section .section", has_text="Pavilion").get_by_role("spinbutton")
    expect(boxes).to_have_count(len(numbers))  # the server's lists come after the first picture
    assert [float(box.input_value()) for box in boxes.all()] == [schema["default"] for schema in numbers]


def test_a_proportion_cuts_the_stone_anew_and_leaves_the_others(wide_view: View, server: Server) -> None:
    view = wide_view
    stone = view.scene["stones"][0]
    before, after = view.change(lambda: type_in(view, "Pavilion, \u00b0", "44"))
    assert difference(before.pixels, after.pixels) > SEEN
    view.change(lambda: type_in(view, "Table, %", "60"))
    (now,) = server.session(view.session)["scene"]["stones"]
    assert {"pavilion_degrees": 44, "table_percent": 60}.items() <= now["cut"].items()
    assert now | {"cut": stone["cut"]} == stone
    view.change(lambda: view.page.get_by_role("button", name="The usual proportions").click())
    assert server.session(view.session)["scene"]["stones"] == [stone]
    expect(view.page.get_by_role("spinbutton", name="Pavilion, \u00b0")).to_have_value("40.75")
    assert view.problems == []


FULL = """box => {
  box.value = '-41.25';
  const style = getComputedStyle(box), pen = document.createElement('canvas').getContext('2d');
  pen.font = style.font;
  const room = box.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  return room - pen.measureText(box.value).width;
}"""


def test_a_box_has_room_for_the_longest_number(wide_view: View) -> None:
    assert wide_view.page.get_by_role("spinbutton", name="Pavilion, \u00b0").evaluate(FULL) >= 0


def test_a_kept_design_and_the_shown_one_are_changed_over_by_the_button_and_by_the_key(wide_view: View) -> None:
    view = wide_view
    pavilion = view.page.get_by_role("spinbutton", name="Pavilion, \u00b0")
    other = view.page.get_by_role("button", name="Show the kept design")
    view.page.get_by_role("button", name="Keep this design to compare").click()
    assert not other.is_visible()
    view.change(lambda: type_in(view, "Pavilion, \u00b0", "39"))
    view.change(lambda: view.page.keyboard.press("a"))  # Enter has left the number
    expect(pavilion).to_have_value("40.75")
    view.change(other.click)
    expect(pavilion).to_have_value("39")
    assert view.problems == []


def test_a_divider_has_the_kept_design_at_its_left_until_the_picture_changes(wide_view: View) -> None:
    view = wide_view
    page = view.page
    page.get_by_role("button", name="Keep this design to compare").click()
    before = view.change(lambda: type_in(view, "Pavilion, \u00b0", "44"))[0]
    page.get_by_role("button", name="Both, with a divider").click()
    kept = page.get_by_alt_text("The kept design")
    kept.wait_for()  # that is seen
    height, width, _ = before.pixels.shape
    size = kept.evaluate("image => [image.naturalWidth, image.naturalHeight]")
    assert size == pytest.approx([width, height], abs=3)  # of the shape that a frame in motion may have
    divider = page.get_by_role("slider", name="Divider")
    left = kept.evaluate("image => getComputedStyle(image).clipPath")
    divider.press("ArrowRight")
    expect(divider).to_have_value("51")
    assert kept.evaluate("image => getComputedStyle(image).clipPath") != left
    assert violations(view) == []
    view.change_by("o")  # as for any other picture
    kept.wait_for()
    page.keyboard.press("d")
    expect(divider).to_have_count(0)
    assert view.problems == []


def test_each_tier_has_a_slider_between_the_ends_at_which_meets_are_kept(wide_view: View, server: Server) -> None:
    view = wide_view
    page = view.page
    page.get_by_role("button", name="Crown angles").click()
    page.get_by_role("button", name="Pavilion angles").click()
    main = page.get_by_role("spinbutton", name="main", exact=True)
    expect(main).to_have_value("40.75")
    expect(page.get_by_role("spinbutton", name="kite", exact=True)).to_have_value("34.5")
    assert violations(view) == []
    with page.expect_response(lambda answer: "reach=7" in answer.url) as answered:  # not of a row under the pointer
        main.focus()
    (tier,) = (each for each in answered.value.json()["tiers"] if each["names"] == ["main"])
    slider = page.get_by_role("slider", name="main", exact=True)
    view.until(f"() => [...document.querySelectorAll('.tier input')].some(box => box.max === '{tier['most']}')")
    expect(slider).to_have_attribute("min", str(tier["least"]))
    slider.focus()
    before, after = view.change(lambda: page.keyboard.press("End"))
    assert difference(before.pixels, after.pixels) > 0
    (now,) = server.session(view.session)["scene"]["stones"]
    assert list(now["recut"]["angles"]) == [str(tier["tier"])]
    assert tier["most"] - 0.05 <= now["recut"]["angles"][str(tier["tier"])] <= tier["most"]
    view.change(lambda: page.keyboard.press("Control+z"))
    view.until("() => culet.state.scene.stones[0].recut === null")
    assert server.session(view.session)["scene"] == view.scene
    expect(main).to_have_value("40.75")
    assert view.problems == []


def test_a_refused_angle_is_said_beside_its_slider_and_is_not_taken(wide_view: View, server: Server) -> None:
    view = wide_view
    page = view.page
    view.refusals.add(503)
    page.route("**/tiers?*reach=*", lambda route: route.fulfill(status=503))  # the ends at which meets are kept
    page.get_by_role("button", name="Pavilion angles").click()
    type_in(view, "main", "55")
    refusal = page.locator(".refusal:visible")
    refusal.wait_for()
    assert "expected angles that keep all meets and facets, as far as" in refusal.inner_text()
    assert page.locator(".toast.problem").count() == 0
    assert server.session(view.session)["scene"]["stones"][0]["recut"] is None
    view.until("() => [...document.querySelectorAll('.tier input')].some(box => box.value === '40.75')")
    view.change(lambda: type_in(view, "main", "41"))
    refusal.wait_for(state="hidden")
    view.change(lambda: page.get_by_role("button", name="These angles as they were").click())
    expect(page.get_by_role("spinbutton", name="main", exact=True)).to_have_value("40.75")


def test_a_mesh_has_no_proportions_and_gives_way_to_a_cut(wide_view: View, server: Server, tmp_path: Path) -> None:
    view = wide_view
    file = tmp_path / "tetrahedron.obj"
    file.write_text(TETRAHEDRON)
    shape, pavilion = view.page.get_by_label("Shape"), view.page.get_by_role("spinbutton", name="Pavilion, \u00b0")
    view.change(lambda: view.open_file("Open a mesh", file))
    assert not pavilion.is_visible()
    expect(shape).to_have_value("A file's")
    before, after = view.change(lambda: shape.select_option(label="Emerald cut"))
    assert difference(before.pixels, after.pixels) > SEEN
    expect(pavilion).to_have_value("56")
    view.change(lambda: type_in(view, "Pavilion steps", "2"))
    (stone,) = server.session(view.session)["scene"]["stones"]
    assert stone["mesh"] is None
    assert {"name": "emerald", "pavilion_steps": 2}.items() <= stone["cut"].items()
    view.change(lambda: shape.select_option(label="Oval"))
    assert server.session(view.session)["scene"]["stones"][0]["cut"] == "oval"
    expect(pavilion.locator("visible=true")).to_have_value("41")
    assert view.problems == []


def test_a_coloured_stone_can_be_larger(wide_view: View, server: Server) -> None:
    view = wide_view
    size = view.page.get_by_role("spinbutton", name="Radius, mm")
    assert not size.is_visible()
    view.change(lambda: view.page.get_by_label("Material", exact=True).select_option(label="Sapphire"))
    expect(size).to_have_value("3.25")
    scene = view.scene
    before, after = view.change(lambda: type_in(view, "Radius, mm", "12"))
    assert server.session(view.session)["scene"] == scene | {"millimetres": 12}
    assert after.pixels.mean() < before.pixels.mean()
    assert difference(before.pixels, after.pixels) > SEEN

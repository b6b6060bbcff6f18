"""Grades and cutting diagrams by REST, of scenes and of sessions."""

from __future__ import annotations

import asyncio
import xml.etree.ElementTree as ET
from typing import Any

import httpx
import pytest

from gateway.running import Gateway
from gateway.test_rest import assert_problem

OVAL = {"millimetres": 5, "stones": [{"id": "a"}, {"id": "b", "cut": "oval", "position": [4, 0, 0]}]}


def text_of(drawing: str) -> str:
    """All words of an SVG file."""
    return "".join(ET.fromstring(drawing).itertext())  # noqa: S314 - the product's own


async def test_a_stone_of_a_scene_is_graded(gateway: Gateway) -> None:
    asked = {"scene": OVAL, "stone": "b", "convention": "gemray", "head_degrees": 15, "error": 1}
    answer = await gateway.http.post("/api/grade", json=asked)
    assert answer.status_code == 200, answer.text
    report = answer.json()
    assert report["stone"] == "b"
    assert report["rules"] == {"head_degrees": 15, "glare": "crown", "bounces": 9, "cutoff": 1e-3}
    assert 40 < report["grades"]["iso"]["value"] < 90
    assert 0 < 2 * report["grades"]["iso"]["error"] < 1
    assert report["grades"]["iso"]["bound"] > 1
    assert report["size"]["length"] / report["size"]["width"] == pytest.approx(1.4)
    assert report["size"]["length"] == pytest.approx(10, rel=0.02)  # R is 5 mm
    assert report["tilt"] is None
    assert report["done"] == 1


async def test_a_session_tells_grades_and_draws_the_diagram_of_what_it_shows(gateway: Gateway) -> None:
    session = (await gateway.http.post("/api/sessions", json={"scene": OVAL})).json()["id"]
    answer = await gateway.http.get(f"/api/sessions/{session}/grade", params={"error": 1, "tilt": True})
    assert answer.status_code == 200, answer.text
    report = answer.json()
    assert report["stone"] == "a"
    assert [point["degrees"] for point in report["tilt"]["x"]] == list(range(-90, 91, 5))
    drawing = await gateway.http.get(f"/api/sessions/{session}/diagram.svg", params={"stone": "b"})
    assert drawing.headers["content-type"].startswith("image/svg+xml")
    words = text_of(drawing.text)
    assert "Oval" in words
    assert "mm, " in words
    assert " ct at 3.5" in words
    await gateway.http.delete(f"/api/sessions/{session}")


async def test_a_stone_of_a_scene_has_a_diagram(gateway: Gateway) -> None:
    scene = {"stones": [{"cut": {"name": "princess", "chevrons": 4}}]}
    drawing = await gateway.http.post("/api/design/diagram.svg", json={"scene": scene})
    assert drawing.status_code == 200, drawing.text
    assert "chevron" in text_of(drawing.text)


async def test_a_stone_of_a_scene_or_a_session_tells_its_proportions_as_it_is_cut_anew(gateway: Gateway) -> None:
    scene = {"stones": [{"id": "a", "recut": {"table_percent": 61.5, "girdle_percent": 4}}]}
    told = await gateway.http.post("/api/design/proportions", json={"scene": scene})
    assert told.status_code == 200, told.text
    assert told.json()["table_percent"] == pytest.approx(61.5)
    assert told.json()["girdle_percent"] == pytest.approx(4)
    session = (await gateway.http.post("/api/sessions", json={"scene": scene})).json()["id"]
    patch = {"stones": {"a": {"recut": {"crown_ratio": 1.1}}}}
    assert (await gateway.http.patch(f"/api/sessions/{session}", json=patch)).status_code == 200
    steeper = (await gateway.http.get(f"/api/sessions/{session}/proportions")).json()
    assert steeper["table_percent"] == pytest.approx(61.5)
    assert steeper["crown_percent"] > told.json()["crown_percent"]
    wide = {"stones": {"a": {"recut": {"girdle_percent": 0.001, "crown_ratio": 7}}}}
    assert_problem(await gateway.http.patch(f"/api/sessions/{session}", json=wide), 422, "stones.a.recut.crown_ratio")
    await gateway.http.delete(f"/api/sessions/{session}")


async def test_a_session_lists_tiers_with_the_ends_between_which_their_angles_may_be(gateway: Gateway) -> None:
    session = await gateway.session({"stones": [{"id": "a"}]})
    tiers = f"/api/sessions/{session}/tiers"

    async def main_of(**asked: str | int) -> dict[str, Any]:
        listed = (await gateway.http.get(tiers, params=asked)).json()["tiers"]
        found: dict[str, Any] = next(tier for tier in listed if tier["names"] == ["main"])
        return found

    main = await main_of()
    assert (main["side"], main["facets"], main["independent"]) == ("pavilion", 8, True)
    near = await main_of(reach=main["tier"])
    assert main["least"] < near["least"] < near["degrees"] < near["most"] < main["most"]

    async def turned(degrees: float) -> httpx.Response:
        patch = {"stones": {"a": {"recut": {"angles": {str(main["tier"]): degrees}}}}}
        return await gateway.http.patch(f"/api/sessions/{session}", json=patch)

    assert (await turned(near["most"])).status_code == 200
    assert (await main_of(stone="a"))["degrees"] == pytest.approx(near["most"])
    assert_problem(await turned(main["most"]), 422, "stones.0.recut.angles")
    assert_problem(await gateway.http.get(tiers, params={"reach": 99}), 422, "angles")
    assert_problem(await gateway.http.get(tiers, params={"stone": "b"}), 422, "stone")
    heart = {"scene": {"stones": [{"cut": "heart"}]}}
    assert_problem(await gateway.http.post("/api/design/tiers", json=heart), 422, "angles")


async def test_a_client_is_graded_one_stone_at_a_time(gateway: Gateway) -> None:
    async def grade() -> int:
        return (await gateway.http.post("/api/grade", json={"stone": "x"})).status_code

    assert await grade() == 422, "the engine has what it needs to answer at once"
    async with gateway.parts.grades.turn("127.0.0.1"):
        second = asyncio.create_task(grade())
        for _ in range(5):  # longer than the engine takes to refuse
            assert (await gateway.http.post("/api/design/diagram.svg", json={})).status_code == 200
        while len(gateway.parts.stills) == 0 and not second.done():  # noqa: ASYNC110 - the request is a task of its own
            await asyncio.sleep(0.01)
        assert not second.done(), "it has a place, and waits"
    assert await second == 422


async def test_a_client_has_one_design_cut_at_a_time(gateway: Gateway) -> None:
    """As the other one of a comparison, or for a tier's reach: both may take the engine seconds."""
    session = f"/api/sessions/{await gateway.session({'stones': [{'id': 'a'}]})}"

    async def asked() -> list[int]:
        beside = gateway.http.post(f"{session}/beside", json={"stone": "b", "design": {}})
        reach = gateway.http.get(f"{session}/tiers", params={"stone": "b", "reach": 4})
        return [answer.status_code for answer in await asyncio.gather(beside, reach)]

    assert await asked() == [422, 422], "the engine has what it needs to answer at once"
    async with gateway.parts.designs.turn("127.0.0.1"):
        both = asyncio.create_task(asked())
        while len(gateway.parts.stills) < 2 and not both.done():  # noqa: ASYNC110 - each request is a task of its own
            await asyncio.sleep(0.01)
        for _ in range(5):  # longer than the engine takes to refuse
            assert (await gateway.http.get(f"{session}/tiers")).status_code == 200, "the usual ends need no turn"
        assert len(gateway.parts.stills) == 2, "both have places, and wait"
        (record,) = (record for record in gateway.parts.sessions if record.id in session)
        assert record.asked == 2, "it does not expire meanwhile"
    assert await both == [422, 422]
    assert record.asked == 0


async def test_what_cannot_be_graded_or_drawn_is_a_problem(gateway: Gateway) -> None:
    post = gateway.http.post
    assert_problem(await post("/api/grade", json={"stone": "x"}), 422, "stone")
    assert_problem(await post("/api/grade", json={"scene": {"stones": []}}), 422, "stone")
    assert_problem(await post("/api/grade", json={"error": 0}), 422, "error")
    assert_problem(await post("/api/grade", json={"convention": "agl"}), 422, "convention")
    heart = {"scene": {"stones": [{"cut": "heart"}]}}
    assert_problem(await post("/api/grade", json=heart), 422)
    assert_problem(await post("/api/design/diagram.svg", json=heart), 422)
    flat = {"scene": {"stones": [{"cut": {"name": "trillion", "table_percent": 88}}]}}
    assert_problem(await post("/api/design/diagram.svg", json=flat), 422, "stones.0.cut.table_percent")
    assert_problem(await gateway.http.get("/api/sessions/nobody/grade"), 404)
    assert_problem(await gateway.http.get("/api/sessions/nobody/diagram.svg"), 404)

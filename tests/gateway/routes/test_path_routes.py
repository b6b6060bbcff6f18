"""One ray by REST, of scenes and of sessions."""

from __future__ import annotations

from typing import Any

import pytest

from gateway.running import Gateway
from gateway.test_rest import assert_problem

PIXEL = {"x": 48, "y": 27, "width": 96, "height": 54}


async def test_the_light_of_a_pixel_of_a_scene_is_told(gateway: Gateway) -> None:
    answer = await gateway.http.post("/api/path", json={"pixel": PIXEL})
    assert answer.status_code == 200, answer.text
    path = answer.json()
    assert path["pixel"] == [48, 27, 96, 54]
    assert [chain["channel"] for chain in path["chains"]] == ["red", "green", "blue"]
    first = path["steps"][0]
    assert (first["kind"], first["stone"], first["parent"]) == ("enters", "stone", None)
    assert first["facet_name"]
    assert sum(part["share"] for part in path["parts"]) == pytest.approx(1)


async def test_a_session_tells_the_light_of_what_it_shows(gateway: Gateway) -> None:
    scene = {"stones": [{"id": "a", "position": [0, -0.37, 0], "material": "bk7"}]}
    session = (await gateway.http.post("/api/sessions", json={"scene": scene})).json()["id"]
    there = f"/api/sessions/{session}/path"
    answer = await gateway.http.get(there, params=PIXEL)
    assert answer.status_code == 200, answer.text
    seen = answer.json()
    assert seen["poses"]["a"]["position"] == pytest.approx([0, -0.37, 0])
    ray = {"origin": seen["origin"], "direction": seen["direction"]}
    again = (await gateway.http.post(there, json={"ray": ray, "wavelengths": [589.3]})).json()
    assert again["pixel"] is None
    assert again["chains"][0]["indices"]["a"] == pytest.approx(1.5168, abs=1e-4)  # BK7 at the sodium line
    facets = [(step["kind"], step["facet"]) for step in again["steps"][:2]]
    assert facets == [(step["kind"], step["facet"]) for step in seen["steps"][:2]]
    await gateway.http.delete(f"/api/sessions/{session}")
    assert_problem(await gateway.http.get(there, params=PIXEL), 404)


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({}, None),
        ({"pixel": PIXEL, "ray": {"origin": [0, 0, 5], "direction": [0, 0, -1]}}, None),
        ({"pixel": {**PIXEL, "x": 96}}, "pixel"),
        ({"pixel": {**PIXEL, "width": 0}}, "pixel.width"),
        ({"ray": {"origin": [0, 0, 5], "direction": [0, 0, 0]}}, "ray.direction"),
        ({"pixel": PIXEL, "wavelengths": [200]}, "wavelengths.0"),
        ({"pixel": PIXEL, "scene": {"optics": {"estimator": "classic"}}}, "optics.estimator"),
    ],
)
async def test_what_is_no_ray_is_a_problem(gateway: Gateway, asked: dict[str, Any], field: str | None) -> None:
    answer = await gateway.http.post("/api/path", json=asked)
    assert_problem(answer, 422, *([field] if field else []))

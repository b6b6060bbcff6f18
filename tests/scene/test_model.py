"""The scene: its default, its journey through JSON, and what it refuses."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from culet.errors import InputError, SceneError
from culet.optics.dispersion import channel_indices
from culet.scene import PRESETS, Scene

DEFAULT = json.loads((Path(__file__).parent / "default.json").read_text())
"""The default scene, written out. Change it here when the default is meant to change."""

FULL: dict[str, Any] = {
    **DEFAULT,
    "stones": [
        {
            **DEFAULT["stones"][0],
            "cut": {"name": "brilliant", "table_percent": 57, "crown_degrees": 34, "pavilion_degrees": 41},
            "mesh": "0123abcd",
            "material": {"sellmeier": [[0.3306, 0.175], [4.3356, 0.106]]},
            "absorption": [1, 2, 3],
            "scale": 1.25,
            "velocity": [0, 1, 0],
            "spin": [1, 2, 3],
            "density": 4000,
            "restitution": 0.5,
            "friction": 0.1,
        }
    ],
    "millimetres": 3.2,
    "emitters": [
        *DEFAULT["emitters"][:-1],
        {"shape": "sun", "direction": [1, 2, 3], "colour": [1, 0.9, 0.8], "half_angle_degrees": 0.3, "softness": 0.5},
        {"shape": "point", "position": [4, 6, 4], "colour": [0.2, 0.5, 1]},
    ],
}
"""A scene that says everything it can say."""


def test_nothing_is_the_default_scene_written_out() -> None:
    assert Scene.read({}) == Scene()
    assert json.loads(Scene().model_dump_json()) == DEFAULT
    assert Scene.read(DEFAULT) == Scene()


@pytest.mark.parametrize("name", PRESETS)
def test_a_scene_survives_json(name: str) -> None:
    scene = PRESETS[name].scene
    assert Scene.read(json.loads(scene.model_dump_json())) == scene
    assert Scene.model_validate_json(scene.model_dump_json()) == scene


def test_a_scene_that_says_everything_survives_json() -> None:
    scene = Scene.read(FULL)
    again = json.loads(scene.model_dump_json())
    assert Scene.read(again) == scene
    assert again["stones"][0]["material"] == FULL["stones"][0]["material"]
    assert again["stones"][0]["cut"]["table_percent"] == 57


def test_a_scene_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="frozen"):
        setattr(Scene().camera, "fov_degrees", 3)  # noqa: B010 - a plain assignment is what mypy would refuse


def test_an_orientation_is_normalised_once() -> None:
    q = Scene.read({"stones": [{"orientation": [2, 0, 0, 2]}]}).stones[0].orientation
    assert q == pytest.approx((math.sqrt(0.5), 0, 0, math.sqrt(0.5)), abs=3e-16)
    assert Scene.read({"stones": [{"orientation": q}]}).stones[0].orientation == q


LAMP: dict[str, Any] = {"shape": "round", "direction": [0, 1, 0], "half_angle_degrees": 3, "radiance": [1, 1, 1]}
POINT: dict[str, Any] = {"shape": "point", "position": [0, 9, 0], "colour": [1, 1, 1]}
BAD: dict[str, tuple[Any, str | None, str]] = {
    "unknown key": ({"colour": 1}, "colour", "unknown field; there are: backdrop, camera, emitters, environment,"),
    "misspelt key": ({"stonez": []}, "stonez", "unknown field; did you mean `stones`"),
    "misspelt nested key": ({"camera": {"fow_degrees": 3}}, "camera.fow_degrees", "mean `fov_degrees`"),
    "misspelt key of a list": ({"stones": [{"materiel": "ruby"}]}, "stones.0.materiel", "mean `material`"),
    "misspelt key of a form": ({"stones": [{"cut": {"table": 60}}]}, "stones.0.cut.table", "mean `table_percent`"),
    "another sky's key": (
        {"environment": {"kind": "light", "scale": 2}}, "environment.scale", "unknown field; there are: kind$",
    ),
    "no object": ([], None, "scene: expected an object; got \\[\\]"),
    "null": (None, None, "scene: .*; got None"),
    "a later version": ({"version": 3}, "version", "expected 2; got 3"),
    "no version": ({"version": None}, "version", "expected 2; got None"),
    "field of view 0": ({"camera": {"fov_degrees": 0}}, "camera.fov_degrees", "0.001; got 0"),
    "field of view 180": ({"camera": {"fov_degrees": 180}}, "camera.fov_degrees", "170; got 180"),
    "up along the sight": ({"camera": {"position": [0, 3, 0], "target": [0, 0, 0]}}, "camera", "up is parallel"),
    "up of no length": ({"camera": {"up": [0, 0, 0]}}, "camera", "up has length 0"),
    "nowhere to look": ({"camera": {"position": [1, 1, 1], "target": [1, 1, 1]}}, "camera", "looks nowhere"),
    "two coordinates": ({"camera": {"position": [1, 2]}}, "camera.position.2", "expected a value"),
    "four coordinates": ({"camera": {"position": [1, 2, 3, 4]}}, "camera.position", "at most 3"),
    "text for a number": ({"camera": {"fov_degrees": "wide"}}, "camera.fov_degrees", "number.*; got 'wide'"),
    "65 stones": ({"stones": [{}] * 65}, "stones", "a list of at most 64; got a list of 65"),
    "an id twice": ({"stones": [{"id": "a"}, {}, {"id": "a"}]}, "stones.2.id", "not that of stone 0; got 'a'"),
    "an id in capitals": ({"stones": [{"id": "Ruby"}]}, "stones.0.id", "text that matches"),
    "an id with a space": ({"stones": [{"id": "my ruby"}]}, "stones.0.id", "text that matches"),
    "an id with a dot": ({"stones": [{"id": "a.b"}]}, "stones.0.id", "text that matches"),
    "an id from a dash": ({"stones": [{"id": "-a"}]}, "stones.0.id", "text that matches"),
    "an id of other letters": ({"stones": [{"id": "r\u00fcby"}]}, "stones.0.id", "text that matches"),
    "an id too long": ({"stones": [{"id": "a" * 33}]}, "stones.0.id", "text that matches"),
    "an id with a line's end": ({"stones": [{"id": "a\n"}]}, "stones.0.id", "text that matches"),
    "an empty id": ({"stones": [{"id": ""}]}, "stones.0.id", "text that matches"),
    "an id by number": ({"stones": [{"id": 7}]}, "stones.0.id", "expected a string; got 7"),
    "scale 0": ({"stones": [{"scale": 0}]}, "stones.0.scale", "at least 0.01; got 0"),
    "scale 1e-9": ({"stones": [{"scale": 1e-9}]}, "stones.0.scale", "at least 0.01; got 1e-09"),
    "scale 1e9": ({"stones": [{"scale": 1e9}]}, "stones.0.scale", "at most 100; got 1000000000.0"),
    "density and mass": ({"stones": [{"density": 1, "mass": 1}]}, "stones.0", "a density or a mass, got both"),
    "unknown material": ({"stones": [{"material": "gold"}]}, "stones.0.material", "'classic'; got 'gold'"),
    "no material": ({"stones": [{"material": 5}]}, "stones.0.material", "`ior` or one with `sellmeier`; got 5"),
    "index below 1": ({"stones": [{"material": {"ior": [0.9, 1, 1]}}]}, "stones.0.material.ior.0", "1; got 0.9"),
    "index above 10": ({"stones": [{"material": {"ior": [1, 1, 11]}}]}, "stones.0.material.ior.2", "10; got 11"),
    "two materials": (
        {"stones": [{"material": {"ior": [2, 2, 2], "sellmeier": [[1, 0.1]]}}]},
        "stones.0.material.ior", "unknown field",
    ),
    "empty formula": ({"stones": [{"material": {"sellmeier": []}}]}, "stones.0.material.sellmeier", "at least 1"),
    "unknown cut": ({"stones": [{"cut": "cabochon"}]}, "stones.0.cut", "'baguette'; got 'cabochon'"),
    "proportions of an unknown cut": (
        {"stones": [{"cut": {"name": "cabochon"}}]}, "stones.0.cut.name", "a cut's name.*; got 'cabochon'",
    ),
    "cut by a number": ({"stones": [{"cut": 73}]}, "stones.0.cut", "a cut's name or its proportions.*; got 73"),
    "proportion of another cut": (
        {"stones": [{"cut": {"name": "rose", "table_percent": 50}}]}, "stones.0.cut.table_percent",
        "unknown field; did you mean `girdle_percent`",
    ),
    "half a chevron": (
        {"stones": [{"cut": {"name": "princess", "chevrons": 2.5}}]}, "stones.0.cut.chevrons", "whole number; got 2.5",
    ),
    "table too wide": ({"stones": [{"cut": {"table_percent": 101}}]}, "stones.0.cut.table_percent", "100; got 101"),
    "mesh by a path": ({"stones": [{"mesh": "../../etc/passwd"}]}, "stones.0.mesh", "text that matches"),
    "mesh by a file": ({"stones": [{"mesh": "stone.ply"}]}, "stones.0.mesh", "text that matches"),
    "negative absorption": ({"stones": [{"absorption": [0, -1, 0]}]}, "stones.0.absorption.1", "0; got -1"),
    "size 0": ({"millimetres": 0}, "millimetres", "expected greater than 0; got 0"),
    "no orientation": ({"stones": [{"orientation": [0, 0, 0, 0]}]}, "stones.0.orientation", "length 0"),
    "emitter of another shape": ({"emitters": [{"shape": "star"}]}, "emitters.0.shape", "'point'; got 'star'"),
    "emitter without a shape": ({"emitters": [{"colour": [1, 1, 1]}]}, "emitters.0.shape", "emitter of shape 'round'"),
    "box without a width": (
        {"emitters": [{"shape": "box", "direction": [0, 1, 0], "radiance": [1, 1, 1]}]},
        "emitters.0.half_width_degrees", "expected a value",
    ),
    "a round lamp's width": (
        {"emitters": [{**LAMP, "half_width_degrees": 3}]},
        "emitters.0.half_width_degrees", "did you mean `half_angle_degrees`?",
    ),
    "25 lamps": ({"emitters": [LAMP] * 25}, "emitters", r"at most 24 lamps in the sky \(round, box, sun\), got 25"),
    "a sun as large as a box": (
        {"emitters": [{"shape": "sun", "direction": [0, 1, 0], "colour": [1, 1, 1], "half_angle_degrees": 30}]},
        "emitters.0.half_angle_degrees", "at most 10; got 30",
    ),
    "gradient's colour": ({"backdrop": {"kind": "gradient", "colour": [1, 1, 1]}}, "backdrop.colour", "unknown field"),
    "unknown backdrop": ({"backdrop": {"kind": "curtain"}}, "backdrop.kind", "'gradient'; got 'curtain'"),
    "mirror's colour": ({"floor": {"kind": "mirror", "colour": [1] * 3}}, "floor.colour", "there are: albedo, checker"),
    "floor that gives more than it gets": (
        {"floor": {"kind": "matte", "albedo": [0.5, 1.1, 0.5]}}, "floor.albedo.1", "at most 1; got 1.1",
    ),
    "albedo without channels": ({"floor": {"kind": "matte", "albedo": 0.5}}, "floor.albedo", "a list; got 0.5"),
    "checker without cells": ({"walls": {"kind": "matte", "checker": {"cell": 0}}}, "walls.checker.cell", "at least"),
    "checker that is on": ({"floor": {"kind": "matte", "checker": "on"}}, "floor.checker", "'off' or a checker's"),
    "caustics by halves": ({"optics": {"caustics": "some"}}, "optics.caustics", "'on' or 'off'; got 'some'"),
    "caustics without end": ({"optics": {"caustics_cutoff": 0}}, "optics.caustics_cutoff", "0.000000001; got 0"),
    "head of no size": ({"head": {"half_angle_degrees": 0}}, "head.half_angle_degrees", "at least 0.1"),
    "picture of no height": ({"camera": {"kind": "orthographic", "height": 0}}, "camera.height", "at least"),
    "unknown floor": ({"floor": {"kind": "glossy"}}, "floor.kind", "'mirror' or 'studio'; got 'glossy'"),
    "floor by name": ({"floor": "mirror"}, "floor", "got 'mirror'"),
    "nine points": ({"emitters": [POINT] * 9}, "emitters", "at most 8 point lights, got 9"),
    "dark point": ({"emitters": [{**POINT, "colour": [1, 1, -1]}]}, "emitters.0.colour.2", "0; got -1"),
    "point nowhere": ({"emitters": [{"shape": "point", "colour": [1, 1, 1]}]}, "emitters.0.position", "expected a val"),
    "unknown sky": ({"environment": {"kind": "cloudy"}}, "environment.kind", "'studio'.*; got 'cloudy'"),
    "sky without a kind": ({"environment": {"radiance": [1, 1, 1]}}, "environment.kind", "expected a value"),
    "sky by name": ({"environment": "studio"}, "environment", "expected an object; got 'studio'"),
    "sky's colour": ({"environment": {"kind": "gradient", "top": [1, -2, 1]}}, "environment.top.1", "0; got -2"),
    "lamp nowhere": ({"emitters": [{**LAMP, "direction": [0, 0, 0]}]}, "emitters.0.direction", "points nowhere"),
    "cut-off 0": ({"optics": {"cutoff": 0}}, "optics.cutoff", "0.000000001; got 0"),
    "cut-off 1": ({"optics": {"cutoff": 1}}, "optics.cutoff", "less than 1; got 1"),
    "no bounces": ({"optics": {"max_bounces": 0}}, "optics.max_bounces", "1; got 0"),
    "half a bounce": ({"optics": {"max_bounces": 2.5}}, "optics.max_bounces", "expected a whole number; got 2.5"),
    "two bands": ({"optics": {"bands": 2}}, "optics.bands", "3; got 2"),
    "many bands": ({"optics": {"bands": "many"}}, "optics.bands", "'auto' or a whole number from 3 to 64; got 'many'"),
    "half a band": ({"optics": {"bands": 3.5}}, "optics.bands", "expected a whole number; got 3.5"),
    "no samples": ({"sampling": {"samples_per_pixel": 0}}, "sampling.samples_per_pixel", "1; got 0"),
    "exposure 0": ({"film": {"exposure": 0}}, "film.exposure", "greater than 0; got 0"),
    "unknown tone map": ({"film": {"tone_map": "aces"}}, "film.tone_map", "'none'; got 'aces'"),
    "restitution 2": ({"simulation": {"restitution": 2}}, "simulation.restitution", "1; got 2"),
    "negative gravity": ({"simulation": {"gravity": -1}}, "simulation.gravity", "0; got -1"),
    "massless": ({"stones": [{"mass": 0}]}, "stones.0.mass", "0.000000001; got 0"),
    "no time": ({"simulation": {"time_step": 0}}, "simulation.time_step", "0.0001; got 0"),
    "seed of no integer": ({"simulation": {"seed": 2**53}}, "simulation.seed", "got 9007199254740992"),
    "a number too large to be one": ({"camera": {"fov_degrees": 10**400}}, "camera.fov_degrees", "number"),
}  # fmt: skip


@pytest.mark.parametrize(("data", "field", "message"), BAD.values(), ids=BAD.keys())
def test_what_cannot_be_rendered_is_refused_with_its_field(data: Any, field: str | None, message: str) -> None:  # noqa: ANN401
    with pytest.raises(SceneError, match=message) as refusal:
        Scene.read(data)
    assert refusal.value.field == field
    assert str(refusal.value).startswith(f"{field or 'scene'}: ")
    assert isinstance(refusal.value, InputError)
    assert refusal.value.status == 422


def numeric_places(data: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:  # noqa: ANN401
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from numeric_places(value, (*path, key))
    elif isinstance(data, int | float):
        yield path


def put(data: Any, path: tuple[str | int, ...], value: object) -> Any:  # noqa: ANN401
    """A copy of JSON data with one value exchanged."""
    if not path:
        return value
    if isinstance(data, dict):
        return {key: put(item, path[1:], value) if key == path[0] else item for key, item in data.items()}
    return [put(item, path[1:], value) if index == path[0] else item for index, item in enumerate(data)]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf], ids=["NaN", "infinity", "-infinity"])
def test_nan_and_infinity_are_refused_in_every_number(value: float) -> None:
    """Of every field of every kind of sky and material; the refusal names the number, down to its place in a vector."""
    environments = [
        DEFAULT["environment"],
        {"kind": "constant", "radiance": [1, 1, 1]},
        {"kind": "half", "radiance": [1, 1, 1]},
        {"kind": "gradient", "bottom": [0, 0, 0], "top": [1, 1, 1]},
    ]
    materials = [{"ior": [1.7, 1.8, 1.9]}, FULL["stones"][0]["material"]]
    tried = 0
    for environment in environments:
        for material in materials:
            data = {**FULL, "environment": environment, "stones": [{**FULL["stones"][0], "material": material}]}
            Scene.read(data)
            for path in numeric_places(data):
                with pytest.raises(SceneError) as refusal:
                    Scene.read(put(data, path, value))
                assert refusal.value.field == ".".join(map(str, path))
                tried += 1
    assert tried > 500


def test_a_long_value_is_shown_short() -> None:
    with pytest.raises(SceneError) as refusal:
        Scene.read({"floor": {"kind": "x" * 10_000}})
    assert len(str(refusal.value)) < 200


def test_the_number_of_findings_is_told() -> None:
    with pytest.raises(SceneError, match=r"\(and 2 more\)$"):
        Scene.read({"floor": 1, "walls": 2, "film": 3})


def test_a_formula_without_an_index_is_refused_when_its_index_is_needed() -> None:
    scene = Scene.read({"stones": [{"material": {"sellmeier": [[-3, 0.1]]}}]})
    with pytest.raises(SceneError) as refusal:
        channel_indices(scene.stones[0].material)
    assert refusal.value.field == "stones.0.material.sellmeier"


def test_a_recut_that_changes_nothing_is_none() -> None:
    """As once tiers were turned and that was taken back; a proportion that is said stays."""
    taken_back = Scene.read({"stones": [{"id": "a", "recut": {"crown_ratio": 1, "angles": {}}}]})
    assert taken_back == Scene.read({"stones": [{"id": "a"}]})
    assert taken_back.stones[0].recut is None
    kept = Scene.read({"stones": [{"recut": {"girdle_percent": 3}}]}).stones[0].recut
    assert kept is not None
    assert kept.girdle_percent == 3


def test_moving_the_stone_moves_nothing_else() -> None:
    scene = Scene.read(FULL)
    moved = scene.moved(((1, 2, 3), (0, 1, 0, 0)))
    assert [*moved.stones[0].position, *moved.stones[0].orientation] == [1, 2, 3, 0, 1, 0, 0]
    assert moved.moved((scene.stones[0].position, scene.stones[0].orientation)) == scene
    assert Scene(stones=()).moved() == Scene(stones=())


@pytest.mark.parametrize(("called", "name"), [("glass", "bk7"), ("CZ", "cubic-zirconia"), ("Diamond", "diamond")])
def test_a_material_is_found_by_what_people_call_it(called: str, name: str) -> None:
    assert Scene.read({"stones": [{"material": called}]}).stones[0].material == name

"""Scenes of version 1: what they said is what version 2 shows."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from culet.errors import SceneError
from culet.rendering.chains import absorption, chain_table
from culet.rendering.room.sky_colours import sky_colours
from culet.scene import PRESETS, Scene
from culet.scene.emitters import boxes, discs
from culet.scene.optics import SPECTRAL_AT_REST, Optics
from culet.scene.room import Plane

FIRST: dict[str, Any] = json.loads((Path(__file__).parent / "presets_of_version_1.json").read_text())
"""Every preset as version 1 of the scene wrote it out."""
LIGHT = {"position": [0, 9, 0], "colour": [1, 2, 3]}


def of_1(**fields: Any) -> Scene:  # noqa: ANN401
    return Scene.read({"version": 1, **fields})


@pytest.mark.parametrize("name", FIRST)
def test_every_preset_of_version_1_is_the_preset_of_its_name(name: str) -> None:
    """But for the mass, which was 2 for all stones and is now, but in the report's scenes, that of their material; and
    for a matte floor's albedo and wavelengths by themselves, which version 1 could not say."""
    read, preset = Scene.read(FIRST[name]), PRESETS[name].scene
    if name == "matte":
        preset = preset.model_copy(update={"floor": Plane(kind="matte")})
    if preset.optics == SPECTRAL_AT_REST:
        preset = preset.model_copy(update={"optics": Optics()})
    stone = preset.stones[0].model_copy(update={"mass": 2})
    assert read == preset.model_copy(update={"stones": (stone,)})


@pytest.mark.parametrize("name", FIRST)
def test_a_scene_of_version_1_keeps_its_lamps_lights_and_sky(name: str) -> None:
    old, scene = FIRST[name], Scene.read(FIRST[name])
    lamps = old["environment"].get("lamps", [])
    radiances = [lamp["radiance"] for lamp in lamps if lamp["shape"] == "round"]
    assert [list(disc.radiance) for disc in discs(scene.shown_lamps)] == radiances
    assert [list(box.radiance) for box in boxes(scene.shown_lamps)] == [
        lamp["radiance"] for lamp in lamps if lamp["shape"] == "box"
    ]
    assert [list(point.position) for point in scene.points] == [light["position"] for light in old["lights"]]
    if "ambient" in old["environment"]:
        assert [list(colour) for colour in sky_colours(scene.environment)] == [old["environment"]["ambient"]] * 2


def test_what_was_written_is_version_2_and_reads_as_the_same() -> None:
    for document in FIRST.values():
        scene = Scene.read(document)
        written = json.loads(scene.model_dump_json())
        assert written["version"] == 2
        assert Scene.read(written) == scene


@pytest.mark.parametrize("bands", [3, 8])
def test_a_size_made_absorption_one_per_millimetre(bands: int) -> None:
    """That of the channels, and of the wavelengths between the lines that stand for them."""
    sized = of_1(stones=[{"material": "bk7", "absorption": [1, 2, 3], "size_mm": 4}], optics={"bands": bands})
    per_r = of_1(stones=[{"material": "bk7", "absorption": [4, 8, 12]}], optics={"bands": bands})
    assert sized.millimetres == 4
    assert absorption(sized, sized.stones[0]) == (4, 8, 12)
    tables = [chain_table(scene, 0, np.float64, common=False)["absorption"] for scene in (sized, per_r)]
    assert tables[0].tolist() == tables[1].tolist()


def test_a_coloured_material_is_as_deep_as_by_its_size_or_by_a_carats() -> None:
    def of(scene: Scene) -> tuple[float, float, float]:
        return absorption(scene, scene.stones[0])

    per_mm = of(Scene.read({"millimetres": 1, "stones": [{"material": "ruby"}]}))
    assert of(of_1(stones=[{"material": "ruby", "size_mm": 4}])) == pytest.approx([4 * channel for channel in per_mm])
    assert of(of_1(stones=[{"material": "ruby"}])) == pytest.approx([3.25 * channel for channel in per_mm])


def test_the_stone_has_the_mass_and_the_start_that_were_the_simulations() -> None:
    scene = of_1(simulation={"mass": 7, "spin": [1, 2, 3], "velocity": [0, 4, 0], "friction": 0.5})
    stone = scene.stones[0]
    assert (stone.mass, stone.spin, stone.velocity, stone.friction) == (7, (1, 2, 3), (0, 4, 0), None)
    assert scene.simulation.friction == 0.5
    assert of_1().stones[0].spin == (0.5, 3, 0)
    assert of_1(stones=[]).stones == ()


def test_lights_follow_the_lamps_as_points() -> None:
    assert [emitter.shape for emitter in of_1(lights=[LIGHT]).emitters[-2:]] == ["round", "point"]
    assert [emitter.shape for emitter in of_1(lights=[LIGHT], environment={"kind": "half"}).emitters] == ["point"]


ONLY_IN_1: dict[str, dict[str, Any]] = {
    "lights": {"lights": []},
    "lamps": {"environment": {"kind": "studio", "lamps": []}},
    "a size": {"stones": [{"size_mm": 3}]},
    "the mass": {"simulation": {"mass": 3}},
    "the spin": {"simulation": {"spin": [0, 0, 0]}},
    "the velocity": {"simulation": {"velocity": [0, 0, 0]}},
}


@pytest.mark.parametrize("document", ONLY_IN_1.values(), ids=ONLY_IN_1.keys())
def test_a_scene_without_a_version_is_of_version_1_if_it_says_what_only_that_can(document: dict[str, Any]) -> None:
    assert Scene.read(document) == of_1(**document)
    with pytest.raises(SceneError, match="unknown field"):
        Scene.read({"version": 2, **document})


def test_a_scene_without_a_version_is_otherwise_of_version_2() -> None:
    assert Scene.read({"simulation": {"friction": 1}, "stones": [{}]}).stones[0].mass is None
    assert of_1(simulation={"friction": 1}).stones[0].mass == 2


BAD: dict[str, tuple[dict[str, Any], str, str]] = {
    "two stones": ({"stones": [{}, {}]}, "stones", "at most 1"),
    "size 0": ({"stones": [{"size_mm": 0}]}, "stones.0.size_mm", "greater than 0; got 0"),
    "a field of version 2": ({"stones": [{"scale": 2}]}, "stones.0.scale", "unknown field"),
    "emitters": ({"emitters": []}, "emitters", "unknown field"),
    "a lamp of another shape": (
        {"environment": {"kind": "studio", "lamps": [{"shape": "star"}]}}, "environment.lamps.0.shape", "got 'star'"
    ),
    "nine lights": ({"lights": [LIGHT] * 9}, "lights", "at most 8"),
    "massless": ({"simulation": {"mass": 0}}, "simulation.mass", "got 0"),
    "a light without a place": ({"lights": [{"colour": [1, 1, 1]}]}, "lights.0.position", "expected a value"),
}  # fmt: skip


@pytest.mark.parametrize(("fields", "field", "message"), BAD.values(), ids=BAD.keys())
def test_what_version_1_could_not_say_is_refused_with_its_field(
    fields: dict[str, Any], field: str, message: str
) -> None:
    with pytest.raises(SceneError, match=message) as refusal:
        of_1(**fields)
    assert refusal.value.field == field

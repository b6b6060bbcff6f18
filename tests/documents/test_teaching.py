"""The lessons of docs/tutorial/teaching.md: links hold their scenes, figures are what the ray and the formulas say."""

from __future__ import annotations

import base64
import json
import math
import re
import zlib
from pathlib import Path
from typing import Any

import pytest

from culet.paths.answer import Path as RayPath
from culet.paths.answer import Step
from culet.paths.asked import Pixel, answered
from culet.paths.recorder import PathRecorder
from culet.rendering.opencl.device import Device
from culet.scene import Scene
from culet.stage import Stage
from documents.pages import ROOT, read

PAGE = "docs/tutorial/teaching.md"
LESSONS = ROOT / "docs/tutorial/lessons"
SIZE = 640, 400
GREEN = 1
"""The chain whose figures the page tells."""


def scene_of(name: str) -> dict[str, Any]:
    scene: dict[str, Any] = json.loads((LESSONS / f"{name}.json").read_text(encoding="utf-8"))
    return scene


@pytest.fixture(scope="module")
def recorder(device: Device) -> PathRecorder:
    return PathRecorder(device)


def lesson(recorder: PathRecorder, name: str) -> RayPath:
    """The ray of the middle, which the page draws first."""
    width, height = SIZE
    return answered(recorder, Stage.of(Scene.read(scene_of(name))), Pixel(width // 2, height // 2, width, height))


def inside(path: RayPath) -> list[Step]:
    """The facets that green light meets on its way, the entry first."""
    return [
        step for step in path.steps if step.kind in ("enters", "meets") and any(p.chain == GREEN for p in step.passes)
    ]


def angle(step: Step) -> float:
    """Of incidence, of green light, degrees."""
    found = next(each.incidence_degrees for each in step.passes if each.chain == GREEN)
    assert found is not None
    return found


def kept(step: Step) -> float:
    return next(each.kept for each in step.passes if each.chain == GREEN)


def refracted(degrees: float, index: float) -> float:
    """Snell's angle in the stone."""
    return math.degrees(math.asin(math.sin(math.radians(degrees)) / index))


def critical(index: float) -> float:
    return math.degrees(math.asin(1 / index))


def told(figure: float, digits: int = 2, unit: str = "\N{DEGREE SIGN}") -> None:
    """The page tells it."""
    assert f"{figure:.{digits}f}{unit}" in read(PAGE), figure


def test_every_link_opens_the_scene_of_a_file_and_every_file_has_a_link() -> None:
    linked = []
    for packed in re.findall(r"\(http://127\.0\.0\.1:8000/#view=1\.([\w-]+)\)", read(PAGE)):
        view = json.loads(zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), wbits=-15))
        linked.append(view["scene"])
        assert Scene.read(view["scene"]).stones
    files = [scene_of(file.stem) for file in sorted(Path(LESSONS).glob("*.json"))]
    assert len(files) == 9
    assert sorted(map(json.dumps, linked)) == sorted(map(json.dumps, files))


def test_the_slab_shifts_a_ray_and_does_not_turn_it(recorder: PathRecorder) -> None:
    path = lesson(recorder, "slab")
    index = path.chains[GREEN].indices["stone"]
    entry, bottom = inside(path)[:2]
    assert (entry.facet_name, bottom.facet_name) == ("table", "culet")
    assert angle(entry) == pytest.approx(45, abs=0.01)
    assert angle(bottom) == pytest.approx(refracted(45, index), abs=0.01)
    assert bottom.passes[GREEN].refraction_degrees == pytest.approx(45, abs=0.01)
    reflectance = entry.passes[GREEN].reflectance
    assert reflectance is not None
    told(index, 4, ")")
    told(refracted(45, index))
    told(critical(index))
    for part in (reflectance.s, reflectance.p, reflectance.unpolarised):
        told(100 * part, 1, " %")
    # Fresnel's law of tangents and sines, by the angles alone: Born & Wolf, 1.5.2 (21a).
    a, s = math.radians(45), math.radians(refracted(45, index))
    assert reflectance.s == pytest.approx((math.sin(a - s) / math.sin(a + s)) ** 2, abs=1e-5)
    assert reflectance.p == pytest.approx((math.tan(a - s) / math.tan(a + s)) ** 2, abs=1e-5)


def test_the_prism_sends_light_back_by_two_total_reflections(recorder: PathRecorder) -> None:
    entry, first, second, back = inside(lesson(recorder, "prism"))[:4]
    assert angle(entry) == pytest.approx(0, abs=0.05)  # a cosine near 1 in single precision
    assert [angle(first), angle(second)] == pytest.approx([45, 45], abs=0.01)
    assert kept(first) == kept(second) == 1
    assert back.facet_name == "table"
    told(100 * kept(entry), 1, " %")


def test_diamond_keeps_what_glass_leaks(recorder: PathRecorder) -> None:
    diamond, glass = lesson(recorder, "sparkle-diamond"), lesson(recorder, "sparkle-glass")
    for path in (diamond, glass):
        first, second = inside(path)[1:3]
        assert (first.facet_name, second.facet_name) == ("main", "main")
        assert angle(first) == pytest.approx(40.75, abs=0.01)
        assert angle(second) == pytest.approx(180 - 3 * 40.75, abs=0.01)
        told(critical(path.chains[GREEN].indices["stone"]))
    assert kept(inside(diamond)[1]) == kept(inside(diamond)[2]) == 1
    leak = inside(glass)[1]
    for chain in range(3):
        told(100 * next(each.kept for each in leak.passes if each.chain == chain), 1, " %")


def test_a_prism_of_diamond_parts_red_from_blue(recorder: PathRecorder) -> None:
    path = lesson(recorder, "dispersion")
    leaving = inside(path)[1]
    assert angle(leaving) == pytest.approx(20, abs=0.01)
    beyond = []
    for each in leaving.passes:
        index = path.chains[each.chain or 0].indices["stone"]
        expected = math.degrees(math.asin(index * math.sin(math.radians(20))))
        assert each.refraction_degrees == pytest.approx(expected, abs=0.01)
        beyond.append(expected)
        told(index, 4, ")")
        told(expected)
    told(beyond[2] - beyond[0])
    told(path.chains[2].indices["stone"] - path.chains[0].indices["stone"], 4, " in n")


@pytest.mark.parametrize(("name", "slope"), [("shallow", 38), ("right", 43), ("steep", 48)])
def test_a_pavilion_keeps_light_between_two_angles(recorder: PathRecorder, name: str, slope: float) -> None:
    path = lesson(recorder, f"pavilion-{name}")
    limit = critical(path.chains[GREEN].indices["stone"])
    first, second = inside(path)[1:3]
    assert [angle(first), angle(second)] == pytest.approx([slope, 180 - 3 * slope], abs=0.01)
    assert (kept(first) == 1) == (slope > limit)
    assert (kept(second) == 1) == (180 - 3 * slope > limit)
    for step in (first, second):
        told(angle(step))
        if kept(step) < 1:
            told(100 * (1 - kept(step)), 1, " %")
    told(limit)
    told((180 - limit) / 3)


def test_glare_at_brewsters_angle_is_polarised(recorder: PathRecorder) -> None:
    path = lesson(recorder, "polarisation")
    index = path.chains[GREEN].indices["stone"]
    brewster = math.degrees(math.atan(index))
    entry, bottom, again = inside(path)[:3]
    assert angle(entry) == pytest.approx(brewster, abs=0.02)
    assert angle(bottom) == pytest.approx(90 - brewster, abs=0.02)
    glare = next(step for step in path.steps if step.parent == entry.number and step.kind == "sees")
    assert glare.number == 1
    assert glare.passes[GREEN].polarisation == pytest.approx(1, abs=1e-3)
    whole = ((index**2 - 1) / (index**2 + 1)) ** 2
    assert kept(again) == pytest.approx(whole, abs=1e-3)
    told(brewster)
    told(90 - brewster)
    told(100 * whole, 1, " %")
    told(100 * kept(entry), 1, " %")

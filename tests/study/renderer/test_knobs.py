"""The settings that a study of the renderer measures."""

from __future__ import annotations

from dataclasses import replace

import pytest

from culet.scene import Scene, preset
from culet.stage import Stage
from culet.study.renderer.knobs import Knobs, base_knobs, settings_of


def base_of(scene: Scene) -> Knobs:
    return base_knobs(Stage.of(scene), 16)


@pytest.mark.parametrize("name", ["default", "classic"])
@pytest.mark.parametrize("quick", [False, True])
def test_every_setting_is_measured_once_and_is_a_scene(name: str, quick: bool) -> None:
    scene = preset(name)
    settings = settings_of(base_of(scene), quick=quick)
    assert len({setting.knobs.key for setting in settings}) == len(settings)
    for setting in settings:
        changed = setting.knobs.applied_to(scene)
        assert Scene.read(changed.model_dump(mode="json")) == changed


def test_the_base_comes_first_and_is_the_scene_itself() -> None:
    first = settings_of(base_of(Scene()), quick=False)[0]
    assert first.knobs.applied_to(Scene()) == Scene()
    assert first.knobs.differences(base_of(Scene())) == "base"


@pytest.mark.parametrize("quick", [False, True])
def test_every_knob_is_turned_by_itself(quick: bool) -> None:
    base = base_of(Scene())
    alone = {
        name
        for setting in settings_of(base, quick=quick)
        for name in base.values()
        if setting.knobs == replace(base, **{name: getattr(setting.knobs, name)}) and setting.knobs != base
    }
    assert alone == set(base.values())


def test_a_quick_study_is_at_most_half_as_long() -> None:
    base = base_of(Scene())
    assert len(settings_of(base, quick=True)) <= len(settings_of(base, quick=False)) / 2

"""The scene that figures are compared with stays what it was, whatever the default becomes."""

from __future__ import annotations

import json
from pathlib import Path

from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT, legacy

WRITTEN_OUT = json.loads((Path(__file__).parent / "legacy_default.json").read_text())


def test_the_legacy_default_is_the_scene_that_figures_were_measured_on() -> None:
    """`legacy_default.json` is what version 0.1 made of `{}`, which knew neither backdrop nor head."""
    assert Scene.read({**WRITTEN_OUT, "backdrop": {"kind": "none"}, "head": None}) == LEGACY_DEFAULT


def test_what_a_claim_changes_of_the_legacy_default_keeps_the_rest() -> None:
    changed = legacy(
        {"stones": [{"material": "ruby"}], "camera": {"fov_degrees": 20}, "environment": {"kind": "light"}}
    )
    assert changed.stones[0] == LEGACY_DEFAULT.stones[0].model_copy(update={"material": "ruby"})
    assert changed.camera == LEGACY_DEFAULT.camera.model_copy(update={"fov_degrees": 20})
    assert changed.floor == LEGACY_DEFAULT.floor
    assert changed.environment.kind == "light"

"""The scene that figures are compared with stays what it was, whatever the default becomes."""

from __future__ import annotations

import json
from pathlib import Path

from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT

WRITTEN_OUT = json.loads((Path(__file__).parent / "legacy_default.json").read_text())


def test_the_legacy_default_is_the_scene_that_figures_were_measured_on() -> None:
    """`legacy_default.json` is what version 0.1 made of `{}`; fields that came later do not change its picture."""
    assert Scene.read(WRITTEN_OUT) == LEGACY_DEFAULT

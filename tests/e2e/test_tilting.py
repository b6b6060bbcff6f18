"""The camera's tilt from face up, as cutters look at stones."""

from __future__ import annotations

import numpy as np
import pytest

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.view import difference


def test_a_stone_that_is_seen_face_up_is_tilted_by_degrees(view_of: ViewOf) -> None:
    view = view_of(viewport=WITH_PANEL).open("?preset=face-up")
    tilt = view.page.get_by_role("slider", name="Tilt")
    assert float(tilt.input_value()) == 0
    camera = view.scene["camera"]
    distance = np.linalg.norm(np.subtract(camera["position"], camera["target"]))
    face_up, tilted = view.change(lambda: tilt.fill("30"))
    offset = np.subtract(view.scene["camera"]["position"], camera["target"])
    assert np.linalg.norm(offset) == pytest.approx(distance, rel=1e-9)
    assert np.degrees(np.arccos(offset[1] / distance)) == pytest.approx(30, abs=1e-6)
    assert difference(face_up.pixels, tilted.pixels) > 2

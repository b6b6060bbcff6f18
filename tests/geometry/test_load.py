"""From a scene's settings to its stone."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import MeshError, SceneError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.scene.cuts import BrilliantCut
from culet.scene.stone import StoneSettings

TETRAHEDRON = shape_from_half_spaces(
    "t", np.array([(1, 1, 1, 1), (1, -1, -1, 1), (-1, 1, -1, 1), (-1, -1, 1, 1)], np.float64)
)


def test_the_default_is_the_default_brilliant() -> None:
    assert shape_of(StoneSettings.model_validate({}), {}) is shape_of_cut(BrilliantCut())


def test_proportions_are_used() -> None:
    cut = BrilliantCut(table_percent=60)
    assert shape_of(StoneSettings.model_validate({"cut": cut}), {}) is shape_of_cut(cut)


def test_a_mesh_takes_the_place_of_the_cut() -> None:
    assert shape_of(StoneSettings.model_validate({"mesh": "id"}), {"id": TETRAHEDRON}) is TETRAHEDRON


def test_an_unknown_mesh_is_an_error_at_its_field() -> None:
    with pytest.raises(SceneError, match="no uploaded mesh 'gone'") as refusal:
        shape_of(StoneSettings.model_validate({"mesh": "gone"}), {"id": TETRAHEDRON})
    assert refusal.value.field == "stones.0.mesh"


def test_impossible_proportions_are_an_error_at_their_field() -> None:
    with pytest.raises(MeshError, match="star_percent must be above") as refusal:
        shape_of(StoneSettings.model_validate({"cut": {"star_percent": 1}}), {})
    assert refusal.value.field == "stones.0.cut.star_percent"

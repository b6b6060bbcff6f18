"""The stones of `shared/trimesh_stones.py`, by name."""

from __future__ import annotations

import pytest

from culet.geometry.stone import Stone
from shared import trimesh_stones


@pytest.fixture(scope="session")
def box() -> Stone:
    return trimesh_stones.box()


@pytest.fixture(scope="session")
def exact_box() -> Stone:
    return trimesh_stones.exact_box()


@pytest.fixture(scope="session")
def double_cone() -> Stone:
    return trimesh_stones.double_cone()


@pytest.fixture(scope="session")
def ring() -> Stone:
    return trimesh_stones.ring()


@pytest.fixture(scope="session")
def ball() -> Stone:
    return trimesh_stones.ball()

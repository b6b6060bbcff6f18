"""The stones of `shared/trimesh_stones.py`, by name."""

from __future__ import annotations

import pytest

from culet.geometry.shape import Shape
from shared import trimesh_stones


@pytest.fixture(scope="session")
def box() -> Shape:
    return trimesh_stones.box()


@pytest.fixture(scope="session")
def exact_box() -> Shape:
    return trimesh_stones.exact_box()


@pytest.fixture(scope="session")
def double_cone() -> Shape:
    return trimesh_stones.double_cone()


@pytest.fixture(scope="session")
def ring() -> Shape:
    return trimesh_stones.ring()


@pytest.fixture(scope="session")
def ball() -> Shape:
    return trimesh_stones.ball()

"""The stones of `shared/trimesh_stones.py`, by name, and the compilers of the solver."""

from __future__ import annotations

from pathlib import Path

import pytest

from culet.geometry.shape import Shape
from culet.simulation.solver.build import compilers
from shared import trimesh_stones


@pytest.fixture(params=["gcc", "clang"])
def compiler(request: pytest.FixtureRequest) -> str:
    """The path of each. `make` says so where it can install none, and what is skipped for it says so again."""
    named = (path for path in compilers() if Path(path).name.startswith(request.param))
    found = next(named, None)
    if found is None:
        pytest.skip(f"not shown, since there is no {request.param}: {request.node.originalname}")
    return found


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

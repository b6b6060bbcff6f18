"""What carries a stone at rest, and what does not."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.simulation.one_stone.contact import Contact
from culet.simulation.one_stone.support import MARGIN, is_supported
from culet.simulation.rigid_body.state import Triple
from simulation.solids import advance, lowest, rigid

UP, ASIDE = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def touching(*feet: tuple[float, float], normal: Triple = UP) -> list[Contact]:
    """Contacts that far from the centre of mass along x and z, R."""
    mass = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    return [Contact(0, number, 0.0, normal, (x, -0.5, z), mass, 1.0, 1.0) for number, (x, z) in enumerate(feet)]


@pytest.mark.parametrize(
    ("feet", "carries"),
    [
        ([(1, 0), (-1, 1), (-1, -1)], True),
        ([(-1, -1), (1, 0), (-1, 1)], True),
        ([(1, 0), (-1, 1), (-1, -1), (0.1, 0), (0.1, 0)], True),
        ([(1.2, 0), (0.2, 1), (0.2, -1)], False),
        ([(1, 0), (-MARGIN / 2, 1), (-MARGIN / 2, -1)], False),
        ([(1, 0), (-2 * MARGIN, 1), (-2 * MARGIN, -1)], True),
        ([(1, 0), (-1, 0)], False),
        ([(1, 0), (0, 0), (-1, 0)], False),
        ([], False),
    ],
    ids=[
        "about it",
        "in another order",
        "some within",
        "beside it",
        "balancing",
        "just within",
        "two",
        "a line",
        "none",
    ],
)
def test_a_stone_is_carried_where_its_centre_of_mass_is_above_what_touches(
    feet: list[tuple[float, float]], *, carries: bool
) -> None:
    assert is_supported(touching(*feet)) is carries


def test_walls_carry_nothing() -> None:
    feet = (1.0, 0.0), (-1.0, 1.0), (-1.0, -1.0)
    assert not is_supported(touching(*feet, normal=ASIDE))
    assert not is_supported([*touching(*feet[:2]), *touching(feet[2], normal=ASIDE)])


@pytest.fixture(scope="module")
def leaning() -> Shape:
    """A block whose upper face is so far aside that its centre of mass is beyond its lower one."""
    corners = np.array([(x + 1.5 * y, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    return shape_from_mesh(bytes(trimesh.Trimesh(corners).convex_hull.export(file_type="stl")), "stl")


def test_a_stone_that_leans_too_far_falls_over_and_does_not_sleep_as_it_stands(leaning: Shape) -> None:
    moving = rigid(leaning, (0.0, lowest(leaning), 0.0), rolling_resistance=0.01)
    begun, over = advance(moving, 0.1)[-1], advance(moving, 5)[-1]
    assert (begun.asleep, over.asleep) == (False, True)
    assert over.position[1] < lowest(leaning) - 0.1

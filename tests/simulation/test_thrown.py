"""Needles and wafers thrown at each other: none passes through another, however far it flies in a step.

Neither turns before they meet, so where and by which sides they meet follows from the Minkowski difference of their
corners (Qhull), without the solver. The step in which they meet ends shortly after that, when one that had passed
through the other would be on the other's far side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from culet.geometry.shape import Shape
from culet.simulation.bodies import Body, BodyState
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.study.contacts.worlds import corners, momenta, triple, turned
from culet.study.solids import box
from simulation.worlds import world

Floats = NDArray[np.float64]

SHAPES = {"needle": box(1, 1e-3, 1e-3), "wafer": box(1, 1e-3, 1)}
"""1000 : 1."""
LONGEST = 1 / 60
"""s, of the way to each other, or the time of 4 R: all of it is one step."""
BEYOND = 0.02
"""R, that they fly on in that step: five times what both are thick."""
OVERLAP = 1e-4
"""R: a twentieth of what they are thick."""
THROWS = 12
ORIGIN = (0.0, 0.0, 0.0)


def difference(one: Body, there: BodyState, other: Body, where: BodyState) -> Floats:
    """The planes (normal, offset) of all ways from a point of the one to a point of the other: the origin's distance
    from them is how far both are apart, and a normal points from the other towards the one."""
    a, b = corners(one, there), corners(other, where)
    return np.asarray(ConvexHull((b[:, None] - a[None]).reshape(-1, 3)).equations)


def first_touch(planes: Floats, velocity: Floats) -> tuple[float, Floats]:
    """When two meet of which one flies like this past the other, and the normal there; infinite if never."""
    closing = planes[:, :3] @ velocity
    enters = np.where(closing < 0, -planes[:, 3] / np.where(closing < 0, closing, -1), -math.inf)
    leaves = np.where(closing > 0, -planes[:, 3] / np.where(closing > 0, closing, 1), math.inf)
    last = int(enters.argmax())
    return (float(enters[last]) if enters[last] < leaves.min() else math.inf), planes[last, :3]


def kept_apart(one: Body, there: BodyState, other: Body, where: BodyState, met_by: Floats) -> bool:
    """Whether the one is beside the other still, on the side on which it came."""
    planes = difference(one, there, other, where)
    apart = planes[planes[:, 3] > -OVERLAP]
    return bool((apart[:, :3] @ met_by > 0.5).any())


@dataclass(frozen=True)
class Throw:
    """Two stones that would be on each other's far sides after the step, if neither felt the other."""

    one: Body
    other: Body
    met_by: Floats
    """The normal of the sides that touch first, from the other towards the one."""
    step: float
    """s."""


def throw(first: Shape, second: Shape, speed: float, rng: np.random.Generator) -> Throw | None:
    """From any side, both turned at random; None for a graze, after which the one is where it may be."""
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    share = rng.uniform(0.2, 0.8)  # of the speed, that the thrown one has
    velocities = share * speed * way, (share - 1) * speed * way
    still = [Body(name, shape, ORIGIN, turned(rng), spin=ORIGIN) for name, shape in (("one", first), ("other", second))]
    inside = [  # a point of each: these two are to meet
        corners(body, BodyState.start_of(body)).T @ rng.dirichlet(np.ones(len(body.shape.vertices))) for body in still
    ]
    place = inside[1] - inside[0] - rng.uniform(3, max(4, LONGEST * speed)) * way
    one = replace(still[0], position=triple(place), velocity=triple(velocities[0]))
    other = replace(still[1], velocity=triple(velocities[1]))
    starts = BodyState.start_of(one), BodyState.start_of(other)
    touch, met_by = first_touch(difference(one, starts[0], other, starts[1]), velocities[0] - velocities[1])
    assert touch < math.inf
    step = touch + BEYOND / speed
    there, where = (
        start.at(triple(np.array(start.position) + step * velocity), start.orientation)
        for start, velocity in zip(starts, velocities, strict=True)
    )
    return None if kept_apart(one, there, other, where, met_by) else Throw(one, other, met_by, step)


@pytest.mark.parametrize("speed", [50.0, 400.0, 2000.0])
@pytest.mark.parametrize("at", SHAPES)
@pytest.mark.parametrize("thrown", SHAPES)
def test_what_is_thrown_at_another_does_not_pass_through_it(thrown: str, at: str, speed: float) -> None:
    rng, shapes = np.random.default_rng(int(speed)), (SHAPES[thrown](), SHAPES[at]())
    throws = [made for _ in range(THROWS) if (made := throw(*shapes, speed, rng)) is not None]
    assert len(throws) > 0.7 * THROWS
    for each in throws:
        moving = world([each.one, each.other], (), gravity=0, time_step=each.step)
        (linear, angular), energy = momenta(moving), moving.energy()
        moving.step()
        there, where = moving.state.bodies
        assert kept_apart(each.one, there, each.other, where, each.met_by)
        assert moving.energy() <= energy * (1 + 1e-9)
        linear_after, angular_after = momenta(moving)
        assert linear_after == pytest.approx(linear, abs=1e-12 * speed)
        assert angular_after == pytest.approx(angular, abs=OVERLAP * speed)  # what overlaps is moved apart


def parting(speed: float) -> list[Body]:
    """Two wafers far away that slide past each other, always nearer than they are thick, and hardly part."""
    wafer = SHAPES["wafer"]()
    thick = 2 * float(wafer.vertices[:, 1].max())
    return [
        Body("below", wafer, (0.0, 500.0, 0.0), IDENTITY, (-speed / 2, -1e-3, 0.0), ORIGIN),
        Body("above", wafer, (0.0, 500.0 + thick + 1e-5, 0.0), IDENTITY, (speed / 2, 1e-3, 0.0), ORIGIN),
    ]


def test_stones_that_part_do_not_take_the_parts_of_a_step_from_those_that_meet() -> None:
    rng, needle = np.random.default_rng(5), SHAPES["needle"]()
    throws = [made for _ in range(THROWS) if (made := throw(needle, needle, 400.0, rng)) is not None]
    assert len(throws) > 0.7 * THROWS
    for each in throws:
        moving = world([each.one, each.other, *parting(200.0)], (), gravity=0, time_step=each.step)
        moving.step()
        there, where = moving.state.bodies[:2]
        assert kept_apart(each.one, there, each.other, where, each.met_by)

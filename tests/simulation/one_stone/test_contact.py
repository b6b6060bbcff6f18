"""Bouncing, sliding, rolling, tipping, rocking against closed forms; tolerances tied to the contact step."""

from __future__ import annotations

import math

import pytest
import trimesh

from culet.geometry.shape import Shape
from culet.simulation.one_stone.flight import SAGITTA
from culet.simulation.rigid_body.state import Triple
from shared.trimesh_stones import by_trimesh
from simulation.solids import (
    TABLE_DOWN,
    TILTED,
    G,
    about,
    advance,
    apexes,
    lowest,
    nearest,
    rigid,
    spin_of,
    tilted_floor,
)

CONTACT_STEP = 0.02 / math.sqrt(G)
"""s, as the scene's default."""


def test_free_fall_is_on_the_parabola_at_any_step(box: Shape) -> None:
    for step in (1e-3, 1 / 60, 0.25):
        moving = rigid(box, (1.0, 50.0, 0.0), time_step=step, velocity=(2, 3, -1))
        for state in advance(moving, 2):
            t = state.time
            expected = (1 + 2 * t, 50 + 3 * t - G * t * t / 2, -t)
            assert state.position == pytest.approx(expected, abs=1e-10)  # measured 4e-12, after 2000 steps


@pytest.mark.parametrize("e", [0.5, 0.8, 1.0])
def test_each_apex_is_restitution_squared_times_the_one_before(box: Shape, e: float) -> None:
    """A box that lands flat does not turn: height_n = e^2n height."""
    height = 2.0
    moving = rigid(box, (0.0, lowest(box) + height, 0.0), restitution=e, time_step=1 / 1000)
    tops = [top - lowest(box) for top in apexes(advance(moving, 6))]
    assert len(tops) >= 3
    for number, top in enumerate(tops[:4], start=1):
        # sampled every 1/1000 s: the top is missed by g h^2 / 8 at most; contacts are made within 1e-6 R
        assert top == pytest.approx(height * e ** (2 * number), abs=G / 8e6 + 1e-6 * number)  # measured 9.7e-7
    assert max(tops) <= height


def test_how_high_a_stone_bounces_does_not_depend_on_the_time_step(brilliant: Shape) -> None:
    """Touches are found within a step: after the first impact of a tilted, spinning stone its energy is the same."""
    energies = []
    for step in (1 / 1000, 1 / 120, 1 / 30, 0.1):
        moving = rigid(brilliant, (0.0, 2.0, 0.0), TILTED, spin=(1, 2, 3), time_step=step)
        while moving.state.impacts == 0:
            moving.step()
        energies.append(moving.energy())
        assert moving.state.impacts == 1
    assert energies == pytest.approx([energies[0]] * 4, rel=2e-7)  # measured 5e-8


def test_a_hundred_elastic_bounces_keep_their_height(box: Shape) -> None:
    moving = rigid(box, (0.0, lowest(box) + 0.5, 0.0), restitution=1, time_step=1 / 30)
    start = moving.energy()
    while moving.state.impacts < 100:
        moving.step()
    assert moving.energy() == pytest.approx(start, rel=1e-9)  # measured 1.7e-11


def test_bouncing_ends_when_the_geometric_series_says(box: Shape) -> None:
    """sqrt(2 h / g) (1 + e) / (1 - e); bounces below the bounce speed of 0.02 sqrt(g R) are left out of it."""
    e, height = 0.6, 1.0
    moving = rigid(box, (0.0, lowest(box) + height, 0.0), restitution=e, time_step=1 / 1000)
    while not moving.state.asleep:
        moving.step()
    total = math.sqrt(2 * height / G) * (1 + e) / (1 - e)
    left_out = 2 * 0.02 / math.sqrt(G) * e / (1 - e)
    assert total - left_out - 1e-3 <= moving.state.time <= total + 1e-3 + CONTACT_STEP


@pytest.mark.parametrize("heading", [0, 30, 75, 160, 290])
def test_a_slide_ends_after_v2_over_2_mu_g_in_every_direction(box: Shape, heading: int) -> None:
    speed, mu = 2.0, 0.4
    angle = math.radians(heading)
    moving = rigid(
        box,
        (0.0, lowest(box), 0.0),
        friction=mu,
        velocity=(speed * math.cos(angle), 0, speed * math.sin(angle)),
    )
    advance(moving, 1.5)
    x, _, z = moving.state.position
    assert moving.state.asleep
    assert math.hypot(x, z) == pytest.approx(speed**2 / (2 * mu * G), abs=2e-5)  # measured 7.5e-6 of 0.51
    assert math.atan2(z, x) % (2 * math.pi) == pytest.approx(angle, abs=1e-11)  # measured 6e-13


@pytest.mark.parametrize("contact_step", [0.04, 0.02, 0.01, 0.005])
def test_the_error_of_a_slide_is_of_second_order_in_the_contact_step(box: Shape, contact_step: float) -> None:
    """Exact up to the step h in which it ends: v h / 2 there is not v^2 / (2 mu g), but mu g h^2 / 8 more at most."""
    mu = 0.4
    moving = rigid(
        box, (0.0, lowest(box), 0.0), friction=mu, velocity=(2, 0, 0), contact_step=contact_step, time_step=0.05
    )
    advance(moving, 1.5)
    # measured 5.4e-5, 1.9e-5, 1.7e-6, 7.6e-7: the limits are 8e-5, 2e-5, 5e-6, 1.25e-6
    limit = mu * contact_step**2 / 8
    assert moving.state.position[0] == pytest.approx(4 / (2 * mu * G), abs=limit * (1 + 1e-2))


@pytest.mark.parametrize(("friction", "slides"), [(0.38, True), (0.42, False)])
@pytest.mark.parametrize("restitution", [0.0, 1.0])
def test_a_block_on_an_incline_sticks_just_if_friction_exceeds_the_slope(
    box: Shape, friction: float, slides: bool, restitution: float
) -> None:
    """tan 21.8 degrees = 0.4. Even with e = 1, a block that sticks must not begin to hop (Guendelman et al. 2003)."""
    slope = math.atan(0.4)
    surface = tilted_floor(slope)
    orientation = about((0.0, 0.0, 1.0), -slope)
    height = lowest(box) + 1
    (a, b, _) = surface.normal
    start = (a * height, -1 + b * height, 0.0)
    moving = rigid(box, start, orientation, (surface,), friction=friction, restitution=restitution)
    assert nearest(moving) == pytest.approx(0, abs=1e-12)
    advance(moving, 1)
    travelled = math.dist(moving.state.position, start)
    if slides:
        acceleration = G * (math.sin(slope) - friction * math.cos(slope))
        assert travelled == pytest.approx(acceleration / 2, rel=1e-8)  # measured 1e-9
    else:
        assert travelled < 1e-12  # measured 1e-16
    assert moving.state.impacts == 0


def test_a_block_on_an_incline_tips_over_when_its_centre_passes_its_edge(box: Shape) -> None:
    """Half width 3/7 and half height 6/7: tips where tan(slope) > 1/2, if friction holds it."""
    for slope_tangent, tips in ((0.48, False), (0.52, True)):
        slope = math.atan(slope_tangent)
        surface = tilted_floor(slope)
        half_turn = about((0.0, 0.0, 1.0), math.pi / 2 - slope)  # the long axis along the normal
        (a, b, _) = surface.normal
        moving = rigid(box, (a * 6 / 7, -1 + b * 6 / 7, 0.0), half_turn, (surface,), friction=2)
        assert nearest(moving) == pytest.approx(0, abs=1e-12)
        advance(moving, 2)
        turned = 2 * math.acos(
            min(abs(sum(p * q for p, q in zip(moving.state.orientation, half_turn, strict=True))), 1)
        )
        assert (turned > 0.5) is tips
        assert tips or turned < 1e-6


def test_a_spin_on_the_table_is_stopped_by_friction_in_time(brilliant: Shape) -> None:
    """n equal vertices at radius r: omega' = -mu m g r / I_y."""
    mu, spin = 0.2, 6.0
    radius = max(
        math.hypot(x, z) for x, y, z in brilliant.vertices.tolist() if y > brilliant.vertices[:, 1].max() - 1e-9
    )
    inertia = float(brilliant.mass.inertia[1, 1])
    height = -1 + float(brilliant.vertices[:, 1].max())
    moving = rigid(brilliant, (0.0, height, 0.0), TABLE_DOWN, friction=mu, spin=(0, spin, 0), time_step=1 / 500)
    advance(moving, 0.2)
    assert spin_of(moving)[1] == pytest.approx(spin - mu * G * radius / inertia * 0.2, rel=1e-12)  # measured 3e-15
    assert math.hypot(moving.state.position[0], moving.state.position[2]) < 1e-9


def test_a_sliding_ball_rolls_at_five_sevenths_of_its_speed(ball: Shape) -> None:
    """And gets there after 2 v / (7 mu g). The ball's facets are 3 degrees wide: it rolls as far as they let it."""
    speed, mu = 1.0, 0.3
    moving = rigid(ball, (0.0, lowest(ball), 0.0), friction=mu, velocity=(speed, 0, 0), restitution=0)
    advance(moving, 2 * speed / (7 * mu * G))
    vx = moving.body.velocity(moving.state)[0]
    assert vx == pytest.approx(5 / 7 * speed, rel=0.01)  # measured 4.5e-3
    assert -spin_of(moving)[2] == pytest.approx(vx, rel=2e-3)  # measured 6e-4


def test_a_slender_block_rocks_with_housners_period(box: Shape) -> None:
    """A quarter of the period until the block, let go at the angle theta, hits: acosh(1 / (1 - theta / alpha)) / p.

    Housner 1963, with p^2 = m g r / I about the pivot (3 g / 4 r for a flat block) and alpha small.
    """
    slim = by_trimesh("slim", trimesh.creation.box((0.2, 2, 0.2)))
    half_width, half_height = (float(slim.vertices[:, axis].max()) for axis in (0, 1))
    arm, alpha = math.hypot(half_width, half_height), math.atan(half_width / half_height)
    inertia = float(slim.mass.inertia[2, 2]) + arm**2
    theta = 0.4 * alpha
    centre = (-half_width + arm * math.sin(alpha - theta), -1 + arm * math.cos(alpha - theta), 0.0)
    moving = rigid(slim, centre, about((0.0, 0.0, 1.0), theta), friction=10, restitution=0, time_step=1 / 2000)
    assert nearest(moving) == pytest.approx(0, abs=1e-9)
    before = spin_of(moving)[2]
    while spin_of(moving)[2] <= before:
        before = spin_of(moving)[2]
        moving.step()
        if moving.state.time > 2:
            break
    rate = math.sqrt(G * arm / inertia)
    expected = math.acosh(1 / (1 - theta / alpha)) / rate
    assert moving.state.time == pytest.approx(expected, rel=2e-3)  # measured 1.2e-3, in steps of 1/2000 s


def test_a_push_from_the_side_needs_more_than_the_topple_threshold(box: Shape) -> None:
    """About an edge at distance s from the foot of the centre at height h: dU = m g (sqrt(h^2 + s^2) - h)."""
    half_width, half_height = 3 / 7, 6 / 7
    upright = about((0.0, 0.0, 1.0), math.pi / 2)
    arm = math.hypot(half_width, half_height)
    inertia = float(box.mass.inertia[2, 2]) + arm**2
    critical = math.sqrt(2 * G * (arm - half_height) / inertia)
    for share, topples in ((0.95, False), (1.05, True)):
        omega = -share * critical  # about the edge at x = +half_width
        velocity: Triple = (-omega * half_height, omega * -half_width, 0.0)
        moving = rigid(
            box, (0.0, -1 + half_height, 0.0), upright, friction=10, restitution=0, spin=(0, 0, omega),
            velocity=velocity, contact_step=0.005, time_step=1 / 100,
        )  # fmt: skip
        advance(moving, 1.5)
        flat = abs(moving.state.position[1] + 1 - half_height) > 0.1
        assert flat is topples


def test_energy_never_rises_from_start_to_rest(brilliant: Shape) -> None:
    moving = rigid(brilliant, (0.0, 2.0, 0.0), spin=(0.5, 3, 0), rolling_resistance=0.01)
    last = moving.energy()
    while not moving.state.asleep:
        moving.step()
        assert moving.energy() <= last + 1e-9 * abs(last)
        last = moving.energy()
        assert nearest(moving) > -1e-5


def test_a_vertex_dips_no_deeper_than_the_sagitta(brilliant: Shape) -> None:
    moving = rigid(brilliant, (0.0, 1.0, 0.0), spin=(40, 30, 60), velocity=(0, -20, 0), restitution=0.9)
    for _ in range(240):
        moving.step()
        assert nearest(moving) > -SAGITTA


def test_rolling_resistance_slows_a_rolling_ball(ball: Shape) -> None:
    """A moment c m g against the turning: the ball loses c g / (1 + 2/5) R/s every second.

    Less a seventh: so much of the time, this polyhedron hops from one facet to the next.
    """
    resistance = 0.1
    speeds = [
        advance(
            rigid(ball, (0.0, lowest(ball), 0.0), friction=1, velocity=(0.5, 0, 0), spin=(0, 0, -0.5), restitution=0,
                  rolling_resistance=c),
            0.25,
        )[-1].momentum[0] / 2
        for c in (0, resistance)
    ]  # fmt: skip
    assert speeds[0] - speeds[1] == pytest.approx(resistance * G / 1.4 * 0.25, rel=0.2)  # measured 0.18 less

"""The same stones in engines of others: Rapier and MuJoCo, by what they offer to Python."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.simulation.bodies import Body
from culet.simulation.rigid_body.surfaces import Surface
from culet.study.contacts.worlds import STEP, turning

MISSING = "the comparison needs {}, which is not installed: pip install -e '.[validation]'"
FRICTION = 0.3
THICK, WIDE = 10.0, 60.0
"""Half sides of a box in place of a plane, R: neither engine holds hulls well on a plane."""

Positions = NDArray[np.float64]
"""(N, 3), R."""


def slab(surface: Surface) -> tuple[list[float], tuple[float, float, float, float]]:
    """Centre and orientation of a box whose upper side (its own y) is the surface."""
    normal, offset = surface
    return [c * (offset - THICK) for c in normal], turning((0.0, 1.0, 0.0), normal)


def rapier(bodies: Sequence[Body], surfaces: Sequence[Surface], seconds: float) -> Positions:
    """Where the stones are after that time, without restitution."""
    engine = pytest.importorskip("rapier3d", reason=MISSING.format("rapier3d"))
    world = engine.PhysicsWorld(gravity=(0, -9.81, 0))
    world.set_num_threads(1)
    world.integration_parameters.dt = STEP
    for surface in surfaces:
        at, q = slab(surface)
        box = engine.Collider.cuboid(WIDE, THICK, WIDE).position(engine.Isometry3(tuple(at), engine.Rotation3(*q)))
        world.add_collider(box.friction(FRICTION).restitution(0.0))
    handles = []
    for body in bodies:
        place = engine.Isometry3(body.position, engine.Rotation3(*body.orientation))
        moving = engine.RigidBody.dynamic().position(place).linvel(body.velocity).angvel(body.spin)
        hull = engine.Collider.new(engine.SharedShape.convex_hull(body.shape.vertices.tolist()))
        handles.append(world.add_body(moving, colliders=[hull.friction(FRICTION).restitution(0.0).density(1.0)]))
    for _ in range(round(seconds / STEP)):
        world.step()
    found = [world.rigid_bodies[handle].translation for handle in handles]
    return np.array([(at.x, at.y, at.z) for at in found])


def mujoco(bodies: Sequence[Body], surfaces: Sequence[Surface], seconds: float) -> Positions:
    """Where the stones are after that time; MuJoCo has no restitution."""
    engine = pytest.importorskip("mujoco", reason=MISSING.format("mujoco"))
    meshes = {id(body.shape): body.shape for body in bodies}
    assets = "".join(
        f'<mesh name="m{key}" vertex="{text(shape.vertices.ravel())}" inertia="convex"/>'
        for key, shape in meshes.items()
    )
    fixed = ""
    for surface in surfaces:
        at, q = slab(surface)
        fixed += f'<geom type="box" size="{WIDE} {THICK} {WIDE}" pos="{text(at)}" quat="{text(q)}"/>'
    moving = "".join(
        f'<body pos="{text(body.position)}" quat="{text(body.orientation)}"><freejoint/>'
        f'<geom type="mesh" mesh="m{id(body.shape)}"/></body>'
        for body in bodies
    )
    model = engine.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{STEP / 4}" gravity="0 -9.81 0" cone="elliptic" impratio="10"
        integrator="implicitfast"/>
        <default><geom condim="3" friction="{FRICTION} 0 0" solref="0.004 1"/></default>
        <asset>{assets}</asset><worldbody>{fixed}{moving}</worldbody></mujoco>""")
    data = engine.MjData(model)
    for number, body in enumerate(bodies):
        data.qvel[6 * number : 6 * number + 3] = body.velocity
    for _ in range(4 * round(seconds / STEP)):
        engine.mj_step(model, data)
    return np.array([data.qpos[7 * number : 7 * number + 3] for number in range(len(bodies))])


def text(numbers: Sequence[float] | NDArray[np.float64]) -> str:
    """As an attribute of XML."""
    return " ".join(f"{number:.17g}" for number in numbers)

"""How stones move."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from culet.scene.fields import Model


class MotionLaws(Model):
    """The laws of motion, for all stones; restitution and friction of those that have none of their own."""

    model: Literal["rigid", "classic"] = Field(
        "rigid",
        description="rigid: the stone's own corners against floor and walls; classic: the report's sphere against "
        "the floor.",
    )
    inertia: Literal["polyhedron", "cone", "cone_apex"] = Field(
        "polyhedron",
        description="polyhedron: integral over the mesh; cone: R=1, h=2 about its centre of mass; "
        "cone_apex: the same about its apex, as the report's formula (1).",
    )
    gravity: Annotated[float, Field(ge=0, le=1e6)] = Field(9.81, description="Downward, R/s^2.")
    restitution: Annotated[float, Field(ge=0, le=1)] = 0.6
    friction: Annotated[float, Field(ge=0, le=1e3)] = Field(0.3, description="Coulomb's coefficient (rigid).")
    rolling_resistance: Annotated[float, Field(ge=0, le=1)] = Field(
        0.02, description="Lever arm of the floor's resistance to rolling, R (rigid)."
    )
    integrator: Literal["rkmk4", "rk4", "midpoint", "splitting", "symmetric_top", "euler"] = Field(
        "rkmk4",
        description="How a free rotation is followed (rigid): Munthe-Kaas or classical Runge-Kutta, both of fourth "
        "order; Lie midpoint or two splittings, of second (symmetric_top is exact for a body of revolution); the "
        "report's Euler, of first.",
    )
    bounce_speed: Annotated[float, Field(ge=1e-6, le=1)] = Field(
        0.02, description="A slower impact does not bounce, in sqrt(g R) (rigid)."
    )
    contact_step: Annotated[float, Field(ge=1e-5, le=0.1)] = Field(
        0.02, description="Longest step in contact, in sqrt(R / g) (rigid)."
    )
    sleeping: bool = Field(True, description="Whether a stone at rest is left out of the simulation (rigid).")
    velocity_threshold: Annotated[float, Field(ge=0, le=1e6)] = Field(
        0.1, description="A slower impact stops, R/s (classic)."
    )
    tangential_damping: Annotated[float, Field(ge=0, le=1)] = Field(
        0.9, description="Factor on the horizontal velocity at a contact (classic)."
    )
    angular_damping: Annotated[float, Field(ge=0, le=1)] = Field(
        0.75, description="Factor on the angular momentum at a soft contact (classic)."
    )
    random_torque: Annotated[float, Field(ge=0, le=1e6)] = Field(
        5, description="Largest random change of angular momentum about x and z at a hard impact (classic)."
    )
    random_torque_speed: Annotated[float, Field(ge=0, le=1e6)] = Field(
        2, description="An impact is hard above this rebound speed, R/s (classic)."
    )
    time_step: Annotated[float, Field(ge=1e-4, le=0.25)] = Field(
        1 / 120, description="Seconds. A picture is drawn between two steps, so a longer one cuts bounces off."
    )
    seed: Annotated[int, Field(ge=0, le=2**53 - 1)] = 0

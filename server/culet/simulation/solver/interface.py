"""culet_solver.h for ctypes: the same structures and functions. A call releases Python's lock while it runs."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, Structure, c_double, c_int32, c_size_t, c_void_p

VERSION = 5
"""CULET_INTERFACE."""
MAX_VERTICES = 1024
MAX_SURFACES = 16
NO_MEMORY = -1
NO_ROOM = -2

Doubles = POINTER(c_double)
Integers = POINTER(c_int32)


class CuletLaw(Structure):
    """CuletLaw."""

    _fields_ = (
        ("gravity", c_double),
        ("bounce_speed", c_double),
        ("contact_step", c_double),
        ("rolling_resistance", c_double),
        ("sleeping", c_int32),
        ("substeps", c_int32),
        ("sweeps", c_int32),
    )


class CuletHull(Structure):
    """CuletHull."""

    _fields_ = (
        ("vertex_count", c_int32),
        ("face_count", c_int32),
        ("edge_count", c_int32),
        ("vertices", Doubles),
        ("planes", Doubles),
        ("first", Integers),
        ("corners", Integers),
        ("edges", Integers),
    )


class Properties(Structure):
    """CuletBody."""

    _fields_ = (
        ("mass", c_double),
        ("inertia", c_double * 9),
        ("inverse_inertia", c_double * 9),
        ("axes", c_double * 9),
        ("moments", c_double * 3),
        ("restitution", c_double),
        ("friction", c_double),
    )


class CuletState(Structure):
    """CuletState."""

    _fields_ = (
        ("position", c_double * 3),
        ("orientation", c_double * 4),
        ("velocity", c_double * 3),
        ("angular_momentum", c_double * 3),
        ("spin", c_double * 3),
        ("asleep", c_int32),
        ("held", c_int32),
    )


class CuletTouch(Structure):
    """CuletTouch."""

    _fields_ = (("contacts", c_int32), ("penetration", c_double))


class CuletMotion(Structure):
    """CuletMotion."""

    _fields_ = (("orientation", c_double * 4), ("momentum", c_double * 3), ("angular_momentum", c_double * 3))


class CuletPoint(Structure):
    """CuletPoint."""

    _fields_ = (
        ("arm", c_double * 3),
        ("normal", c_double * 3),
        ("mass", c_double * 6),
        ("normal_inverse_mass", c_double),
        ("slip_mass", c_double),
        ("target", c_double),
        ("impulse", c_double * 3),
    )


_FUNCTIONS: dict[str, tuple[object, tuple[object, ...]]] = {
    "culet_interface": (c_int32, ()),
    "culet_world_new": (c_void_p, (c_int32,)),
    "culet_world_free": (None, (c_void_p,)),
    "culet_world_set_law": (None, (c_void_p, POINTER(CuletLaw))),
    "culet_world_set_surfaces": (None, (c_void_p, c_int32, Doubles)),
    "culet_world_add": (c_int32, (c_void_p, POINTER(CuletHull), POINTER(Properties), POINTER(CuletState))),
    "culet_world_remove": (None, (c_void_p, c_int32)),
    "culet_world_set_body": (None, (c_void_p, c_int32, POINTER(Properties))),
    "culet_world_set_state": (None, (c_void_p, c_int32, POINTER(CuletState))),
    "culet_world_hold": (None, (c_void_p, c_int32, c_int32)),
    "culet_world_push": (None, (c_void_p, c_int32, Doubles, Doubles)),
    "culet_world_wake": (None, (c_void_p,)),
    "culet_world_step": (c_int32, (c_void_p, c_double)),
    "culet_world_states": (None, (c_void_p, POINTER(CuletState))),
    "culet_world_touches": (None, (c_void_p, POINTER(CuletTouch))),
    "culet_world_size": (c_size_t, (c_void_p,)),
    "culet_world_save": (None, (c_void_p, c_void_p)),
    "culet_world_load": (c_int32, (c_void_p, c_void_p, c_size_t)),
    "culet_world_separation": (c_double, (c_void_p, c_int32, c_int32, c_double, Doubles)),
    "culet_stone_impulses": (
        c_int32,
        (POINTER(Properties), POINTER(CuletMotion), c_int32, POINTER(CuletPoint), c_double),
    ),
}


def declare(library: ctypes.CDLL) -> None:
    """Tell ctypes what each function takes and gives."""
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments

"""Cutters' designs that come with culet: scenes name them in the place of an upload's id."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import files

from culet.geometry.shape import Shape

SHIPPED = frozenset({"standard-round-brilliant"})
"""Names of the `.asc` files in this folder. An upload's id is never one of them."""


@lru_cache
def shipped_shape(name: str) -> Shape:
    """Of one of SHIPPED."""
    from culet.geometry.designs.reader import read_design  # of the few scenes that name one
    from culet.geometry.designs.solid import shape_of_design

    return shape_of_design(read_design((files(__name__) / f"{name}.asc").read_bytes(), "asc"), name)

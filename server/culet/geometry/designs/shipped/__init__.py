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
    from culet.geometry.stone_file import shape_from_file  # of the few scenes that name one

    return shape_from_file((files(__name__) / f"{name}.asc").read_bytes(), "asc", name=name)

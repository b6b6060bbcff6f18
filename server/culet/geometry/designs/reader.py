"""Bytes of a design's file to the design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import get_args

from culet.errors import InputError, MeshError, TooLargeError
from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.design import Design, DesignType
from culet.geometry.designs.gcs import read_gcs
from culet.geometry.designs.gem import read_gem
from culet.geometry.designs.limits import MOST_BYTES

_READERS: Mapping[str, Callable[[bytes], Design]] = {"asc": read_asc, "gem": read_gem, "gcs": read_gcs}
DESIGN_TYPES: tuple[DesignType, ...] = get_args(DesignType)


def read_design(data: bytes, file_type: str) -> Design:
    """The design in a file of GemCad (`asc`, `gem`) or Gem Cut Studio (`gcs`).

    MeshError if it cannot be read or has no facets, with the line or the byte; TooLargeError names the limit.
    """
    kind = file_type.lower().lstrip(".")
    if kind not in _READERS:
        raise MeshError(f"expected a design of type {', '.join(DESIGN_TYPES)}, got {kind[:20]!r}")
    if len(data) > MOST_BYTES:
        raise TooLargeError(f".{kind}: expected a design of at most {MOST_BYTES} bytes, got {len(data)}")
    try:
        if not data.strip():
            raise MeshError("the file is empty")
        design = _READERS[kind](data)
        if not any(tier.facets for tier in design.tiers):
            raise MeshError("expected a design with facets, got none")
    except InputError as error:
        raise type(error)(f".{kind}: {error}") from error
    return design

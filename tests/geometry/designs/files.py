"""Designs for tests: those of `made/` with their check values, and any of them as `.gem` and `.gcs`, written here.

`made/check_values.json` was computed by a program of its own, from the planes of a reader of its own.
"""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.design import Design
from culet.geometry.designs.solid import Solid

FOLDER = Path(__file__).parent / "made"
CHECK_VALUES: dict[str, dict[str, Any]] = json.loads((FOLDER / "check_values.json").read_text(encoding="utf-8"))
NAMES = tuple(CHECK_VALUES)


def made(name: str) -> bytes:
    """The file of that name."""
    return (FOLDER / f"{name}.asc").read_bytes()


def design(name: str) -> Design:
    """What it holds."""
    return read_asc(made(name))


def gem_of(given: Design, *, preform: bool = False) -> bytes:
    """As GemCad's binary, its corners those that the planes meet in."""
    solid = Solid(given)
    parts = []
    for (tier, facet), polygon in zip(solid.facets, solid.cut.polygons, strict=True):
        *normal, distance = facet.plane
        vector = [component / distance for component in normal]
        if vector[2] == 0:
            vector[2] = -6e-17  # as GemCad has it: its sign is the side
        text = f"{facet.name}\t{given.tiers[tier - 1].notes}".encode("cp1252")
        parts.append(struct.pack("<3diB", *vector, tier, len(text)) + text)
        parts += [struct.pack("<i3d", 1, *solid.cut.vertices[corner]) for corner in polygon]
        parts.append(struct.pack("<i", 0))
    parts.append(struct.pack("<d3idid", -99999.0, given.fold, given.mirror, given.wheel.teeth,
                             given.refractive_index or 0, 32767, given.wheel.offset))  # fmt: skip
    texts = [*(*given.headings, *4 * [""])[:4], *(*given.footnotes, *4 * [""])[:4]]
    parts += [bytes([len(text)]) + text.encode("cp1252") for text in texts]
    section = b"".join(parts)
    return section + b"\x07preform" + section if preform else section


def gcs_of(given: Design, tiers: dict[int, str] | None = None) -> bytes:
    """As Gem Cut Studio's XML; further attributes of tiers by their number."""
    solid = Solid(given)
    lines = ['<?xml version="1.0" encoding="utf-8"?>', '<GemCutStudio version="1000">']
    lines.append(f'<index gear="{abs(given.wheel.teeth)}" base="0" symmetry="{given.fold}" mirror="true"/>')
    for number, tier in enumerate(given.tiers, 1):
        up = tier.side in ("table", "crown")
        polar = tier.angle if up else 180 - tier.angle
        lines.append(
            f'<tier angle="{polar + 1.7e-12!r}" depth="{tier.distance!r}" name={quoteattr(tier.name)} '
            f"instructions={quoteattr(tier.notes)} {(tiers or {}).get(number, '')}>"
        )
        for (own, facet), polygon in zip(solid.facets, solid.cut.polygons, strict=True):
            if own != number:
                continue
            x, y, z, _ = facet.plane
            azimuth = math.degrees(math.atan2(y, x))
            label = (azimuth + 90 if polar < 90 else 270 - azimuth) % 360
            lines.append(f'<facet nx="{x!r}" ny="{y!r}" nz="{z + 2.7e-14!r}" index_angle="{label!r}">')
            corners = solid.cut.vertices[polygon].tolist()
            lines += [f'<vertex x="{a!r}" y="{b!r}" z="{c!r}"/>' for a, b, c in corners]
            lines.append("</facet>")
        lines.append("</tier>")
    lines.append(f'<render refractive_index="{given.refractive_index}" dispersion="0.02"/>')
    lines.append(f"<info title={quoteattr(given.title)} author='' footer1='cut &amp; polish'/></GemCutStudio>")
    return "\n".join(lines).encode()


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """How far a row of one is from the nearest of the other at most, either way."""
    gaps = abs(one[:, None] - other[None]).max(axis=2)
    return float(max(gaps.min(axis=0).max(), gaps.min(axis=1).max()))

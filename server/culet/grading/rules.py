"""How a stone is graded: the dome, the viewer's head, what counts, and how far light is followed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Glare = Literal["all", "crown", "none"]
"""Whose reflections of the dome at the surface count: all facets', or those of facets that look up, as in a closed
setting."""
Convention = Literal["culet", "gemray"]


@dataclass(frozen=True)
class Rules:
    """By default culet's own: chains are followed to the end."""

    head_degrees: float = 10.0
    """Half the angle of the cone about the line of sight that is dark: GemRay's. ASET's head has 15, GIA's 23."""
    glare: Glare = "all"
    bounces: int = 400
    """Facets that a chain meets inside at most."""
    cutoff: float = 1e-4
    """Weight below which a chain ends; what it could still bring is in the bound."""


GEMRAY = Rules(glare="crown", bounces=9, cutoff=1e-3)
"""Those of GemRay (R. W. Strickland): ten encounters with facets, the first of which is the entry."""


def rules_of(convention: Convention, head_degrees: float | None = None) -> Rules:
    """The rules of that name, with another head if one is given."""
    rules = GEMRAY if convention == "gemray" else Rules()
    return rules if head_degrees is None else Rules(head_degrees, rules.glare, rules.bounces, rules.cutoff)

"""A cutter's design cut anew: its tiers, names and notes kept, with the angles and distances that result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from culet.errors import InputError
from culet.geometry.cutting.recut import TABLE, recut_planes, said_of
from culet.geometry.designs.design import Design, PlaneRow, Tier
from culet.geometry.designs.grouping import tier_of
from culet.geometry.designs.solid import Solid
from culet.scene.recut import Recut, TierAngles

MOST_HEADINGS = 4
"""Lines that GemCad has for them."""
SHOWN = 0.005
"""Degrees; less is not seen in what is printed."""


def recut_design(design: Design, recut: Recut) -> Design:
    """The design; each facet once. MeshError names the proportion that cannot be, or says where the design is open."""
    if not recut.changes:
        return design
    solid = Solid(design)
    planes, gone = recut_planes("the design", solid.cut.planes, recut, [number for number, _ in solid.facets])
    listed: list[PlaneRow] = [(x, y, z, d) for x, y, z, d in planes.tolist()]
    tiers: list[Tier] = []
    for number, tier in enumerate(design.tiers, 1):
        own = [k for k, (of, _) in enumerate(solid.facets) if of == number]
        if own:
            names = [solid.facets[k][1].name for k in own]
            tiers.append(tier_of([listed[k] for k in own], names, design.wheel, tier.notes))
    tiers += [tier_of([plane], [TABLE], design.wheel) for plane in listed[len(solid.facets) :]]
    headings = (*design.headings[: MOST_HEADINGS - 1], words_of(recut))
    return replace(design, tiers=tuple(tiers), headings=headings, findings=(*design.findings, *said_of(gone)))


def words_of(recut: Recut) -> str:
    """How a design was cut anew, for a heading."""
    said = [
        f"{name} x {ratio:.5g}"
        for name, ratio in (("crown", recut.crown_ratio), ("pavilion", recut.pavilion_ratio))
        if ratio != 1
    ]
    percents = (("girdle", recut.girdle_percent), ("table", recut.table_percent))
    said += [f"{name} {percent:.5g} %" for name, percent in percents if percent is not None]
    said += [f"tier {tier} at {degrees:.5g}" for tier, degrees in sorted(recut.angles.items())]
    return f"Cut anew: {', '.join(said)}"


def angles_of(design: Design, texts: Sequence[str]) -> dict[int, float]:
    """Of TIER=DEGREES, a tier by its number or else its name; InputError for what is neither."""
    numbers = {str(number): number for number in range(1, len(design.tiers) + 1)}
    for number, tier in enumerate(design.tiers, 1):
        numbers.setdefault(tier.name, number)  # the first of a name
    found: dict[int, float] = {}
    for text in texts:
        name, _, said = (part.strip() for part in text.rpartition("="))
        if name not in numbers:
            known = ", ".join(f"{number} ({tier.name})" for number, tier in enumerate(design.tiers, 1))
            raise InputError(f"angle: expected TIER=DEGREES of a tier of {known:.400}; got {text!r:.40}", "angle")
        try:
            degrees = float(said)
        except ValueError:
            raise InputError(f"angle: expected degrees after {name}=, got {said!r:.40}", "angle") from None
        if numbers[name] in found:
            raise InputError(f"angle: expected each tier once, got {name} again", "angle")
        found[numbers[name]] = degrees
    return found


def angles_that_followed(given: Design, cut: Design, recut: Recut) -> list[str]:
    """A sentence for each angle that nobody asked for and that changed so that meets are kept."""
    if not recut.angles:
        return []
    numbers = sorted({number for number, _ in Solid(given).facets})  # a tier that repeats another is not cut anew
    first = recut_design(given, recut.model_copy(update={"angles": TierAngles()}))
    before = [given.tiers[number - 1] for number in numbers] if first is given else first.tiers
    return [
        f"Tier {number} ({new.name}) followed from {old.angle:.2f} to {new.angle:.2f} degrees."
        for number, old, new in zip(numbers, before, cut.tiers, strict=False)  # a table that was added has no number
        if number not in recut.angles and abs(old.angle - new.angle) > SHOWN
    ]

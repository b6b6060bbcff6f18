"""A design as tables on a terminal."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table

from culet.geometry.designs.design import Tier
from culet.geometry.designs.measures import proportions_of
from culet.geometry.designs.proportions import Proportions
from culet.geometry.designs.solid import Solid


def print_design(console: Console, solid: Solid) -> None:
    """Headings, tiers in the order of cutting, proportions, findings, footnotes."""
    design = solid.design
    for heading in design.headings:
        console.print(heading, markup=False, highlight=False)
    table = Table(box=box.SIMPLE_HEAD)
    for column in ("tier", "name", "side", "angle", "distance", "facets", "indices", "notes"):
        table.add_column(column, justify="right" if column in ("tier", "angle", "distance", "facets") else "left")
    for number, tier in enumerate(design.tiers, 1):
        table.add_row(
            str(number), _plain(tier.name), tier.side, f"{tier.angle:.2f}", f"{tier.distance:.6g}",
            str(len(tier.facets)), indices_of(tier), _plain(tier.notes),
        )  # fmt: skip
    console.print(table)
    for name, value in listing(proportions_of(solid)):
        console.print(f"{name:24}{value}", markup=False, highlight=False)
    for finding in solid.findings():
        console.print(finding, markup=False, highlight=False, soft_wrap=True)
    for footnote in design.footnotes:
        console.print(footnote, markup=False, highlight=False)


def listing(found: Proportions) -> list[tuple[str, str]]:
    """What a diagram prints, in words and figures."""
    lines = [
        ("facets", str(found.facets)),
        ("corners, edges", f"{found.corners}, {found.edges}"),
        ("L/W", f"{found.length_by_width:.4f}"),
        ("H/W", f"{found.height_by_width:.4f}"),
        ("volume / W^3", f"{found.volume_factor:.4f}"),
    ]
    parts = (("T/W", found.table_percent), ("C/W", found.crown_percent), ("G/W", found.girdle_percent),
             ("P/W", found.pavilion_percent))  # fmt: skip
    return lines + [(name, f"{percent / 100:.4f}") for name, percent in parts if percent is not None]


def indices_of(tier: Tier) -> str:
    """Of its facets in their order; a level facet has none."""
    return "" if tier.angle == 0 else " ".join(f"{facet.index:g}" for facet in tier.facets)


def _plain(text: str) -> str:
    """Brackets are markup to the terminal's library."""
    return text.replace("[", r"\[")

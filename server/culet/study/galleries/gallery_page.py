"""docs/reference/gallery.md: a picture of every preset, and the table of what each measures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import PIL.Image

from culet.study.galleries.gallery import QUALITY, SHOWN_WIDTH, WANTED, ShownPreset

HEAD = """# Gallery

Every preset, as `culet render --preset NAME` draws it. `culet study gallery` makes this page, its pictures and the
first picture of the README.
"""
EXPLAINED = """## What they measure

Of the stone's pixels, as a screen shows them, at 1280x720 (instruments 720x720): mean lightness L*, its 5th, 50th and
95th percentile, parts that are dark, clipped and of fire, `hot` fire that nobody overlooks, the part of the fire that
is isolated pixels, Michelson contrast of neighbouring facets, median chroma C*, and L* around the stone. `falling` is
the mean of six moments of its flight at 640x360. `server/culet/study/galleries/appearance.py` has the definitions.
**Bold** is what a preset is held to, by tests too.
"""
COLUMNS = {
    "lightness": ("L*", "{:.1f}"), "low": ("5 %", "{:.0f}"), "median": ("50 %", "{:.0f}"), "high": ("95 %", "{:.0f}"),
    "dark": ("dark", "{:.1%}"), "clipped": ("clipped", "{:.2%}"), "michelson": ("Michelson", "{:.3f}"),
    "fire": ("fire", "{:.1%}"), "hot": ("hot", "{:.1%}"), "isolated": ("isolated", "{:.0%}"),
    "chroma": ("C*", "{:.0f}"), "surround": ("around", "{:.0f}"),
}  # fmt: skip
COLOUR_CODED = ("aset", "ideal-scope")
"""Presets whose colours say where light comes from."""
INSTRUMENTS = {"red": "red", "pure_red": "pure red", "green": "green", "blue": "blue"}


def write_gallery(folder: Path, seen: Sequence[ShownPreset]) -> Path:
    """gallery.md and gallery/NAME.jpg in that folder, and the default's picture as default.png; returns the page."""
    pictures = folder / "gallery"
    pictures.mkdir(parents=True, exist_ok=True)
    for each in seen:
        image = PIL.Image.fromarray(each.picture)
        if each.preset.name == "default":
            smaller(image).save(folder / "default.png", optimize=True)
        smaller(image).save(pictures / f"{each.preset.name}.jpg", quality=QUALITY, subsampling=0)
    page = folder / "gallery.md"
    page.write_text(page_of(seen), encoding="utf-8")
    return page


def smaller(image: PIL.Image.Image) -> PIL.Image.Image:
    """At most SHOWN_WIDTH wide."""
    height = round(image.height * SHOWN_WIDTH / image.width)
    return image if image.width <= SHOWN_WIDTH else image.resize((SHOWN_WIDTH, height), PIL.Image.Resampling.LANCZOS)


def page_of(seen: Sequence[ShownPreset]) -> str:
    """The page's text."""
    parts, group = [HEAD], ""
    for each in seen:
        preset = each.preset
        if preset.group != group:
            group = preset.group
            parts.append(f"## {group[0].upper()}{group[1:]}\n")
        parts.append(f"### {preset.title} (`{preset.name}`)\n\n{preset.summary}\n")
        parts.append(f"![{preset.title}](gallery/{preset.name}.jpg)\n")
    return "\n".join([*parts, EXPLAINED, _table(seen), _instruments(seen)])


def _table(seen: Sequence[ShownPreset]) -> str:
    rows = [["preset", *(title for title, _ in COLUMNS.values())], ["---"] * (len(COLUMNS) + 1)]
    rows += [
        [f"`{each.preset.name}`", *(_cell(each, name, form) for name, (_, form) in COLUMNS.items())]
        for each in seen
        if each.measures and each.preset.group != "the report" and each.preset.name not in COLOUR_CODED
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def _instruments(seen: Sequence[ShownPreset]) -> str:
    rows = [["preset", *INSTRUMENTS.values()], ["---"] * (len(INSTRUMENTS) + 1)]
    rows += [
        [f"`{each.preset.name}`", *(_cell(each, name, "{:.1%}") for name in INSTRUMENTS)]
        for each in seen
        if each.preset.name in COLOUR_CODED
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def _cell(each: ShownPreset, name: str, form: str) -> str:
    text = form.format(each.measures[name])
    return f"**{text}**" if name in WANTED.get(each.preset.name, {}) else text

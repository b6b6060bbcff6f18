"""docs/reference/cuts.md: every cut's picture, and the table of its proportions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.cuts import CUTS, TITLES, USUAL, AnyCut, summary
from culet.scene.showcase import FACE_UP
from culet.sources import with_cut
from culet.stage import Stage
from culet.study.galleries.gallery import QUALITY

SIDE, SAMPLES = 360, 32
"""Pixels of each of the two pictures, and of each pixel."""
HEAD = """# Cuts

A stone's `cut` in a scene is a name, `"oval"`, or an object with that `name` and the proportions that are not the
usual ones, `{"name": "oval", "length_to_width": 1.6}`; on the command line `--cut oval,length_to_width=1.6`. The page
has them under *Cut*, with a slider for each proportion as long as what is usual. `culet design diagram oval` draws the
cutting diagram of any of them but the heart, `culet design convert oval oval.asc` writes GemCad's file. Pictures are
diamonds, face up as by the preset `face-up` and as they lie in the atelier; `culet study cuts` makes this page and its
pictures.

Percentages without another word are of the width, the smaller extent across the table. Angles are those in the middle
of the stone's side: a longer stone is stretched along its length, so that its ends are flatter. Facets have names and
tiers; each cut has all facets that it is meant to have and no others, and proportions that leave one no room are
refused, with the one that has to change and how far it may go. All cuts but the heart are convex, and are followed by
half-spaces in the axes of their symmetry; the heart is followed as a mesh is.
"""


def write_cuts(folder: Path, renderer: Renderer) -> Iterator[Path]:
    """cuts.md and cuts/NAME.jpg in that folder; yields the files."""
    pictures = folder / "cuts"
    pictures.mkdir(parents=True, exist_ok=True)
    parts = [HEAD]
    for name, kind in CUTS.items():
        file = pictures / f"{name}.jpg"
        _picture(renderer, kind()).save(file, quality=QUALITY, subsampling=0)
        yield file
        title = TITLES[kind().name]
        parts.append(f"## {title}\n\n`{name}`. {summary(name)}\n\n![{title}](cuts/{name}.jpg)\n\n{_table(kind)}")
    page = folder / "cuts.md"
    page.write_text("\n".join(parts), encoding="utf-8")
    yield page


def _picture(renderer: Renderer, cut: AnyCut) -> PIL.Image.Image:
    """Face up, and lying in the atelier."""
    return PIL.Image.fromarray(np.hstack([_drawn(renderer, with_cut(scene, cut)) for scene in (FACE_UP, Scene())]))


def _drawn(renderer: Renderer, scene: Scene) -> np.ndarray[Any, np.dtype[np.uint8]]:
    picture = renderer.picture(Stage.of(scene), SIDE, SIDE)
    picture.refine(SAMPLES)
    return picture.rgb()


def _table(kind: type[AnyCut]) -> str:
    rows = [["proportion", "without a word", "usual", "allowed", ""], ["---"] * 5]
    for name, schema in kind.model_json_schema()["properties"].items():
        if USUAL in schema:
            least, most = schema[USUAL]
            rows.append(
                [
                    f"`{name}`",
                    f"{schema['default']:g}",
                    f"{least:g} to {most:g}",
                    _allowed(schema),
                    schema["description"],
                ]
            )
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def _allowed(schema: dict[str, Any]) -> str:
    low = f"above {schema['exclusiveMinimum']:g}" if "exclusiveMinimum" in schema else f"from {schema['minimum']:g}"
    high = f"below {schema['exclusiveMaximum']:g}" if "exclusiveMaximum" in schema else f"to {schema['maximum']:g}"
    return f"{low}, {high}" if low.startswith("above") else f"{low} {high}"

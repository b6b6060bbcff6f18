"""What docs/explanation/simulation.md says is so: the columns of a path, each once and in their order."""

from __future__ import annotations

import re
from pathlib import Path

from culet.geometry.shape import Shape
from culet.scene import Scene
from culet.simulation.recording.paths import record
from shared.stages import staged

PAGE = (Path(__file__).parents[2] / "docs/explanation/simulation.md").read_text(encoding="utf-8")


def test_the_table_of_columns_names_the_columns_of_a_path_and_no_others(brilliant: Shape) -> None:
    section = PAGE.split("\n## The path\n")[1].split("\n## ")[0]
    cells = re.findall(r"^\| (`.*?) \|", section, re.MULTILINE)
    written = [name for cell in cells for name in re.findall(r"`(\w+)`", cell)]
    assert written == list(record(staged(Scene(), brilliant), 0).columns())

"""What an engine needs first, compiled by a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from shared.patience import PATIENCE

OPEN = """
from culet.engine.process.serve import open_renderer
from culet.rendering import first_programs
from culet.rendering.light import lighting
from culet.scene import Scene
from culet.stage import Stage
if {broken}:
    first_programs.COMMAND = lighting.APART = ("false",)
renderer = open_renderer(special_programs=False)
stage = Stage.of(Scene.read({{"floor": {{"kind": "matte"}}}}))
renderer.make_ready(stage)
renderer.picture(stage, 32, 18).refine()
assert renderer.is_ready(stage)
for line in open("/proc/self/smaps_rollup"):
    if line.startswith("Anonymous:"):
        print(int(line.split()[1]))
"""


def memory(environment: Mapping[str, str], *, broken: bool = False) -> int:
    """KiB of its own that an engine's process has when it can draw a stone and its light."""
    done = subprocess.run(
        [sys.executable, "-c", OPEN.format(broken=broken)],
        env=environment, capture_output=True, text=True, check=True, timeout=PATIENCE,
    )  # fmt: skip
    return int(done.stdout)


def test_what_compilers_take_is_not_left_in_the_engine(tmp_path: Path) -> None:
    """Measured, MiB: 124 the first time, 125 the next, and 245 where other processes fail and it compiles itself."""
    cache = {name: str(tmp_path / name) for name in ("empty", "none")}
    first, again = (memory(os.environ | {"POCL_CACHE_DIR": cache["empty"]}) for _ in range(2))
    alone = memory(os.environ | {"POCL_CACHE_DIR": cache["none"]}, broken=True)
    assert first < 1.2 * again
    assert alone > again + 80 * 1024

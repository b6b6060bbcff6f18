"""Meshes made to cost much: each is read or refused in little memory, by a process like the one that reads uploads."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from geometry.shapes import exported

READ = r"""
import pathlib, re, sys
from culet.errors import InputError
from culet.geometry.mesh import shape_from_mesh
try:
    stone = shape_from_mesh(pathlib.Path(sys.argv[1]).read_bytes(), "ply")
    print("read", len(stone.planes))
except InputError as error:
    print(type(error).__name__, error)
print(int(re.search(r"VmHWM:\s+(\d+) kB", pathlib.Path("/proc/self/status").read_text())[1]) // 1024)
"""
"""What a mesh comes to, and the most memory that reading took, MiB: VmHWM of proc(5). ru_maxrss of getrusage(2) is at
least the peak of the process that started this one, here that of all earlier tests."""


def spikes() -> trimesh.Trimesh:
    """A ball whose every corner is at a distance of its own: thin triangles, all from near the centre outward."""
    ball = trimesh.creation.icosphere(subdivisions=6)
    far = np.random.default_rng(1).uniform(0.01, 1, len(ball.vertices))
    return trimesh.Trimesh(ball.vertices * far[:, None], ball.faces, process=False)


def torus() -> trimesh.Trimesh:
    ring: trimesh.Trimesh = trimesh.creation.torus(1, 0.4, major_sections=310, minor_sections=320)
    return ring


@pytest.mark.parametrize(
    ("mesh", "outcome", "mebibytes"),
    [
        (
            spikes,
            "TooLargeError the mesh cannot be checked for crossing faces: its 81920 triangles",
            320,
        ),  # measured 160
        (torus, "read 99", 420),  # measured 210
    ],
)
def test_the_worst_meshes_known_take_little_memory(
    mesh: Callable[[], trimesh.Trimesh], outcome: str, mebibytes: int, tmp_path: Path
) -> None:
    """They took 3425 and 696 MiB when the pairs of boxes of a level were all held at once."""
    file = tmp_path / "mesh.ply"
    file.write_bytes(exported(mesh(), "ply"))
    done = subprocess.run([sys.executable, "-c", READ, str(file)], capture_output=True, text=True, check=True)
    said, peak = done.stdout.splitlines()
    assert said.startswith(outcome)
    assert int(peak) < mebibytes

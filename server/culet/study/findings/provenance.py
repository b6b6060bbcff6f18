"""What a figure was measured on: without it no figure can be compared with another."""

from __future__ import annotations

import contextlib
import hashlib
import platform
import subprocess
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path

import culet_kernels
from culet.version import __version__

IMAGE_CODE = ("geometry", "optics", "rendering", "scene", "stage.py")
"""Packages and modules whose code decides what a picture looks like, besides the kernels."""
REFERENCE_CODE = (
    *IMAGE_CODE,
    "study/renderer/shot.py",
    "study/renderer/knobs.py",
    "study/renderer/reference.py",
    "study/renderer/renderers.py",
)
"""What a kept reference depends on: not on how others are judged by it."""
RENDERING_STUDY = (*IMAGE_CODE, "study")
"""What the points of each study depend on."""
CAUSTICS_STUDY = RENDERING_STUDY
GROWTH_STUDY = (*RENDERING_STUDY, "engine", "gateway", "service", "simulation")
SIMULATION_STUDY = ("geometry", "scene", "simulation", "stage.py", "study")
STREAMING_STUDY = (*RENDERING_STUDY, "simulation")

SOURCES = (".py", ".c", ".h")

PEERS = ("mitsuba", "numpy", "pillow", "pyopencl", "scikit-image", "scipy", "simplejpeg")
"""Packages of others that are measured, or measure."""


@cache
def commit() -> str:
    """Of the checkout that runs, `-dirty` if it was changed; or `unknown`."""
    try:
        result = subprocess.run(
            ["git", "describe", "--always", "--dirty"],  # noqa: S607
            cwd=Path(__file__).parent, capture_output=True, text=True, check=True,
        )  # fmt: skip
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return result.stdout.strip()


def processor() -> str:
    """The processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


@cache
def code_digest(names: tuple[str, ...]) -> str:
    """Of the kernels and of these packages and modules of culet as they are on the disk, committed or not."""
    digest = hashlib.sha256()
    for name in culet_kernels.NAMES:
        digest.update(culet_kernels.source(name).encode())
    root = Path(__file__).parents[2]
    for name in names:
        place = root / name
        for path in sorted(p for p in place.rglob("*") if p.suffix in SOURCES) if place.is_dir() else [place]:
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def peer_versions() -> str:
    """Of PEERS, those that are installed."""
    found = []
    for name in PEERS:
        with contextlib.suppress(metadata.PackageNotFoundError):
            found.append(f"{name} {metadata.version(name)}")
    return ", ".join(found)


def provenance(device: Mapping[str, str | int]) -> dict[str, str | int]:
    """Version, commit, machine and what the device says of itself."""
    return {
        "version": __version__,
        "commit": commit(),
        "processor": processor(),
        "system": platform.platform(),
        "python": platform.python_version(),
        **device,
    }

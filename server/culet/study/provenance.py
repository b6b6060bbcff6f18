"""What a figure was measured on: without it no figure can be compared with another."""

from __future__ import annotations

import hashlib
import platform
import subprocess
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import culet
import culet_kernels

IMAGE_PACKAGES = ("geometry", "optics", "rendering", "scene")
"""Whose code decides what a picture looks like, besides the kernels."""
MOTION_PACKAGES = ("geometry", "scene", "simulation")
"""And how a stone moves."""


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
def code_digest(packages: tuple[str, ...]) -> str:
    """Of the kernels and of these packages as they are on the disk, committed or not."""
    digest = hashlib.sha256()
    for name in culet_kernels.NAMES:
        digest.update(culet_kernels.source(name).encode())
    root = Path(culet.__file__).parent
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def provenance(device: Mapping[str, str | int]) -> dict[str, str | int]:
    """Version, commit, machine and what the device says of itself."""
    return {
        "version": culet.__version__,
        "commit": commit(),
        "processor": processor(),
        "system": platform.platform(),
        "python": platform.python_version(),
        **device,
    }

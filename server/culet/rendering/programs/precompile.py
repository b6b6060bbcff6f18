"""Makes one program in a process of its own, so that the driver's cache has it when this process asks."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from culet.rendering.features import Features
from culet.rendering.opencl.apart import ordered, run_apart
from culet.rendering.opencl.device import open_device
from culet.rendering.programs.build import Variant, make

COMMAND = (sys.executable, "-m", __name__)
"""The process, which takes the order as its argument."""


def precompile(features: Features, variant: Variant, *, urgent: bool = False) -> bool:
    """Start a process that makes the program, and wait for it; whether it did. DeviceError if it does not end.

    If it fails, the caller's own build will say why.
    """
    return in_a_process(COMMAND, features, variant, urgent=urgent)


def in_a_process(begins: Sequence[str], features: Features, variant: Variant, *, urgent: bool) -> bool:
    """The same by any command whose `main` takes the order: `program_ordered`."""
    order = {
        "features": asdict(features),
        "variant": {**asdict(variant), "real": np.dtype(variant.real).name},
    }
    return run_apart(begins, order, urgent=urgent)


def program_ordered() -> tuple[Features, Variant]:
    """What this process was started for; it ends with the one that wants it."""
    order = ordered()
    variant = Variant(**{**order["variant"], "real": np.dtype(order["variant"]["real"]).type})
    return Features(**order["features"]), variant


def main() -> None:
    """Entry of that process."""
    make(open_device(), *program_ordered())


if __name__ == "__main__":
    main()

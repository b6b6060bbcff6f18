"""Makes one program in a process of its own, so that the driver's cache has it when this process asks.

A driver compiles under a lock that launches need too: in the same process, frames would wait for the compiler.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from culet.errors import DeviceError
from culet.parent import ending_with
from culet.rendering.features import Features
from culet.rendering.opencl.device import open_device
from culet.rendering.programs.build import Variant, make

NICENESS = 10
"""Of the compiling process, unless somebody waits for it: frames come first."""
MOST_SECONDS = 600.0
"""After which the compiler counts as hung. Programs take some 3 s of a core, measured, and more where many share it."""
COMMAND = (sys.executable, "-m", __name__)
"""The process, which takes the order as its argument."""


def precompile(features: Features, variant: Variant, *, urgent: bool = False) -> bool:
    """Start a process that makes the program, and wait for it; whether it did. DeviceError if it does not end.

    If it fails, the caller's own build will say why.
    """
    return in_a_process(COMMAND, features, variant, urgent=urgent)


def in_a_process(begins: Sequence[str], features: Features, variant: Variant, *, urgent: bool) -> bool:
    """The same by any command whose `main` takes the order: `ordered`."""
    order = {
        "features": asdict(features),
        "variant": {**asdict(variant), "real": np.dtype(variant.real).name},
        "parent": os.getpid(),
    }
    command = ["nice", "-n", str(0 if urgent else NICENESS), *begins, json.dumps(order)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=MOST_SECONDS)  # noqa: S603
    except subprocess.TimeoutExpired:
        raise DeviceError(f"the compiler did not end within {MOST_SECONDS:g} s") from None
    return done.returncode == 0


def ordered() -> tuple[Features, Variant]:
    """What this process was started for; it ends with the one that wants it."""
    order = json.loads(sys.argv[1])
    ending_with(order["parent"])()  # nobody needs the program any more
    variant = Variant(**{**order["variant"], "real": np.dtype(order["variant"]["real"]).type})
    return Features(**order["features"]), variant


def main() -> None:
    """Entry of that process."""
    make(open_device(), *ordered())


if __name__ == "__main__":
    main()

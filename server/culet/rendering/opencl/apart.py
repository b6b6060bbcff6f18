"""What is done in a process of its own, so that its memory and its driver's locks are not this one's.

A compiler leaves some 150 MiB in the process in which it has been at work, and PoCL compiles under a lock that launches
need too. What such a process has compiled this one finds in the driver's cache.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from culet.errors import DeviceError
from culet.parent import ending_with

NICENESS = 10
"""Of the compiling process, unless somebody waits for it: frames come first."""
MOST_SECONDS = 600.0
"""After which the compiler counts as hung. Programs take some 3 s of a core, and longer on what is left of one."""
URGENT_SECONDS = 120.0
"""The same where somebody waits for it, and all others that need a program. It may wait for another process first
(`making.LONGEST_WAIT`)."""


def run_apart(begins: Sequence[str], order: Mapping[str, object], data: bytes = b"", *, urgent: bool = True) -> bool:
    """Run a command whose process calls `ordered`, with an order of JSON's types and data on its standard input, and
    wait for it; whether it succeeded. DeviceError if it does not end.

    If it fails, or cannot be begun, whoever does the same in this process will hear why.
    """
    whole = json.dumps({**order, "parent": os.getpid()})
    most = URGENT_SECONDS if urgent else MOST_SECONDS
    command = ["nice", "-n", str(0 if urgent else NICENESS), *begins, whole]
    try:
        done = subprocess.run(command, input=data, capture_output=True, check=False, timeout=most)  # noqa: S603
    except subprocess.TimeoutExpired:
        raise DeviceError(f"the compiler did not end within {most:g} s") from None
    except OSError:  # without memory, or a process more
        return False
    return done.returncode == 0


def ordered() -> dict[str, Any]:
    """What this process was started for; it ends with the one that wants it."""
    order: dict[str, Any] = json.loads(sys.argv[1])
    ending_with(order["parent"])()  # nobody needs the program any more
    return order

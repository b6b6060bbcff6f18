"""A process that does not outlive the one that started it, however that ends (Linux only)."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Callable

PR_SET_PDEATHSIG = 1
"""linux/prctl.h: the signal a process gets when the thread that started it ends, and so its parent."""


def ending_with(parent: int) -> Callable[[], None]:
    """What a process calls to be killed when the parent with that process id ends; at once if it has ended already.

    The library is loaded here: between fork and exec only the call itself may be made safely.
    """
    if sys.platform != "linux":
        return lambda: None
    prctl = ctypes.CDLL(None, use_errno=True).prctl

    def ask_the_kernel() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # it ended before the call: no signal would come
            os._exit(1)

    return ask_the_kernel

"""Holds threads of the engine by ptrace(2), as a driver or a library that never returns would, until it has ended.

python3 - loop|rendering < hold_threads.py, in a container that shares the engine's processes and may trace them. No
library but Python's own, since an image may have nothing else.
"""

import ctypes
import os
import pathlib
import signal
import sys
import time

PTRACE_SEIZE, PTRACE_INTERRUPT = 0x4206, 0x4207
"""linux/ptrace.h."""
WALL = 0x40000000
"""__WALL of linux/wait.h: threads too."""
START_TIME = 22
"""Field of /proc/PID/stat, counted from 1: ticks since the machine's start; proc(5)."""
LONG_SECONDS = 3.0
"""The watchdog's own thread is made anew every half second, and so never as old."""
LIMIT_SECONDS = 400


def engine() -> int:
    """The engine's process: of those that began by standing by the eldest, as another one stands by now."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        words = (folder / "cmdline").read_bytes().split(b"\0")
        if b"engine" in words and b"--stand-by" in words:
            found.append((-age(folder), int(folder.name)))
    if not found:
        raise SystemExit("there is no engine")
    return min(found)[1]


def age(task: pathlib.Path) -> float:
    """Seconds since a process's or thread's start."""
    after_name = (task / "stat").read_text().rpartition(") ")[2].split()
    started = int(after_name[START_TIME - 3]) / os.sysconf("SC_CLK_TCK")
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started


def threads(pid: int, which: str) -> list[int]:
    """The loop's is the first; what renders are all others, but ZeroMQ's and the watchdog's."""
    if which == "loop":
        return [pid]
    tasks = [task for task in pathlib.Path(f"/proc/{pid}/task").iterdir() if task.name != str(pid)]
    return [
        int(task.name)
        for task in tasks
        if not (task / "comm").read_text().startswith("ZMQ") and age(task) > LONG_SECONDS
    ]


def main() -> None:
    """Hold them."""
    signal.alarm(LIMIT_SECONDS)
    libc = ctypes.CDLL(None, use_errno=True)
    libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    libc.ptrace.restype = ctypes.c_long
    held = threads(engine(), sys.argv[1])
    for thread in held:
        for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
            if libc.ptrace(request, thread, None, None) != 0:
                raise OSError(ctypes.get_errno(), "a thread cannot be held")
    print(f"holding {len(held)}", flush=True)
    while True:
        try:
            os.waitpid(-1, WALL)
        except ChildProcessError:
            return


if __name__ == "__main__":
    main()

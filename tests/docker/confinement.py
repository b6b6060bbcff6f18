"""What a container may do, as it is seen from within: by programs that all images have, as the container's own user."""

from __future__ import annotations

import json

from docker.claims import check
from docker.containers import Container

LIMITS = {"pids": ("pids.max", "pids/pids.max"), "memory": ("memory.max", "memory/memory.limit_in_bytes")}
"""Files below /sys/fs/cgroup, by version 2 and 1 of control groups."""
LOG_BYTES = {"10m": 10 << 20}
MEMORY = "from culet.engine.capacity.machine import memory_of_machine; print(memory_of_machine())"


async def check_confined(container: Container, name: str, *, culet: bool = True) -> None:
    """Its processes are nobody's, can write nowhere but where they must, and have limits. `culet`: the image has it."""
    status = dict(line.split(":", 1) for line in (await container.run("cat", "/proc/1/status")).splitlines())
    check(0 not in map(int, status["Uid"].split()), f"{name}: nobody is root")
    check(int(status["CapBnd"], 16) == 0, f"{name}: there are no capabilities to be had")
    check(int(status["NoNewPrivs"]) == 1, f"{name}: no program gives privileges")
    check(int(status["Seccomp"]) == 2, f"{name}: calls of the system are filtered")
    for folder in ("/", "/opt", "/etc"):
        refused = await container.run("sh", "-c", f"touch {folder}/written 2>&1 || true")
        check("Read-only file system" in refused, f"{name}: {folder} cannot be written to")
    host = (await container.inspect())["HostConfig"]
    for limit, given in (("pids", host["PidsLimit"]), ("memory", host["Memory"])):
        if not given:
            check(False, f"{name}: {limit} has a limit")
        paths = [f"/sys/fs/cgroup/{path}" for path in LIMITS[limit]]
        read = " || ".join(f"cat {path} 2>/dev/null" for path in paths)
        check(
            int(await container.run("sh", "-c", read)) == given, f"{name}: {limit} has the limit {given}, by the kernel"
        )
    if culet:
        seen = int(await container.python(MEMORY))
        check(seen == host["Memory"], f"{name}: culet sees its limit of memory, {seen >> 20} MiB")
    log = host["LogConfig"]
    rotates = log["Type"] == "json-file" and int(log["Config"]["max-file"]) * LOG_BYTES[log["Config"]["max-size"]]
    check(0 < rotates <= 30 << 20, f"{name}: its log is never larger than {rotates >> 20} MiB: {json.dumps(log)}")

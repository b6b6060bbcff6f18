"""Two network namespaces joined by a link of some rate, delay and queue: what is sent by real TCP is held back here.

    python shaped_link.py

A TUN device in each namespace hands this process the packets, which go out on the other side when a line of that rate
would have carried them, and so much later as it is long. Each line on standard input is a link, from then on:
{"megabits": 2, "milliseconds": 150, "kilobytes": 64}. The link ends with its input. On standard output comes one line
when it is up: the files of the two namespaces.
"""

from __future__ import annotations

import collections
import fcntl
import json
import os
import select
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).parent.parent))
from network import namespaces
from shared.patience import PATIENCE

SERVER, VIEWER = "10.77.0.1", "10.77.0.2"
"""Addresses of the two ends."""
TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
"""linux/if_tun.h"""
SIOCSIFFLAGS, SIOCSIFADDR, SIOCSIFNETMASK, IFF_UP = 0x8914, 0x8916, 0x891C, 0x1
"""linux/sockios.h, linux/if.h"""
DEVICE = "/dev/net/tun"
CONGESTION_CONTROL = "/proc/sys/net/ipv4/tcp_congestion_control"
"""Every kernel has Reno. BBR, the default of some, stops for 0.4 s in each ten to measure the way without a queue."""
FRAMING_BYTES = 14
"""Of Ethernet, which a line carries with each packet."""
PACKET = 65536


@dataclass(frozen=True)
class Shape:
    """Of a link."""

    megabits: float
    """A second, each way."""
    milliseconds: float
    """There and back."""
    kilobytes: float
    """That wait in a queue, each way."""


class Line:
    """One direction."""

    def __init__(self) -> None:
        self._packets: collections.deque[tuple[float, bytes]] = collections.deque()
        self._free_at = 0.0

    def take(self, packet: bytes, shape: Shape, now: float) -> None:
        """A packet is to go over, unless the queue is full."""
        rate = shape.megabits * 1e6 / 8
        start = max(self._free_at, now)
        if (start - now) * rate > shape.kilobytes * 1000:
            return
        self._free_at = start + (len(packet) + FRAMING_BYTES) / rate
        self._packets.append((self._free_at + shape.milliseconds / 2e3, packet))

    def arrived(self, now: float) -> Iterator[bytes]:
        """Packets that have come over."""
        while self._packets and self._packets[0][0] <= now:
            yield self._packets.popleft()[1]

    def next_at(self) -> float:
        """When the next packet arrives."""
        return self._packets[0][0] if self._packets else float("inf")


class SharedShape:
    """Of the link, as it is now."""

    def __init__(self) -> None:
        self.shape = Shape(1000, 0, 1000)
        self.over = False

    def follow(self) -> None:
        """Standard input, until its end."""
        for line in sys.stdin:
            self.shape = Shape(**json.loads(line))
        self.over = True


def serve() -> None:
    """Set up the link, and carry packets until standard input ends."""
    ends: dict[str, tuple[str, int]] = {}
    problems: list[OSError] = []

    def make(address: str) -> None:
        try:
            ends[address] = _end(address)
        except OSError as error:
            problems.append(error)

    for address in (SERVER, VIEWER):
        thread = threading.Thread(target=make, args=(address,))
        thread.start()
        thread.join()
    if problems:
        sys.exit(str(problems[0]))
    print(json.dumps([ends[SERVER][0], ends[VIEWER][0]]), flush=True)
    devices, lines, shared = [ends[SERVER][1], ends[VIEWER][1]], [Line(), Line()], SharedShape()
    threading.Thread(target=shared.follow, daemon=True).start()
    while not shared.over:
        now = time.monotonic()
        wait = min(0.05, max(0.0, min(line.next_at() for line in lines) - now))
        ready, _, _ = select.select(devices, [], [], wait)
        now = time.monotonic()
        for device in ready:
            for packet in _read(device):
                lines[devices.index(device)].take(packet, shared.shape, now)
        for side, line in enumerate(lines):
            for packet in line.arrived(now):
                os.write(devices[1 - side], packet)


def _read(device: int) -> Iterator[bytes]:
    while True:
        try:
            yield os.read(device, PACKET)
        except BlockingIOError:
            return


def _end(address: str) -> tuple[str, int]:
    """A new namespace with a TUN device of that address: its file, and the device."""
    namespaces.leave()
    held = os.open("/proc/thread-self/ns/net", os.O_RDONLY)
    Path(CONGESTION_CONTROL).write_text("reno")
    device = os.open(DEVICE, os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH22x", b"t0", IFF_TUN | IFF_NO_PI))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        fcntl.ioctl(control, SIOCSIFFLAGS, struct.pack("16sH22x", b"lo", IFF_UP))
        for request, numbers in ((SIOCSIFADDR, address), (SIOCSIFNETMASK, "255.255.255.0")):
            fcntl.ioctl(
                control, request, struct.pack("16sHH4s8x8x", b"t0", socket.AF_INET, 0, socket.inet_aton(numbers))
            )
        fcntl.ioctl(control, SIOCSIFFLAGS, struct.pack("16sH22x", b"t0", IFF_UP))
    return f"/proc/{os.getpid()}/fd/{held}", device


@dataclass(frozen=True)
class Link:
    """A running link."""

    server: str
    """File of the server's namespace."""
    viewer: str
    """Of the viewer's."""
    process: subprocess.Popen[str]

    def become(self, shape: Shape) -> None:
        """Another link, from now on."""
        assert self.process.stdin is not None
        print(json.dumps(asdict(shape)), file=self.process.stdin, flush=True)


def missing() -> str | None:
    """Why there can be no such link here; None if there can."""
    if not Path(DEVICE).exists():
        return f"shaped links need {DEVICE}"
    tried = subprocess.run(
        [sys.executable, str(Path(__file__))], check=False, input="", capture_output=True, text=True, timeout=PATIENCE
    )
    if tried.returncode == 0:
        return None
    return f"shaped links need CAP_NET_ADMIN and CAP_SYS_ADMIN: {tried.stderr.splitlines()[-1]}"


@contextmanager
def running_link(shape: Shape) -> Iterator[Link]:
    """A link between two new namespaces, which end with it."""
    command = [sys.executable, str(Path(__file__))]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        try:
            server, viewer = json.loads(process.stdout.readline())
            link = Link(server, viewer, process)
            link.become(shape)
            yield link
        finally:
            process.stdin.close()
            process.wait(PATIENCE)


if __name__ == "__main__":
    serve()

"""Exit code 0 if the engine of this container answers: it greets whoever connects to its control socket."""

from __future__ import annotations

import sys

import zmq

CONTROL = "tcp://127.0.0.1:5555"
PATIENCE_MS = 3000


def main() -> int:
    """Connect with a probe and wait for the greeting."""
    socket = zmq.Context().socket(zmq.DEALER)
    socket.setsockopt(zmq.LINGER, 0)
    socket.setsockopt(zmq.PROBE_ROUTER, 1)
    socket.connect(CONTROL)
    return 0 if socket.poll(PATIENCE_MS) else 1


if __name__ == "__main__":
    sys.exit(main())

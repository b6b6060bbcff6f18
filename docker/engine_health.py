"""Exit code 0 if the engine of this container makes pictures: a small one is asked for at its control socket."""

from __future__ import annotations

import json
import struct
import sys
import time

import zmq

CONTROL = "tcp://127.0.0.1:5555"
PATIENCE_SECONDS = 20
"""Pictures of others come first, one of each at a time."""
NUMBER = struct.pack("<Q", 1)
PICTURE = {"type": "render", "scene": {}, "width": 16, "height": 16, "samples": 1, "format": "png", "client": "health"}
BUSY = 429
"""So many wait for pictures that there is no place: it works."""


def main() -> int:
    """Ask for a picture, and pass over what the engine tells unasked."""
    end = time.monotonic() + PATIENCE_SECONDS
    with zmq.Context() as context, context.socket(zmq.DEALER) as socket:
        socket.setsockopt(zmq.LINGER, 0)
        socket.connect(CONTROL)
        socket.send_multipart([NUMBER, json.dumps(PICTURE).encode()])
        while socket.poll(max(0.0, end - time.monotonic()) * 1000):
            number, said, *data = socket.recv_multipart()
            if number == NUMBER:
                made = bool(data) and data[0].startswith(b"\x89PNG\r\n\x1a\n")
                return 0 if made or json.loads(said)["status"] == BUSY else 1
    return 1


if __name__ == "__main__":
    sys.exit(main())

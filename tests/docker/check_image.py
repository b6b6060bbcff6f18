"""What must be had from the image that is all in one. `make compose-test` calls this.

PYTHONPATH=tests python -m docker.check_image 127.0.0.1:8000
"""

from __future__ import annotations

import io
import sys
import time

import httpx
from PIL import Image

PATIENCE = 240.0
"""Seconds until it is ready: kernels are compiled first."""


def main(address: str) -> None:
    """Fails if something is missing."""
    with httpx.Client(base_url=f"http://{address}", timeout=PATIENCE, follow_redirects=True) as http:
        _until_ready(http)
        assert "<canvas" in http.get("/").raise_for_status().text, "the page"
        assert "<script" in http.get("/docs").raise_for_status().text, "the page of the interface"
        small = {"width": 64, "height": 36, "samples": 1}  # a machine that does much else is slow, and that is no fault
        still = http.get("/api/render.png", params=small).raise_for_status()
        assert Image.open(io.BytesIO(still.content)).size == (64, 36)
        session = http.post("/api/sessions", json={"preset": "trio"}).raise_for_status().json()["id"]
        frame = http.get(f"/api/sessions/{session}/frame.webp", params=small).raise_for_status()
        assert frame.content[8:12] == b"WEBP"
    print("the image serves page, interface, stills and sessions")


def _until_ready(http: httpx.Client) -> None:
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            if http.get("/readyz").status_code == 200:
                return
        except httpx.TransportError:
            pass  # nothing listens yet
        assert time.monotonic() < deadline, f"not ready within {PATIENCE:g} s"
        time.sleep(0.1)  # between two looks at another container


if __name__ == "__main__":
    main(sys.argv[1])

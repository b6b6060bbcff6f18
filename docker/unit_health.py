"""Exit code 0 if this container's server makes pictures: a small one is asked for through gateway and engine."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

PICTURE = "http://127.0.0.1:8000/api/render.png?width=16&height=16&samples=1"
PATIENCE_SECONDS = 20
"""Pictures of others come first, one of each at a time."""
BUSY = 429
"""So many wait for pictures that there is no place: it works."""


def main() -> int:
    """Ask for a picture, with the token that the server has, if it has one."""
    token = _token()
    request = Request(PICTURE, headers={"Authorization": f"Bearer {token}"} if token else {})
    try:
        with urlopen(request, timeout=PATIENCE_SECONDS) as answer:  # noqa: S310 - the constant above
            return 0 if answer.read(8) == b"\x89PNG\r\n\x1a\n" else 1
    except HTTPError as refused:
        return 0 if refused.code == BUSY else 1
    except (URLError, TimeoutError):
        return 1


def _token() -> str | None:
    """One that was made when the server was started stands in a file alone."""
    file = os.environ.get("CULET_TOKEN_FILE")
    if file is not None and Path(file).is_file():
        return Path(file).read_text(encoding="ascii")
    return os.environ.get("CULET_TOKEN")


if __name__ == "__main__":
    sys.exit(main())

"""Exit code 0 if the web process of this container answers.

Not whether the engine does (/readyz tells): the gateway waits for a new engine with all sessions in its hands, and must
not be taken for ill meanwhile.
"""

from __future__ import annotations

import sys
from http import HTTPStatus
from urllib.error import HTTPError, URLError
from urllib.request import urlopen


def main() -> int:
    """Ask /healthz."""
    try:
        with urlopen("http://127.0.0.1:8000/healthz", timeout=3) as answer:
            return 0 if answer.status == 200 else 1
    except HTTPError as answer:
        return 0 if answer.code == HTTPStatus.UNAUTHORIZED else 1  # its owner keeps health to those with the token
    except (URLError, TimeoutError):
        return 1


if __name__ == "__main__":
    sys.exit(main())

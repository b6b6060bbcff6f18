"""Exit code 0 if this container's scheduler greets a client that shows the certificate of Dask's configuration."""

from __future__ import annotations

import sys

from distributed import Client

ADDRESS = "tls://127.0.0.1:8786"
PATIENCE_SECONDS = 15


def main() -> int:
    """Connect, and leave again."""
    try:
        with Client(ADDRESS, timeout=PATIENCE_SECONDS, set_as_default=False):
            return 0
    except OSError:
        return 1


if __name__ == "__main__":
    sys.exit(main())

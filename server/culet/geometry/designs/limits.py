"""How much a reader of designs takes on before it refuses."""

from __future__ import annotations

from culet.errors import TooLargeError

MOST_BYTES = 4 << 20
"""Of a file; one of 300 facets has 20 KiB."""

MOST_FACETS = 2000
"""Public designs have up to 304. The worst that is known of so many, all in one corner, takes half a second."""

LARGEST_DISTANCE = 1e9
"""Of a facet, in the file's own units: with the smallest distances that files are written in, 1e-8, more would leave
double precision nothing of the stone."""


def check_facets(count: int) -> None:
    """TooLargeError if there are more."""
    if count > MOST_FACETS:
        raise TooLargeError(f"expected at most {MOST_FACETS} facets, got {count} or more")

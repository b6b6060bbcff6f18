"""One `culet serve` for the small trials of a module, and one of their own for those that break it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from hostile.serving import Serving


@pytest.fixture(scope="module")
def serving() -> Iterator[Serving]:
    with Serving() as running:
        yield running

"""What no test of this folder can do without."""

from __future__ import annotations

import pytest

from network.shaped_link import missing


@pytest.fixture(scope="session", autouse=True)
def _namespaces() -> None:
    why = missing()
    if why is not None:
        pytest.skip(why)

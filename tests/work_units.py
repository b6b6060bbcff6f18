"""How the tests are handed to pytest-xdist's workers."""

from __future__ import annotations

from xdist.scheduler import LoadFileScheduling


class ByFile(LoadFileScheduling):  # type: ignore[misc]  # xdist has no types
    """A worker takes a whole file, whose fixtures are made once; of the pages' tests all, which share a browser."""

    def _split_scope(self, nodeid: str) -> str:
        return "tests/e2e" if nodeid.startswith("tests/e2e/") else str(super()._split_scope(nodeid))

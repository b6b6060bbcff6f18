from collections.abc import Iterator

import pytest

from engine.peer import EngineProcess, running_engine


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EngineProcess]:
    """One engine for a module's tests."""
    with running_engine(tmp_path_factory.mktemp("e")) as process:
        yield process

from collections.abc import Iterator

import pytest

from culet.engine.session.motion import StonesMotion
from culet.engine.session.session import Session
from engine.peer import EngineProcess, running_engine


@pytest.fixture(autouse=True)
def steps_cost_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A session of the test's own process takes all steps that are due, however long the machine takes for one: what is
    given up of them (`Allowance`) has tests of its own, with a timer of theirs."""
    for kind in (Session, StonesMotion):
        defaults = kind.__init__.__kwdefaults__
        assert defaults is not None
        monkeypatch.setitem(defaults, "timer", lambda: 0.0)


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EngineProcess]:
    """One engine for a module's tests."""
    with running_engine(tmp_path_factory.mktemp("e")) as process:
        yield process

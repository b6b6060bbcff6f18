"""The examples in the docstrings of what scripts and notebooks use."""

from __future__ import annotations

import doctest
from importlib import import_module

import pytest

MODULES = ("culet.sources", "culet.stills", "culet.falls")


@pytest.mark.parametrize("module", MODULES)
def test_examples_in_docstrings_hold(module: str) -> None:
    result = doctest.testmod(import_module(module))
    assert result.attempted > 0
    assert result.failed == 0

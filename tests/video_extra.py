"""What needs the extra culet[video], which `make validate` installs; `make test` shows that nothing else needs it."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from typing import Any

import pytest


def needs_av(test: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a test that encodes or decodes video."""
    missing = importlib.util.find_spec("av") is None
    skipped = pytest.mark.skipif(missing, reason="culet[video] is not installed: pip install -e '.[validation]'")
    marked: Callable[..., Any] = pytest.mark.validation(skipped(test))
    return marked

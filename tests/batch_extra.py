"""What needs the extra culet[batch], which `make validate` and `make soak` install."""

from __future__ import annotations

import importlib.util

import pytest

needs_dask = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None or importlib.util.find_spec("cryptography") is None,
    reason="culet[batch] is not installed: pip install -e '.[validation]'",
)

"""What each approximation and each feature costs, measured on the machine at hand.

    report = culet.study.measure("rendering", "matte", "report/matte", quick=True)

measures as `culet study` does; docs/explanation/study.md says what, and what a report holds.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from culet.study.measuring import measure
    from culet.study.report import Report

_HOMES = {"measure": "culet.study.measuring", "Report": "culet.study.report"}
"""The modules that the names come from; imported on demand, since the command line looks in here for its commands."""

__all__ = ["Report", "measure"]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'culet.study' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)

"""An error that nobody foresaw, as one that can be told."""

from __future__ import annotations

import logging

from culet.errors import CuletError, DeviceError

log = logging.getLogger(__name__)


def as_culet_error(error: Exception, kind: type[CuletError] = DeviceError, what: str = "rendering") -> CuletError:
    """The error itself, or one of that kind for one that nobody foresaw; the latter goes to the log too."""
    if isinstance(error, CuletError):
        return error
    log.error("%s failed", what, exc_info=error)
    return kind(f"{what} failed: {type(error).__name__}: {error}")

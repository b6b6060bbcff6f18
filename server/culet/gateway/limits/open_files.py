"""How many connections the limit of open files leaves room for."""

from __future__ import annotations

import logging
import resource

log = logging.getLogger(__name__)

RESERVED_FILES = 288
"""File descriptors that are not for connections: ZeroMQ's, the page's files, logs, and connections just accepted."""
FEWEST_CONNECTIONS = 16


def connection_limit(wanted: int) -> int:
    """How many connections there may be: those wanted, as far as the limit of open files, raised if need be, goes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = wanted + RESERVED_FILES
    if soft != resource.RLIM_INFINITY and soft < needed:
        soft = needed if hard == resource.RLIM_INFINITY else min(needed, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        if soft < needed:
            log.warning("the limit of open files, %d, leaves room for %d connections", soft, soft - RESERVED_FILES)
            return max(FEWEST_CONNECTIONS, soft - RESERVED_FILES)
    return wanted

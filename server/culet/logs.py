"""What the processes of a server say of themselves: a line for each event, on stderr, as text or JSON."""

from __future__ import annotations

import json
import logging
import time
from typing import Literal

Level = Literal["debug", "info", "warning", "error"]
LogFormat = Literal["text", "json"]

FIELDS = "fields"
"""Name under which a record carries what belongs to it: `extra={FIELDS: {...}}`; its message says the same in words."""
_TEXT = "%(asctime)s %(levelname)s %(name)s: %(message)s"
_CHATTY = ("uvicorn.error", "python_multipart", "asyncio")
"""Loggers that tell of each bad request, or of each start; what matters of that is said by the gateway's own."""


def configure(level: Level, log_format: LogFormat) -> None:
    """Send all records of a level and above to stderr."""
    handler = logging.StreamHandler()
    formatter = _Json() if log_format == "json" else logging.Formatter(_TEXT)
    formatter.converter = time.gmtime
    formatter.default_time_format, formatter.default_msec_format = "%Y-%m-%dT%H:%M:%S", "%s.%03dZ"
    handler.setFormatter(formatter)
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    for name in _CHATTY:
        logging.getLogger(name).setLevel(logging.ERROR)


class _Json(logging.Formatter):
    """One object a line."""

    def format(self, record: logging.LogRecord) -> str:
        line = {
            "time": self.formatTime(record),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **getattr(record, FIELDS, {}),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line)

"""Headers of an answer with a picture that say how good the picture is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SAMPLES, ERROR, TARGET = "Culet-Samples", "Culet-Error", "Culet-Target"
MET, MISSED = "met", "missed"

QUALITY_HEADERS: dict[str, Any] = {
    SAMPLES: {"description": "Samples of each pixel.", "schema": {"type": "integer"}},
    ERROR: {
        "description": "What is shown, from 0 to 1, is off by this: root mean square over pixels and colours, "
        "estimated. Not there of a single sample.",
        "schema": {"type": "number"},
    },
    TARGET: {
        "description": "Whether that is the `error` that was asked for; not there if none was.",
        "schema": {"type": "string", "enum": [MET, MISSED]},
    },
}
"""For OpenAPI."""


def quality_headers(result: Mapping[str, Any]) -> dict[str, str]:
    """Of the engine's reply about a still."""
    headers = {SAMPLES: str(result["samples"])}
    if result["error"] is not None:
        headers[ERROR] = f"{result['error']:.3g}"
    if result["met"] is not None:
        headers[TARGET] = MET if result["met"] else MISSED
    return headers

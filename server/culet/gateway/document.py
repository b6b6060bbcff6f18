"""The description of the REST interface without a server: `python -m culet.gateway.document`, JSON on standard output.

What `/openapi.json` answers; the page's types and the reference of the documentation are made of it.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from culet.gateway.app import create_app
from culet.gateway.settings import GatewaySettings


def document() -> dict[str, Any]:
    """The OpenAPI 3.1 document. Nothing is listened on, and no engine is asked."""
    return create_app(GatewaySettings(control="inproc://control", frames="inproc://frames")).openapi()


if __name__ == "__main__":
    json.dump(document(), sys.stdout, indent=1)

"""Where files are uploaded to."""

from __future__ import annotations

import re

MESHES_PATH, SKIES_PATH = "/api/meshes", "/api/skies"
SESSION_MESHES_PATH, SESSION_SKIES_PATH = "/api/sessions/{session_id}/meshes", "/api/sessions/{session_id}/skies"
UPLOADS = re.compile(r"/api/(sessions/[^/]+/)?(meshes|skies)")
"""All of them."""

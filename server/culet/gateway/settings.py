"""What the web process can be told; every limit in one place."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

BUILT_CLIENT = Path(__file__).parents[3] / "client" / "web" / "dist"
"""Where the web client's build lies in a checkout."""

MEBIBYTE = 1 << 20


@dataclass(frozen=True)
class GatewaySettings:
    """Endpoints of the engine, and the gateway's limits."""

    control: str
    """ZeroMQ endpoint of the engine's ROUTER."""
    frames: str
    """ZeroMQ endpoint of the engine's XPUB."""
    web: Path = BUILT_CLIENT
    """Folder of the built web client, served at `/`."""
    allowed_origins: tuple[str, ...] = ()
    """Origins besides the page's own that may open streams and change things, such as `https://gems.example`."""
    trusted_proxies: tuple[str, ...] = ()
    """Addresses or networks of proxies, whose X-Forwarded-For says which client a request comes from."""
    max_sessions: int = 64
    session_idle_seconds: float = 900
    """A session that nobody watched or asked about for so long is forgotten."""
    max_viewers: int = 32
    """Of one session."""
    max_body_bytes: int = MEBIBYTE
    """Of a request body that is not an upload."""
    max_upload_bytes: int = 64 * MEBIBYTE
    """Of an uploaded file."""
    max_kept_upload_bytes: int = 256 * MEBIBYTE
    """Of all uploads kept to be given to an engine again; the oldest go first, but for those that sessions use."""
    request_seconds: float = 10
    """An engine that lives but does not answer a small request for so long is reported as unavailable."""
    engine_silence_seconds: float = 3.5
    """Without a heartbeat (one a second) for so long, the engine counts as down."""

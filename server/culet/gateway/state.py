"""What one gateway process holds, and what it counts."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field

from culet.gateway.bucket import ClientBuckets
from culet.gateway.link import EngineLink
from culet.gateway.metrics import Metrics
from culet.gateway.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.still_places import StillPlaces
from culet.gateway.uploads import Uploads


@dataclass(frozen=True)
class Gateway:
    """The parts of the gateway, for the routes."""

    settings: GatewaySettings
    link: EngineLink
    uploads: Uploads
    sessions: Sessions
    clients: ClientBuckets
    """What each client may still ask for."""
    stills: StillPlaces
    metrics: Metrics
    stopping: asyncio.Event = field(default_factory=asyncio.Event)
    """Set when the server was told to stop."""

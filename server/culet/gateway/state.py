"""What one gateway process holds, and what it counts."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field

from culet.client_turns import ClientTurns
from culet.gateway.engine.link import EngineLink
from culet.gateway.limits.bucket import ClientBuckets
from culet.gateway.limits.still_places import StillPlaces
from culet.gateway.operation.metrics import Metrics
from culet.gateway.sessions.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads.uploads import Uploads

MOST_TURNTABLES = 4
"""Being made for all clients together: the gateway holds their frames, as `culet.gateway.routes.turntables` says."""
CLIENT_TURNTABLES = 2
"""Of one client, so that others can have theirs."""


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
    grades: ClientTurns = field(default_factory=ClientTurns)
    """The engine takes turns between the grades that are asked for at once; each client has one among them."""
    designs: ClientTurns = field(default_factory=ClientTurns)
    """Stones that are cut for others to be compared with, and reaches of tiers, which may take seconds: of each client
    the engine is asked for one at a time."""
    turntables: StillPlaces = field(
        default_factory=lambda: StillPlaces(CLIENT_TURNTABLES, "turntables", MOST_TURNTABLES)
    )
    """Held by those that are being made."""
    stopping: asyncio.Event = field(default_factory=asyncio.Event)
    """Set when the server was told to stop."""

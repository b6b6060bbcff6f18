"""What one gateway process holds, and what it counts."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from culet.gateway.bucket import ClientBuckets
from culet.gateway.link import EngineLink
from culet.gateway.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.still_places import StillPlaces
from culet.gateway.uploads import Uploads


@dataclass
class Counters:
    """Since the process began."""

    frames_sent: int = 0
    bytes_sent: int = 0
    answers: Counter[int] = field(default_factory=Counter)
    """HTTP answers by status."""

    def frame_sent(self, size: int) -> None:
        """A frame of that many bytes went to a viewer."""
        self.frames_sent += 1
        self.bytes_sent += size


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
    counters: Counters

"""What sessions show and stills wait for: uploads that must not be forgotten, and the skies that they hold."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.still import Still
from culet.optics.panoramas import Panorama
from culet.stage import uploads_of


def uploads_in_use(pictures: Iterable[LivePicture], stills: Iterable[Still]) -> set[str]:
    """Ids of the meshes and skies that sessions show or would go back to, that removed stones would come back with, and
    that stills wait for."""
    used = set[str]()
    for live in pictures:
        used |= uploads_of(live.session.stage.scene, live.session.sky.environment) | live.session.removals.meshes()
        if live.painted is not None:
            used |= live.painted.stage.uses()
    for still in stills:
        used |= still.stage.uses()
    return used


def sky_bytes(pictures: Iterable[LivePicture], stills: Iterable[Still], kept: Collection[Panorama]) -> int:
    """Bytes of the skies that sessions and stills hold, and nobody else: `kept` are those that an upload store has."""
    held: dict[int, Panorama] = {}
    for live in pictures:
        painted = live.painted.stage.panorama if live.painted else None
        held |= {id(sky): sky for sky in (live.session.sky.panorama, painted) if sky is not None}
    held |= {id(still.stage.panorama): still.stage.panorama for still in stills if still.stage.panorama is not None}
    known = {id(sky) for sky in kept}
    return sum(sky.nbytes for key, sky in held.items() if key not in known)

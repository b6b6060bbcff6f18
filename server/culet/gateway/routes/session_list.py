"""GET /api/sessions: what is open, for who keeps the server running."""

from __future__ import annotations

import time
from typing import Annotated

from fastapi import APIRouter
from pydantic import Field

from culet.errors import ForbiddenError
from culet.gateway.answers.problems import answers
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.sessions.session_record import SessionRecord
from culet.scene.fields import Model

router = APIRouter(tags=["sessions"])

UNLISTED = (
    "sessions are listed on servers with a token (`--token`, `CULET_TOKEN`): the ids of sessions are secrets, and "
    "without a token whoever reaches the server would be told them"
)


class ListedSession(Model):
    """What the server knows of a session without asking the engine."""

    id: Annotated[str, Field(description="`DELETE /api/sessions/{id}` forgets the session.")]
    watch: Annotated[str, Field(description="Whoever knows it may watch the session, no more.")]
    client: Annotated[str, Field(description="Address of who opened the session.")]
    viewers: int
    stones: int
    falling: Annotated[bool, Field(description="Whether time goes on for the stones.")]
    asleep: Annotated[bool, Field(description="Whether all stones have come to rest for good.")]
    unused_seconds: Annotated[float, Field(description="Since somebody watched it, or asked for it; 0 while watched.")]


class SessionList(Model):
    """The one that was used last first."""

    sessions: tuple[ListedSession, ...]


@router.get("/api/sessions", responses=answers(401, 403, 429))
async def list_sessions(gateway: ThisGateway) -> SessionList:
    """All sessions of this server, for who has its token; a server without one lists none."""
    if gateway.settings.token is None:
        raise ForbiddenError(UNLISTED)
    now = time.monotonic()
    listed = sorted((_listed(session, now) for session in gateway.sessions), key=lambda one: one.unused_seconds)
    return SessionList(sessions=tuple(listed))


def _listed(session: SessionRecord, now: float) -> ListedSession:
    return ListedSession(
        id=session.id,
        watch=session.topic.hex(),
        client=session.owner,
        viewers=len(session.viewers),
        stones=len(session.scene.get("stones", ())),
        falling=session.condition.falling,
        asleep=session.condition.asleep,
        unused_seconds=0.0 if session.viewers else round(now - session.used, 1),
    )

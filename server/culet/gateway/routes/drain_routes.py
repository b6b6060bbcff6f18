"""POST /api/drain: have the server stopped once nobody needs it any more."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body
from pydantic import Field

from culet.errors import ForbiddenError
from culet.gateway.answers.problems import answers
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.settings import is_reached
from culet.notify import ServiceNotice, notify
from culet.scene.fields import Model

router = APIRouter(tags=["health"])

DRAIN_PATH = "/api/drain"
OPEN_TO_ALL = (
    "this server has no token, so that whoever reaches it could stop it; send its process SIGTERM, or start it "
    "with a token"
)
LONGEST_SECONDS = 7 * 24 * 3600.0


class DrainRequest(Model):
    """How long those who are there may stay."""

    seconds: (
        Annotated[float, Field(ge=0, le=LONGEST_SECONDS, description="As `--drain-seconds` says, if not given.")] | None
    ) = None

    model_config = Model.model_config | {"json_schema_extra": {"examples": [{"seconds": 600}]}}


class DrainAnswer(Model):
    """What is left."""

    seconds: Annotated[float, Field(description="After which the server ends at the latest.")]
    viewers: Annotated[int, Field(description="Who watch; the server ends before if nobody does any more.")]


@router.post(DRAIN_PATH, status_code=202, responses=answers(401, 403, 413, 422, 429))
async def drain(gateway: ThisGateway, request: Annotated[DrainRequest | None, Body()] = None) -> DrainAnswer:
    """Stop the server once nobody uses it any more, or after so many seconds.

    Until then it says at /readyz that it is not ready, and answers 503 to whoever wants a new session. Whoever has one
    keeps it and is told. Once begun this cannot be taken back; asked for again, the shorter time counts. A server that
    others reach without a token answers 403: any of them could stop it.
    """
    if gateway.settings.token is None and is_reached(gateway.settings):
        raise ForbiddenError(OPEN_TO_ALL)
    seconds = request.seconds if request else None
    gateway.sessions.drain.begin(gateway.settings.drain_seconds if seconds is None else seconds)
    notify(ServiceNotice.STOPPING)  # what a signal ends, to this process alone, is started again
    return DrainAnswer(seconds=gateway.sessions.drain.left, viewers=gateway.sessions.viewers)

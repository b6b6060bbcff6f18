"""/healthz, /readyz and /metrics, for those who keep the service running."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, HTTPException, Query, Response
from fastapi.responses import PlainTextResponse
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4

from culet.errors import CuletError, EngineUnavailableError
from culet.gateway.answers.problems import answers
from culet.gateway.operation.drain import REFUSAL
from culet.gateway.operation.metrics import EngineStatus
from culet.gateway.routes.parts import ThisGateway
from culet_protocol.engine import Status

router = APIRouter(tags=["health"])


@router.get("/healthz")
async def healthz() -> dict[str, str]:
    """This process answers."""
    return {"status": "ok"}


LEAVING = 503


@router.get("/readyz", responses=answers(422, 503))
async def readyz(
    gateway: ThisGateway,
    draining: Annotated[
        int,
        Query(
            ge=400,
            le=599,
            description="Status of the answer while the server is about to be stopped: HAProxy, by `disable-on-404`, "
            "takes 404 for a server that keeps the sessions it has.",
        ),
    ] = LEAVING,
) -> dict[str, str]:
    """The engine answers too, and new sessions are welcome."""
    if gateway.sessions.drain.begun.is_set() and gateway.link.ready.is_set():
        raise HTTPException(draining, REFUSAL)
    if not gateway.link.ready.is_set():
        raise EngineUnavailableError("no heartbeat from the render process")
    return {"status": "ready"}


@router.get("/metrics", response_class=PlainTextResponse, responses=answers(401, 429))
async def metrics(gateway: ThisGateway) -> Response:
    """Counters of the gateway and the engine. No labels that grow with use, such as sessions."""
    try:
        status, _ = await gateway.link.request(Status())
    except CuletError:
        status = {}
    engine = CollectorRegistry()
    engine.register(EngineStatus(status))
    return Response(
        generate_latest(gateway.metrics.registry) + generate_latest(engine), media_type=CONTENT_TYPE_PLAIN_0_0_4
    )

"""/healthz, /readyz and /metrics, for those who keep the service running."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import PlainTextResponse

from culet.errors import CuletError, EngineUnavailableError
from culet.gateway.parts import ThisGateway
from culet.gateway.problems import answers
from culet_protocol.engine import Status

router = APIRouter(tags=["health"])

EXPOSITION = "text/plain; version=0.0.4; charset=utf-8"
"""Prometheus's text format."""


@router.get("/healthz")
async def healthz() -> dict[str, str]:
    """This process answers."""
    return {"status": "ok"}


@router.get("/readyz", responses=answers(503))
async def readyz(gateway: ThisGateway) -> dict[str, str]:
    """The engine answers too."""
    if not gateway.link.ready.is_set():
        raise EngineUnavailableError("no heartbeat from the render process")
    return {"status": "ready"}


@router.get("/metrics", response_class=PlainTextResponse)
async def metrics(gateway: ThisGateway) -> Response:
    """Counters of the gateway and the engine. No labels that grow with use, such as sessions."""
    counters = gateway.counters
    lines = [
        *_metric("culet_engine_up", "gauge", "1 while the engine's heartbeats come.", int(gateway.link.ready.is_set())),
        *_metric("culet_engine_processes_total", "counter", "Engine processes seen.", gateway.link.instances),
        *_metric("culet_sessions", "gauge", "Sessions open.", len(gateway.sessions)),
        *_metric("culet_viewers", "gauge", "Viewers connected.", gateway.sessions.viewers),
        *_metric("culet_frames_received_total", "counter", "Frames from the engine.", gateway.link.frames_received),
        *_metric("culet_frames_sent_total", "counter", "Frames sent to viewers.", counters.frames_sent),
        *_metric("culet_frame_bytes_sent_total", "counter", "Bytes of those frames.", counters.bytes_sent),
        *_metric("culet_upload_bytes_kept", "gauge", "Bytes of uploads kept.", gateway.uploads.kept_bytes),
        "# HELP culet_http_answers_total HTTP answers by status.",
        "# TYPE culet_http_answers_total counter",
        *(f'culet_http_answers_total{{status="{code}"}} {n}' for code, n in sorted(counters.answers.items())),
    ]
    try:
        status, _ = await gateway.link.request(Status())
    except CuletError:
        status = {}
    lines += engine_lines(status)
    return Response("\n".join(lines) + "\n", media_type=EXPOSITION)


def engine_lines(status: dict[str, Any]) -> list[str]:
    """The numbers of the engine's status, as they are now."""
    lines: list[str] = []
    for name, value in sorted(status.items()):
        if isinstance(value, int | float) and name.isidentifier():
            lines += _metric(f"culet_engine_{name}", "gauge", "From the engine's status.", value)
    return lines


def _metric(name: str, kind: str, meaning: str, value: float) -> list[str]:
    return [f"# HELP {name} {meaning}", f"# TYPE {name} {kind}", f"{name} {float(value):.15g}"]

"""The web application."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator
from http import HTTPStatus

from fastapi import FastAPI
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.routing import APIRoute
from starlette.middleware.cors import CORSMiddleware

from culet.gateway.admission.access import Access
from culet.gateway.admission.admission import Admission
from culet.gateway.admission.allowance import RequestAllowance
from culet.gateway.answers import problems
from culet.gateway.answers.methods import Methods
from culet.gateway.answers.openapi import Application
from culet.gateway.answers.page_files import PageFiles
from culet.gateway.answers.quality import QUALITY_HEADERS
from culet.gateway.answers.security_headers import SecurityHeaders
from culet.gateway.engine.link import EngineLink
from culet.gateway.identity.paths import InFolder
from culet.gateway.limits.bucket import ClientBuckets
from culet.gateway.limits.still_places import StillPlaces
from culet.gateway.operation.access_log import AccessLog
from culet.gateway.operation.metrics import Metrics
from culet.gateway.routes import (
    beside_routes,
    catalogue,
    drain_routes,
    health,
    login_routes,
    path_routes,
    session_list,
    session_routes,
    stills,
    stone_routes,
    turntables,
    upload_routes,
)
from culet.gateway.sessions.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.state import Gateway
from culet.gateway.uploads.uploads import Uploads
from culet.version import __version__

log = logging.getLogger(__name__)

PARTS = (
    login_routes,
    stills,
    turntables,
    session_list,
    session_routes,
    beside_routes,
    stone_routes,
    path_routes,
    catalogue,
    upload_routes,
    drain_routes,
    health,
)
NO_PAGE = """<!doctype html><meta charset="utf-8"><title>culet</title>
<h1>culet runs without its page</h1>
<p>The <a href="openapi.json">REST interface</a> is here, for instance <a href="api/render.png">a picture</a>."""


def create_app(settings: GatewaySettings) -> FastAPI:
    """The application; it connects to the engine when it starts up. `app.state.gateway` holds its parts."""
    app = Application(
        title="culet",
        version=__version__,
        summary="Dispersive gemstones, traced exactly and streamed to thin clients.",
        description="Errors are problem documents (RFC 9457) that name the field. Frames of a session and control "
        "events travel by the WebSocket `/api/sessions/{id}/stream`: see the documentation's page of the protocol.",
        servers=[{"url": "."}],  # beside the document: a proxy may have both in a folder
        openapi_url=None,  # FastAPI would make the document on the loop, which takes longer than a frame
        docs_url=None,  # its pages load their scripts from the network
        redoc_url=None,
        generate_unique_id_function=_operation_id,
        lifespan=_lifespan,
    )
    app.state.gateway = _gateway(settings)
    problems.install(app)
    for part in PARTS:
        app.include_router(part.router, responses={} if part is health else problems.answers(429))

    @app.get("/openapi.json", include_in_schema=False)
    async def document() -> Response:
        return Response(await asyncio.to_thread(app.document), media_type="application/json")

    if (settings.web / "index.html").is_file():

        @app.get("/docs", include_in_schema=False)
        async def docs() -> RedirectResponse:
            return RedirectResponse("docs/", HTTPStatus.PERMANENT_REDIRECT)  # relative: a proxy may have it in a folder

        app.mount("/", PageFiles(directory=settings.web, html=True))
    else:

        @app.get("/", include_in_schema=False)
        async def no_page() -> HTMLResponse:
            return HTMLResponse(NO_PAGE, 404)

    # The last one is the first that a request meets.
    app.add_middleware(Methods, routes=[*app.routes, *(route for part in PARTS for route in part.router.routes)])
    app.add_middleware(Access, settings=settings)
    app.add_middleware(Admission, settings=settings, largest_form=upload_routes.largest_form(settings))
    app.add_middleware(RequestAllowance, clients=app.state.gateway.clients)
    if settings.allow_origin:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.allow_origin,
            allow_methods=("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE"),
            allow_headers=("Authorization",),  # the server's token
            expose_headers=("Location", "Retry-After", "Content-Disposition", "ETag", *QUALITY_HEADERS),
            allow_private_network=True,
        )
    app.add_middleware(SecurityHeaders, settings=settings)
    app.add_middleware(AccessLog, metrics=app.state.gateway.metrics)
    if settings.root_path:
        app.add_middleware(InFolder, folder=settings.root_path)
    return app


def _operation_id(route: APIRoute) -> str:
    """What generated clients call a route: `create_session`, `render_png`."""
    return route.name


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    gateway: Gateway = app.state.gateway
    tasks = [asyncio.create_task(gateway.link.run()), asyncio.create_task(gateway.sessions.run())]
    for task in tasks:
        task.add_done_callback(_log_failure)
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        results = await asyncio.gather(*tasks, return_exceptions=True)
        for result in results:
            if isinstance(result, Exception):
                raise result


def _log_failure(task: asyncio.Task[None]) -> None:
    if not task.cancelled() and (error := task.exception()):
        log.critical("a part of the gateway has failed; restart it", exc_info=error)


def _gateway(settings: GatewaySettings) -> Gateway:
    link = EngineLink(settings)
    uploads = Uploads(link, settings.max_kept_upload_bytes, settings.uploads_folder)
    sessions, metrics = Sessions(settings, link, uploads), Metrics()
    metrics.watch("culet_engine_up", "1 while the engine's heartbeats come.", link.ready.is_set)
    metrics.watch("culet_engine_processes", "Engine processes seen.", lambda: link.instances, counts=True)
    metrics.watch("culet_frames_received", "Frames from the engine.", lambda: link.frames_received, counts=True)
    metrics.watch("culet_sessions", "Sessions open.", sessions.__len__)
    metrics.watch("culet_viewers", "Viewers connected.", lambda: sessions.viewers)
    metrics.watch("culet_draining", "1 while no new sessions are taken.", sessions.drain.begun.is_set)
    metrics.watch("culet_upload_bytes_kept", "Bytes of uploads kept.", lambda: uploads.kept_bytes)
    return Gateway(
        settings,
        link,
        uploads,
        sessions,
        ClientBuckets(settings.client_messages_per_second),
        StillPlaces(settings.max_client_stills),
        metrics,
    )

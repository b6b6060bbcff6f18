"""POST /api/sessions/{id}/beside: what a session shows with another design of one stone, to be compared with it.

Whoever may watch the session may ask, for what a still of the session may cost: one of the client's places, and no more
pixels and samples than that has. A stone that is cut anew may take the engine seconds: of each client one design at a
time is shown. Nothing of the session changes.
"""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import Field

from culet.gateway.answers.departure import while_waited_for
from culet.gateway.answers.picture_response import PictureResponse, picture_answers
from culet.gateway.answers.problems import answers, finite
from culet.gateway.answers.quality import quality_headers
from culet.gateway.identity.client_address import client_of
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.routes.session_routes import StepNumber
from culet.gateway.routes.stills import MEDIA_TYPES, Error, Height, Samples, Width
from culet.scene.fields import Model, Orientation, Vector
from culet.scene.stone import StoneId, UploadId
from culet_protocol.engine import Format, Render

router = APIRouter(tags=["sessions"])


class OtherDesign(Model):
    """What is other about the stone, as a stone of a scene has it; what is not given stays, and null takes it away."""

    cut: str | dict[str, Any] | None = None
    mesh: UploadId | None = None
    recut: dict[str, Any] | None = None
    material: str | dict[str, Any] | None = None
    position: Vector | None = None
    orientation: Orientation | None = None


class BesideRequest(Model):
    """A stone of the session with another design, at the state `step`."""

    stone: StoneId
    design: OtherDesign
    step: StepNumber | None = None
    width: Width | None = None
    height: Height | None = None
    samples: Samples | None = None
    error: Error | None = None
    format: Format = Field("webp", description="EXR is linear radiance; the others are tone-mapped.")

    model_config = Model.model_config | {
        "json_schema_extra": {"examples": [{"stone": "stone", "design": {"cut": "oval"}, "width": 320, "height": 180}]}
    }


@router.post(
    "/api/sessions/{session_id}/beside",
    response_class=Response,
    responses={**picture_answers(*MEDIA_TYPES.values()), **answers(404, 413, 422, 429, 503)},
)
async def render_beside(http: Request, session_id: str, request: BesideRequest, gateway: ThisGateway) -> Response:
    """Render what a session shows, or showed at `step`, with another design of one of its stones."""
    design = request.design.model_dump(mode="json", exclude_unset=True)
    finite(design)
    session = gateway.sessions.get(session_id)
    session.watched = True
    client = client_of(http.scope)
    message = Render(
        session=session.id, step=request.step, stone=request.stone,
        design=design, width=request.width, height=request.height, samples=request.samples, error=request.error,
        format=request.format, client=client,
    )  # fmt: skip

    async def in_turn() -> tuple[dict[str, Any], bytes | memoryview]:
        with session.awaited():
            async with gateway.designs.turn(client):
                return await gateway.sessions.request(session, message, patient=True)

    with gateway.stills.place(client):
        result, data = await while_waited_for(http, in_turn())
    return PictureResponse(data, media_type=MEDIA_TYPES[request.format], headers=quality_headers(result))

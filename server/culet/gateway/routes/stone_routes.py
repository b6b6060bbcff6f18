"""What is asked about one stone of a scene or of a session: grades, proportions, tiers, its cutting diagram."""

from __future__ import annotations

from contextlib import AbstractAsyncContextManager, nullcontext
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import ConfigDict, Field, TypeAdapter

from culet.gateway.answers.departure import while_waited_for
from culet.gateway.answers.problems import answers
from culet.gateway.identity.client_address import client_of
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.state import Gateway
from culet.geometry.cutting.tiers import Tiers
from culet.geometry.designs.proportions import Proportions
from culet.grading.answer import GradeReport
from culet.grading.rules import Convention
from culet.scene import Scene
from culet.scene.fields import Model
from culet_protocol.engine import DrawDiagram, Grade, ListTiers, Measure, TracePath

router = APIRouter(tags=["stones"])

SVG = "image/svg+xml"
REPORT: TypeAdapter[GradeReport] = TypeAdapter(GradeReport)
PROPORTIONS: TypeAdapter[Proportions] = TypeAdapter(Proportions)
TIERS: TypeAdapter[Tiers] = TypeAdapter(Tiers)
_EXAMPLES = ConfigDict(json_schema_extra={"examples": [{"scene": {"stones": [{"cut": "emerald"}]}}]})
_DRAWING: dict[int | str, dict[str, Any]] = {200: {"content": {SVG: {"schema": {"type": "string"}}}}}

StoneName = Annotated[str, Field(max_length=32, description="Id of the stone; without one the first.")]
TierNumber = Annotated[
    int,
    Field(ge=1, le=1500, description="A tier: its ends are then those at which meets are kept, which takes longer."),
]
HeadDegrees = Annotated[float, Field(ge=0, le=90, description="Half the angle of the viewer's head; 10.")]


class GradeQuery(Model):
    """How to grade."""

    stone: StoneName | None = None
    convention: Annotated[
        Convention, Field(description="By whose rules: `gemray` follows ten facets alone, as that program does.")
    ] = "culet"
    head_degrees: (
        Annotated[float, Field(ge=0, le=90, description="Half the angle of the viewer's head; 10.")] | None
    ) = None
    coloured: Annotated[bool, Field(description="Count what the material absorbs at 589.3 nm.")] = False
    tilt: Annotated[bool, Field(description="Tilt curves about both axes too.")] = False
    error: Annotated[float, Field(ge=0.03, le=10, description="Points: twice the standard error of ISO.")] = 0.1


class GradeRequest(GradeQuery):
    """A stone of a scene."""

    scene: Scene = Scene()

    model_config = Model.model_config | _EXAMPLES


class StoneRequest(Model):
    """A stone of a scene."""

    scene: Scene = Scene()
    stone: StoneName | None = None

    model_config = Model.model_config | _EXAMPLES


class TierRequest(StoneRequest):
    """A stone of a scene, and perhaps one of its tiers."""

    reach: TierNumber | None = None


@router.post("/api/grade", responses=answers(401, 413, 422, 429, 503))
async def grade(http: Request, request: GradeRequest, gateway: ThisGateway) -> GradeReport:
    """Grade a stone of a scene: brightness, leak, contrast, fire, each number with its error."""
    scene = request.scene.model_dump(mode="json")
    return await _graded(http, gateway, Grade(scene=scene, **request.model_dump(exclude={"scene"})))


@router.get("/api/sessions/{session_id}/grade", responses=answers(404, 422, 429, 503))
async def grade_session(
    http: Request, session_id: str, query: Annotated[GradeQuery, Query()], gateway: ThisGateway
) -> GradeReport:
    """Grade a stone of what a session shows."""
    session = gateway.sessions.get(session_id)
    return await _graded(http, gateway, Grade(session=session.id, **query.model_dump()), session)


@router.post(
    "/api/design/diagram.svg", response_class=Response, responses={**_DRAWING, **answers(401, 413, 422, 429, 503)}
)
async def diagram(http: Request, request: StoneRequest, gateway: ThisGateway) -> Response:
    """The cutting diagram of a stone of a scene, to be printed on a page."""
    scene = request.scene.model_dump(mode="json")
    return await _drawn(http, gateway, DrawDiagram(scene=scene, stone=request.stone))


@router.get(
    "/api/sessions/{session_id}/diagram.svg",
    response_class=Response,
    responses={**_DRAWING, **answers(404, 422, 429, 503)},
)
async def diagram_of_session(
    http: Request, session_id: str, gateway: ThisGateway, stone: StoneName | None = None
) -> Response:
    """The cutting diagram of a stone of what a session shows."""
    session = gateway.sessions.get(session_id)
    return await _drawn(http, gateway, DrawDiagram(session=session.id, stone=stone), session)


@router.post("/api/design/proportions", responses=answers(401, 413, 422, 429, 503))
async def proportions(http: Request, request: StoneRequest, gateway: ThisGateway) -> Proportions:
    """The proportions of a convex stone of a scene, in R and in per cent of the stone's width."""
    scene = request.scene.model_dump(mode="json")
    return await _measured(http, gateway, Measure(scene=scene, stone=request.stone))


@router.get("/api/sessions/{session_id}/proportions", responses=answers(404, 422, 429, 503))
async def proportions_of_session(
    http: Request, session_id: str, gateway: ThisGateway, stone: StoneName | None = None
) -> Proportions:
    """The proportions of a convex stone of what a session shows."""
    session = gateway.sessions.get(session_id)
    return await _measured(http, gateway, Measure(session=session.id, stone=stone), session)


@router.post("/api/design/tiers", responses=answers(401, 413, 422, 429, 503))
async def tiers(http: Request, request: TierRequest, gateway: ThisGateway) -> Tiers:
    """The sloping tiers of a convex stone of a scene: their angles, and the ends between which these may be."""
    scene = request.scene.model_dump(mode="json")
    return await _listed(http, gateway, ListTiers(scene=scene, stone=request.stone, reach=request.reach))


@router.get("/api/sessions/{session_id}/tiers", responses=answers(404, 422, 429, 503))
async def tiers_of_session(
    http: Request,
    session_id: str,
    gateway: ThisGateway,
    stone: StoneName | None = None,
    reach: TierNumber | None = None,
) -> Tiers:
    """The sloping tiers of a convex stone of what a session shows."""
    session = gateway.sessions.get(session_id)
    return await _listed(http, gateway, ListTiers(session=session.id, stone=stone, reach=reach), session)


async def _listed(http: Request, gateway: Gateway, message: ListTiers, session: SessionRecord | None = None) -> Tiers:
    result, _ = await answered(http, gateway, message, session)
    return TIERS.validate_python(result)


async def _measured(
    http: Request, gateway: Gateway, message: Measure, session: SessionRecord | None = None
) -> Proportions:
    result, _ = await answered(http, gateway, message, session)
    return PROPORTIONS.validate_python(result)


async def _graded(http: Request, gateway: Gateway, message: Grade, session: SessionRecord | None = None) -> GradeReport:
    result, _ = await answered(http, gateway, message, session)
    return REPORT.validate_python(result)


async def _drawn(
    http: Request, gateway: Gateway, message: DrawDiagram, session: SessionRecord | None = None
) -> Response:
    _, drawing = await answered(http, gateway, message, session)
    return Response(bytes(drawing), media_type=SVG)


async def answered(
    http: Request,
    gateway: Gateway,
    message: Grade | DrawDiagram | Measure | ListTiers | TracePath,
    session: SessionRecord | None,
) -> tuple[dict[str, Any], bytes | memoryview]:
    """The engine's answer, about the session if there is one, in a place of the client; grades, rays and reaches of
    tiers in the client's turns."""
    client = client_of(http.scope)
    message = message.model_copy(update={"client": client})
    if isinstance(message, Grade | TracePath):
        turn: AbstractAsyncContextManager[None] = gateway.grades.turn(client)
    elif isinstance(message, ListTiers) and message.reach is not None:
        turn = gateway.designs.turn(client)
    else:
        turn = nullcontext()

    async def in_turn() -> tuple[dict[str, Any], bytes | memoryview]:
        if session is None:
            async with turn:
                return await gateway.uploads.request(message, patient=True)
        with session.awaited():
            async with turn:
                return await gateway.sessions.request(session, message, patient=True)

    with gateway.stills.place(client):
        return await while_waited_for(http, in_turn())

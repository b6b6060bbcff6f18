"""/api/sessions: make, ask, change and forget sessions, and the full-quality picture of what one shows."""

from __future__ import annotations

from typing import Annotated, Any, Self

from fastapi import APIRouter, Body, Path, Query, Request, Response, WebSocket
from pydantic import Field, model_validator

from culet.gateway.answers.departure import while_waited_for
from culet.gateway.answers.picture_response import PictureResponse, picture_answers
from culet.gateway.answers.problems import answers, check_numbers, finite
from culet.gateway.answers.quality import quality_headers
from culet.gateway.identity.client_address import client_of
from culet.gateway.identity.paths import reference
from culet.gateway.routes import stream as streaming
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.routes.stills import ENDINGS, MEDIA_TYPES, Error, Height, Legend, Samples, Width, response_class_of
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.state import Gateway
from culet.scene import Scene, preset
from culet.scene.fields import Model
from culet_protocol import WATCH_SUBPROTOCOL
from culet_protocol.engine import Format, Render
from culet_protocol.messages import PatchScene, SessionEvent, StoneMotion

router = APIRouter(tags=["sessions"])


class SessionRequest(Model):
    """What the new session shows: a scene, or a preset by name; nothing is the preset `default`."""

    scene: Scene | None = None
    preset: Annotated[str, Field(description="A name from /api/presets.")] | None = None
    id: (
        Annotated[
            str,
            Field(
                pattern="^[0-9a-f]{32}$",
                description="Of a session that the server has lost: it is made again, with the scene that it had. If "
                "there is such a session, the answer is about that one.",
            ),
        ]
        | None
    ) = None
    snapshot: (
        Annotated[dict[str, Any], Field(description="The last one that a viewer of the lost session was told.")] | None
    ) = None

    model_config = Model.model_config | {"json_schema_extra": {"examples": [{"preset": "matte"}]}}

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if self.scene is not None and self.preset is not None:
            raise ValueError("expected a scene or a preset, got both")
        if self.id is not None and self.scene is None:
            raise ValueError("expected the scene of the session that was lost, got none")
        if self.snapshot is not None and self.id is None:
            raise ValueError("expected the id of the session that the snapshot is of, got none")
        return self


class SessionAnswer(Model):
    """A session as it is now."""

    id: Annotated[
        str,
        Field(
            description="Whoever knows it may watch and change the session. Of a session that was asked "
            "for by its watch id, that."
        ),
    ]
    watch: Annotated[
        str, Field(description="Whoever knows it may watch the session, no more: it takes the id's place.")
    ]
    scene: Annotated[dict[str, Any], Field(description="With the camera and lights where they are now.")]
    falling: Annotated[bool, Field(description="Whether time goes on for the stones.")]
    asleep: Annotated[bool, Field(description="Whether all stones have come to rest for good.")]
    motions: Annotated[dict[str, StoneMotion], Field(description="What each stone does, by its id.")]
    exactness: Annotated[float, Field(description="While things move: 0 is many frames, 1 few and good ones.")]
    pinned: Annotated[bool, Field(description="Whether `exactness` fixes the quality of moving frames instead.")]
    can_undo: Annotated[bool, Field(description="Whether there is an edit that the event `undo` takes back.")]
    can_redo: Annotated[bool, Field(description="Whether there is an undone edit that `redo` makes again.")]
    findings: Annotated[
        tuple[str, ...],
        Field(description="What was found in uploaded meshes, and which stones overlap, a sentence each."),
    ]
    viewers: int
    stream: Annotated[
        str,
        Field(description="Where the WebSocket is, relative to what was asked; see the protocol."),
    ]


StepNumber = Annotated[int, Field(ge=0, le=2**63 - 1, description="From a frame's header; the latest if none.")]


class FrameQuery(Model):
    """Which state, and how large."""

    step: StepNumber | None = None
    width: Width | None = None
    height: Height | None = None
    samples: Samples | None = None
    error: Error | None = None
    legend: Legend = False


@router.post("/api/sessions", status_code=201, responses=answers(401, 404, 413, 422, 429, 503))
async def create_session(
    http: Request,
    gateway: ThisGateway,
    response: Response,
    request: Annotated[SessionRequest | None, Body()] = None,
) -> SessionAnswer:
    """Make a session."""
    request = request or SessionRequest()
    scene = request.scene or preset(request.preset or "default")
    shown, client = scene.model_dump(mode="json"), client_of(http.scope)
    if request.id is None:
        session = await gateway.sessions.open(shown, client)
    else:
        finite(request.snapshot)
        session = await gateway.sessions.reopen(request.id, shown, request.snapshot, client)
    _name(http, response, session)
    return _answer(http, session, session.id)


class LostSession(Model):
    """A session as its viewers were told of it last."""

    scene: Scene
    snapshot: (
        Annotated[dict[str, Any], Field(description="The last one that a viewer of the lost session was told.")] | None
    ) = None

    model_config = Model.model_config | {"json_schema_extra": {"examples": [{"scene": {}}]}}


@router.put(
    "/api/sessions/{session_id}",
    responses={201: {"model": SessionAnswer, "description": "It was made again"}, **answers(401, 403, 404, 413, 422)},
)
async def make_session_again(
    http: Request,
    session_id: Annotated[str, Path(pattern="^[0-9a-f]{32}$")],
    lost: LostSession,
    gateway: ThisGateway,
    response: Response,
) -> SessionAnswer:
    """Make a session again that the server has lost, as its viewers saw it last; one that is there stays as it is.

    As `POST /api/sessions` with its `id`; a proxy before several servers finds by this path the one that is to have it.
    """
    finite(lost.snapshot)
    before = session_id in gateway.sessions
    scene = lost.scene.model_dump(mode="json")
    session = await gateway.sessions.reopen(session_id, scene, lost.snapshot, client_of(http.scope))
    if not before:
        response.status_code = 201
    _name(http, response, session)
    return _answer(http, session, session_id)


def _name(http: Request, response: Response, session: SessionRecord) -> None:
    """Say in the head where the session is, for proxies that learn by it which server has it."""
    response.headers["Location"] = reference(http.url.path, f"/api/sessions/{session.id}")
    response.headers["Culet-Watch"] = session.topic.hex()


@router.get("/api/sessions/{session_id}", responses=answers(404, 429, 503))
async def get_session(http: Request, session_id: str, gateway: ThisGateway) -> SessionAnswer:
    """A session as it is now."""
    await gateway.sessions.settle(session_id)
    session = gateway.sessions.get(session_id)
    await gateway.sessions.describe(session)
    return _answer(http, session, session_id)


@router.get("/api/sessions/{session_id}/scene", responses=answers(404, 422, 429, 503))
async def get_scene(
    session_id: str, gateway: ThisGateway, step: Annotated[StepNumber | None, Query()] = None
) -> dict[str, Any]:
    """The scene that a session shows, or showed at `step`: with the camera as it was, and every stone where it was.

    A session that is made of this scene shows the same picture. The scene of the session itself, `GET
    /api/sessions/{id}`, has the stones where they start.
    """
    return await gateway.sessions.scene_shown(gateway.sessions.get(session_id), step)


@router.patch("/api/sessions/{session_id}", responses=answers(403, 404, 413, 422, 429, 503))
async def patch_session(
    http: Request,
    session_id: str,
    patch: Annotated[dict[str, Any], Body(examples=[{"floor": {"kind": "matte"}}])],
    gateway: ThisGateway,
) -> SessionAnswer:
    """Change parts of a session's scene by a JSON merge patch (RFC 7396).

    Two things are not as there. An object of another `kind`, such as `{"environment": {"kind": "light"}}`, replaces the
    one before instead of being merged into it. And `stones` may be an object that reaches single stones by their ids:
    `{"stones": {"ruby": {"material": "sapphire"}}}` changes one, null removes it, and an id that there is not adds a
    stone, if it has a `cut` or a `mesh`. A list takes the place of all stones.
    """
    finite(patch)
    session = gateway.sessions.steered(session_id)
    async with session.room:
        await gateway.sessions.apply(session, PatchScene(patch=patch))
    await gateway.sessions.describe(session)
    return _answer(http, session, session_id)


@router.post("/api/sessions/{session_id}/events", responses=answers(403, 404, 413, 422, 429, 503))
async def post_event(
    http: Request,
    session_id: str,
    event: Annotated[SessionEvent, Body(discriminator="type", examples=[{"type": "toggle_fall"}])],
    gateway: ThisGateway,
) -> SessionAnswer:
    """Do to a session what a viewer can do by its stream: let the stone fall, push it, turn the camera, and so on."""
    check_numbers(event)
    session = gateway.sessions.steered(session_id)
    async with session.room:
        await gateway.sessions.apply(session, event)
    await gateway.sessions.describe(session)
    return _answer(http, session, session_id)


@router.delete("/api/sessions/{session_id}", status_code=204, responses=answers(403, 404, 429, 503))
async def delete_session(session_id: str, gateway: ThisGateway) -> None:
    """Forget a session; its viewers are told."""
    await gateway.sessions.close(gateway.sessions.steered(session_id))


FRAME = "/api/sessions/{session_id}/frame"


def _offer_frame(ending: str, file_format: Format) -> None:
    """Make GET .../frame.ENDING a route."""

    async def frame(
        http: Request, session_id: str, query: Annotated[FrameQuery, Query()], gateway: ThisGateway
    ) -> Response:
        return await _frame(http, session_id, query, gateway, ending, file_format)

    router.add_api_route(
        f"{FRAME}.{ending}",
        frame,
        methods=["GET"],
        name=f"frame_{ending}",
        summary=f"Frame as {ending.upper()}",
        description="What a session shows, or showed at `step`, rendered anew at full quality: with as many "
        "samples as are asked for, or to the `error` asked for; with neither as good as the live picture gets at rest.",
        response_class=response_class_of(file_format),
        responses={
            **picture_answers(MEDIA_TYPES[file_format], headers=("Content-Disposition",)),
            **answers(404, 422, 429, 503),
        },
    )


for _ending, _format in ENDINGS.items():
    _offer_frame(_ending, _format)


@router.websocket("/api/sessions/{session_id}/stream")
async def stream(websocket: WebSocket, session_id: str, gateway: ThisGateway) -> None:
    """Frames to a viewer, its control events back; by the session's watch id frames alone."""
    await streaming.stream(websocket, gateway, session_id)


@router.websocket("/api/stream")
async def watched_stream(websocket: WebSocket, gateway: ThisGateway) -> None:
    """The same of a session whose watch id is one of the subprotocols offered, and so in no log of a proxy."""
    offered: list[str] = websocket.scope["subprotocols"]
    named = [name.removeprefix(WATCH_SUBPROTOCOL) for name in offered if name.startswith(WATCH_SUBPROTOCOL)]
    await streaming.stream(websocket, gateway, named[0] if named else "", only_watches=True)


async def _frame(
    http: Request, session_id: str, query: FrameQuery, gateway: Gateway, ending: str, file_format: Format
) -> Response:
    session = gateway.sessions.get(session_id)
    session.watched = True
    client = client_of(http.scope)
    message = Render(
        session=session.id,
        step=query.step,
        width=query.width,
        height=query.height,
        samples=query.samples,
        error=query.error,
        format=file_format,
        legend=query.legend,
        client=client,
    )
    with gateway.stills.place(client):
        result, data = await while_waited_for(http, gateway.sessions.request(session, message, patient=True))
    kind = "attachment" if file_format in {"tga", "exr"} else "inline"  # which no browser shows
    headers = quality_headers(result)
    headers["Content-Disposition"] = f'{kind}; filename="culet-{result["step"]}.{ending}"'
    return PictureResponse(data, media_type=MEDIA_TYPES[file_format], headers=headers)


def _answer(http: Request, session: SessionRecord, name: str) -> SessionAnswer:
    """As whoever calls the session by that name, its id or its watch id, may know it."""
    return SessionAnswer(
        id=name,
        watch=session.topic.hex(),
        scene=session.scene,
        **session.condition.model_dump(),
        findings=session.findings,
        viewers=len(session.viewers),
        stream=reference(http.url.path, f"/api/sessions/{name}/stream"),
    )

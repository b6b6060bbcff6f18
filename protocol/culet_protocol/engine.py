"""What gateway (DEALER) and engine (ROUTER) say to each other.

A message has two or three parts: an 8-byte request number (little-endian, 0 for what nobody asked for), JSON, and bytes
where a request or reply carries some (an uploaded file, an encoded picture). Every request gets exactly one `Reply`,
but for one that is cancelled. An empty message, such as ZMQ_PROBE_ROUTER sends at every (re)connection, only makes the
peer known: it gets what is told unasked from then on, a Heartbeat first.
"""

from __future__ import annotations

import struct
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from culet_protocol.messages import Condition, Message, Question, Revision, SessionEvent, VideoCodec

REQUEST_NUMBER = struct.Struct("<Q")
Format = Literal["tga", "png", "jpeg", "webp", "exr"]
MeshType = Literal["obj", "off", "stl", "ply", "glb", "asc", "gem", "gcs"]
"""Meshes, and the designs of GemCad and Gem Cut Studio."""
SkyType = Literal["exr", "hdr", "png"]
Client = Annotated[str, Field(max_length=200)]
"""On whose behalf, in whatever words the gateway tells clients apart: clients take turns."""
SessionId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]


class OpenSession(Message):
    """Make a session, or, with `snapshot`, the one that an engine before this had."""

    type: Literal["open_session"] = "open_session"
    session: SessionId
    scene: dict[str, Any]
    snapshot: dict[str, Any] | None = None
    client: Client | None = None
    """Who opened it, as the gateway calls it: what changes it takes turns with what else is done for that client."""


class CloseSession(Message):
    """Forget a session."""

    type: Literal["close_session"] = "close_session"
    session: SessionId


class GetSession(Message):
    """Ask for a session's scene, pose and simulation snapshot."""

    type: Literal["get_session"] = "get_session"
    session: SessionId


class GetScene(Message):
    """The scene that a session showed at `step` (the latest if None), with camera and stones where they were."""

    type: Literal["get_scene"] = "get_scene"
    session: SessionId
    step: int | None = None


class ListSessions(Message):
    """Ask for all sessions, each as GetSession answers it: what a gateway needs that takes over from one that died."""

    type: Literal["list_sessions"] = "list_sessions"


class Control(Message):
    """Apply an event to a session."""

    type: Literal["control"] = "control"
    session: SessionId
    event: Annotated[SessionEvent, Field(discriminator="type")]


class Ask(Message):
    """Ask about a session's picture; the reply is the question's answer."""

    type: Literal["ask"] = "ask"
    session: SessionId
    question: Annotated[Question, Field(discriminator="type")]


class LesserDemand(BaseModel):
    """What viewers can take of lesser pictures of the same frames, which are made for who subscribes to them.

    The pixels of their largest window, and the bytes for which the slowest of their links has room, as in `Demand`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    width: Annotated[int, Field(ge=16, le=8192)]
    height: Annotated[int, Field(ge=16, le=8192)]
    bytes_per_frame: Annotated[int, Field(ge=1)] | None = None
    bytes_at_rest: Annotated[int, Field(ge=1)] | None = None


class Demand(Message):
    """What the session's viewers can take: frames per second (0: none), and the size in pixels.

    Frames are made for who subscribes to the session's watch id at the frames' socket; this says how many, how large.
    And how many bytes the link of the viewer who decides the size has for each, None meaning as many as one likes: of a
    moving frame if frames come as often as the session's balance asks for, and of a picture at rest.
    """

    type: Literal["demand"] = "demand"
    session: SessionId
    frames_per_second: Annotated[float, Field(ge=0, le=240)]
    width: Annotated[int, Field(ge=16, le=8192)]
    height: Annotated[int, Field(ge=16, le=8192)]
    bytes_per_frame: Annotated[int, Field(ge=1)] | None = None
    bytes_at_rest: Annotated[int, Field(ge=1)] | None = None
    lesser: LesserDemand | None = None


class HoldVideo(Message):
    """Encode no more video of a session's frames, since who watches has not taken all of it yet; or go on. A hold that
    is not renewed ends after some seconds."""

    type: Literal["hold_video"] = "hold_video"
    session: SessionId
    codec: VideoCodec
    held: bool
    lesser: bool = False
    """Of the video of lesser pictures."""


class Render(Message):
    """A still: of a scene, or of what a session showed at `step` (the latest if None).

    With an `error`, samples are taken until what is shown is estimated to be off by that (root mean square over pixels
    and colours, from 0 to 1), `samples` at most; else so many samples. With neither the scene says how many; of a
    session the still is as good as the live picture gets at rest.

    The reply's result has `samples`, the `error` that is estimated (None: not known), and whether it has `met` the one
    that was asked for (None: none was).

    `client` says on whose behalf, in whatever words the gateway tells clients apart: stills take turns by client.
    """

    type: Literal["render"] = "render"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    step: int | None = None
    stone: str | None = None
    """Of a session: the stone that is rendered as `design`, a merge patch, has it."""
    design: dict[str, Any] | None = None
    width: int | None = None
    height: int | None = None
    samples: int | None = None
    error: float | None = None
    format: Format = "tga"
    legend: bool = False
    """In a corner what an instrument's colours mean, and the tilt; not of radiance (exr)."""
    part: Annotated[float, Field(gt=0, le=1)] = 1
    """Of the work and the time that one still may take: so many of these together take no more."""
    client: Client = ""


class Grade(Message):
    """Grade a stone of a scene, or of what a session shows, the first if none is named; the reply's result is a
    `culet.grading.answer.GradeReport`. `error` is twice the standard error of ISO, in points."""

    type: Literal["grade"] = "grade"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    stone: str | None = None
    convention: Literal["culet", "gemray"] = "culet"
    head_degrees: Annotated[float, Field(ge=0, le=90)] | None = None
    coloured: bool = False
    tilt: bool = False
    error: Annotated[float, Field(ge=0.03, le=10)] = 0.1
    client: Client = ""


class DrawDiagram(Message):
    """The cutting diagram of a stone of a scene, or of what a session shows, the first if none is named, as SVG."""

    type: Literal["draw_diagram"] = "draw_diagram"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    stone: str | None = None
    client: Client = ""


class Measure(Message):
    """The proportions of a convex stone of a scene, or of what a session shows, the first if none is named; the reply's
    result is `culet.geometry.designs.measures.Proportions` in R."""

    type: Literal["measure"] = "measure"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    stone: str | None = None
    client: Client = ""


class ListTiers(Message):
    """The tiers of a convex stone of a scene, or of what a session shows, the first if none is named, with their angles
    and between which ends these may be; of the tier `reach` the ends at which meets are still kept. The reply's result
    is a `culet.geometry.cutting.tier_angles.Tiers`."""

    type: Literal["list_tiers"] = "list_tiers"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    stone: str | None = None
    reach: int | None = None
    client: Client = ""


class TracePath(Message):
    """Tell all that becomes of the light of one pixel, or of one ray, of a scene or of what a session shows; the
    reply's bytes are JSON of a `culet.paths.answer.Path`. `pixel` is x, y, width and height, `ray` an origin and a
    direction; one of them is given. `wavelengths`, nm, are followed in place of the scene's own."""

    type: Literal["trace_path"] = "trace_path"
    scene: dict[str, Any] | None = None
    session: SessionId | None = None
    pixel: tuple[int, int, int, int] | None = None
    ray: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    wavelengths: Annotated[tuple[Annotated[float, Field(ge=380, le=780)], ...], Field(max_length=16)] = ()
    client: Client = ""


class PutMesh(Message):
    """Parse the mesh or the design in the bytes and keep it under an id; the reply is a DescribedMesh."""

    type: Literal["put_mesh"] = "put_mesh"
    file_type: MeshType
    mesh: str


class PutSky(Message):
    """Read the panorama in the bytes and keep it under an id; the reply is a DescribedSky."""

    type: Literal["put_sky"] = "put_sky"
    file_type: SkyType
    sky: str


class Described(Message):
    """What the engine says of a file that it has read, a mesh or a sky."""

    findings: tuple[str, ...]
    """What was found in the file, repaired or left out, a sentence each, for whoever made the file."""


class DescribedMesh(Described):
    """A mesh in figures."""

    vertices: int
    triangles: int
    facets: int
    convex: bool
    volume: float
    """In cubes of the stone's circumradius."""


class DescribedSky(Described):
    """A sky in figures."""

    width: int
    """Pixels."""
    height: int
    """Pixels."""
    largest_radiance: float


class Cancel(Message):
    """Nobody waits any more for the request of that number: it need not be done, and gets no reply then."""

    type: Literal["cancel"] = "cancel"
    request: Annotated[int, Field(ge=0, lt=2**64)]


class Status(Message):
    """Ask for the engine's counters and device."""

    type: Literal["status"] = "status"


Request = (
    OpenSession
    | CloseSession
    | GetSession
    | GetScene
    | ListSessions
    | Control
    | Ask
    | Demand
    | HoldVideo
    | Render
    | Grade
    | DrawDiagram
    | Measure
    | ListTiers
    | TracePath
    | PutMesh
    | PutSky
    | Cancel
    | Status
)
EngineRequest = Annotated[Request, Field(discriminator="type")]


class Reply(Message):
    """The answer to a request: `result`, or a problem with the HTTP status that suits it."""

    type: Literal["reply"] = "reply"
    status: int = 200
    result: dict[str, Any] = Field(default_factory=dict)
    title: str | None = None
    detail: str | None = None
    field: str | None = None


class SessionChange(Condition):
    """Told unasked: on every edit, and when stones have fallen asleep or were woken; with what was told before, this is
    what a new engine needs to go on.

    `parts` are those of the scene that differ since the revision before, `since`; `moved` those of the snapshot. Who
    has another revision asks by GetSession.
    """

    type: Literal["session_change"] = "session_change"
    session: SessionId
    revision: Revision
    since: Revision
    parts: dict[str, Any]
    edited: bool
    moved: dict[str, Any]


class SessionMotion(Message):
    """Told unasked, 20 times a second while a session that is watched moves or is refined: the parts of its snapshot
    that differ from those told before."""

    type: Literal["session_motion"] = "session_motion"
    session: SessionId
    moved: dict[str, Any]


class SessionProblem(Message):
    """Told unasked: what this session shows could not be rendered, which is tried again after the next edit; or its
    stone could not be moved, and has stopped."""

    type: Literal["session_problem"] = "session_problem"
    session: SessionId
    title: str
    detail: str


class Heartbeat(Message):
    """Told unasked, once a second: the engine lives. `instance` differs for every process; `encodes` is the video that
    it makes of what moves, for who subscribes to its topic."""

    type: Literal["heartbeat"] = "heartbeat"
    instance: str
    encodes: tuple[VideoCodec, ...] = ()


EngineMessage = Annotated[
    Reply | SessionChange | SessionMotion | SessionProblem | Heartbeat, Field(discriminator="type")
]

engine_request: TypeAdapter[Request] = TypeAdapter(EngineRequest)
engine_message: TypeAdapter[Reply | SessionChange | SessionMotion | SessionProblem | Heartbeat] = TypeAdapter(
    EngineMessage
)

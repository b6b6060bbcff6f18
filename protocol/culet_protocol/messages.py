"""What a viewer and the gateway say to each other on the WebSocket, as JSON text.

Two unions, told apart by `type`: `ControlEvent` from the viewer, `Notice` to it. Clients send meaning, never keys.
Lengths are in R (the stone's circumradius), angles in radians, times in milliseconds of the sender's clock.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

Distance = Annotated[float, Field(ge=-1e6, le=1e6)]
Angle = Annotated[float, Field(ge=-1e3, le=1e3)]
PicturePoint = Annotated[float, Field(ge=-100, le=100)]
Blow = Annotated[float, Field(ge=-20, le=20)]
StoneId = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,31}$")]
"""As a scene names its stones."""
Target = Literal["camera", "light_1", "light_2"]
Pixels = Annotated[int, Field(ge=16, le=8192)]
Exactness = Annotated[float, Field(ge=0, le=1)]
Revision = Annotated[int, Field(ge=0, le=2**53 - 1)]
"""Counts the states of a session that viewers could be told."""
StoneMotion = Literal["paused", "falling", "asleep"]
VideoCodec = Literal["h264", "vp9"]
"""H.264 High 4:4:4 Predictive, and VP9 profile 1 with 4:4:4: colour at full resolution, as dispersion needs it."""
BALANCED: Exactness = 0.5
"""What a new session has."""
FASTEST_RATE, EXACTEST_RATE = 60.0, 15.0
"""Frames per second that a balance of 0 and of 1 asks for, if viewers can take them; half way between them, 30."""


class Message(BaseModel):
    """Immutable; unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Orbit(Message):
    """Turn the target about what the camera looks at: yaw about the vertical, pitch towards it.

    A positive yaw is counter-clockwise seen from above, a positive pitch goes up.
    """

    type: Literal["orbit"] = "orbit"
    target: Target = "camera"
    yaw: Angle
    pitch: Angle


class Translate(Message):
    """Move the target along the camera's right and up."""

    type: Literal["translate"] = "translate"
    target: Target = "camera"
    right: Distance
    up: Distance


class Dolly(Message):
    """Move the target along the camera's line of sight, away from the viewer if positive."""

    type: Literal["dolly"] = "dolly"
    target: Target = "camera"
    forward: Distance


class ResetCamera(Message):
    """Put the camera back to where the scene has it."""

    type: Literal["reset_camera"] = "reset_camera"


class LookAtStone(Message):
    """Move the camera, without turning it, to where it has a stone in the middle and sees all its height; or all
    stones, if none is named."""

    type: Literal["look_at_stone"] = "look_at_stone"
    stone: StoneId | None = None


class ToggleFall(Message):
    """Start or pause the free fall of a stone; of all, if none is named."""

    type: Literal["toggle_fall"] = "toggle_fall"
    stone: StoneId | None = None


class ResetStone(Message):
    """Put a stone back to where the scene has it, and stop it; all, if none is named."""

    type: Literal["reset_stone"] = "reset_stone"
    stone: StoneId | None = None


class Push(Message):
    """Strike the stone that the picture shows at a point, and let time go on; past all stones it does nothing.

    x to the right and y up, from the picture's centre, in halves of its height. The blow is along the camera's right
    and up, and so strong that it changes the velocity of the stone's centre by that, R/s.
    """

    type: Literal["push"] = "push"
    x: PicturePoint
    y: PicturePoint
    right: Blow
    up: Blow


class MoveStone(Message):
    """Move a stone by hand, along the camera's right, up and line of sight, as far as there is room: floor, walls and
    other stones turn it aside. It rests where it is put, held if time goes on for others, and starts from there."""

    type: Literal["move_stone"] = "move_stone"
    stone: StoneId
    right: Distance = 0.0
    up: Distance = 0.0
    forward: Distance = 0.0


class DragStone(Message):
    """As MoveStone, by so much of the picture: in halves of its height, where the stone is."""

    type: Literal["drag_stone"] = "drag_stone"
    stone: StoneId
    right: PicturePoint
    up: PicturePoint


class TurnStone(Message):
    """Turn a stone by hand about its centre, as MoveStone moves one: about the camera's `up`, the picture's right, and
    the line of sight.

    A positive yaw is counter-clockwise seen from above, a positive pitch takes the side towards the viewer up, a
    positive roll is counter-clockwise as seen in the picture.
    """

    type: Literal["turn_stone"] = "turn_stone"
    stone: StoneId
    yaw: Angle = 0.0
    pitch: Angle = 0.0
    roll: Angle = 0.0


class ToggleMirror(Message):
    """Switch floor and walls between matte and mirror."""

    type: Literal["toggle_mirror"] = "toggle_mirror"


class ToggleEnvironment(Message):
    """Switch between a light sky and the scene's own, or a dark one if that is light itself."""

    type: Literal["toggle_environment"] = "toggle_environment"


class ToggleWalls(Message):
    """Show or hide the walls, of the floor's kind."""

    type: Literal["toggle_walls"] = "toggle_walls"


class PatchScene(Message):
    """Change parts of the scene: a JSON merge patch (RFC 7396), but an object of another `kind` is replaced, and
    `stones` may be an object: by its id it reaches a stone, adds one that has a `cut` or a `mesh`, or, by null, removes
    one."""

    type: Literal["patch_scene"] = "patch_scene"
    patch: dict[str, Any]


class SetScene(Message):
    """Replace the whole scene; camera and stones go to where it has them."""

    type: Literal["set_scene"] = "set_scene"
    scene: dict[str, Any]


class Undo(Message):
    """Take the last edit of the scene back, whoever made it; edits of the same fields within a second of each other are
    one. Moves of the camera are no edits, nor are falls and pushes of the stones."""

    type: Literal["undo"] = "undo"


class Redo(Message):
    """Make the edit again that was taken back last, unless there was another edit since."""

    type: Literal["redo"] = "redo"


class Balance(Message):
    """How fast or exact frames are to be while things move; a picture at rest is always refined to the end.

    `exactness` goes from 0, many frames, to 1, few, of the quality that this rate leaves time for. `pinned`, it chooses
    the quality itself instead, 1 being all that the scene asks for, and frames come as fast as they then can.
    """

    type: Literal["balance"] = "balance"
    exactness: Exactness
    pinned: bool


def balance_rate(exactness: float) -> float:
    """Frames per second that a balance asks for while things move."""
    rate: float = FASTEST_RATE * (EXACTEST_RATE / FASTEST_RATE) ** exactness
    return rate


class Pick(Message):
    """Asks which stone the picture shows at a point (x to the right and y up, from its centre, in halves of its
    height); the answer, a `picked`, has the same number."""

    type: Literal["pick"] = "pick"
    number: Annotated[int, Field(ge=0, le=0xFFFFFFFF)]
    x: PicturePoint
    y: PicturePoint


class Outline(Message):
    """Asks where the picture of a step, of a frame's header, shows a stone; the answer is an `outlined`."""

    type: Literal["outline"] = "outline"
    stone: StoneId
    step: Annotated[int, Field(ge=0, le=2**53)]


class Reach(Message):
    """Asks which step is the first that shows what this viewer has sent before; the answer, a `reached`, has the same
    number. A stone that was let go or struck is seen to move with later steps alone."""

    type: Literal["reach"] = "reach"
    number: Annotated[int, Field(ge=0, le=0xFFFFFFFF)]


class Resize(Message):
    """The size that this viewer would like, in device pixels."""

    type: Literal["resize"] = "resize"
    width: Pixels
    height: Pixels


class Visibility(Message):
    """Whether this viewer can be seen; a hidden one gets no frames."""

    type: Literal["visibility"] = "visibility"
    visible: bool


class Ack(Message):
    """The frame was shown: room for another."""

    type: Literal["ack"] = "ack"
    sequence: Annotated[int, Field(ge=0, le=0xFFFFFFFF)]


class Decoders(Message):
    """Video that this viewer decodes, the best first; none: each frame is a picture of its own. Said again, it asks for
    a key frame, as after a failure of the decoder."""

    type: Literal["decoders"] = "decoders"
    codecs: Annotated[tuple[VideoCodec, ...], Field(max_length=8)]


class Ping(Message):
    """Asks for a Pong with the same time, to measure the way there and back."""

    type: Literal["ping"] = "ping"
    time: float


SessionEvent = (
    Orbit | Translate | Dolly | ResetCamera | LookAtStone | ToggleFall | ResetStone | Push | MoveStone | DragStone
    | TurnStone | ToggleMirror | ToggleEnvironment | ToggleWalls | PatchScene | SetScene | Undo | Redo | Balance
)  # fmt: skip
"""What changes a session, and so travels on to the engine."""

Question = Pick | Outline | Reach
"""What one viewer asks about the session's picture: the engine's answer is for that viewer alone."""

ViewerEvent = Resize | Visibility | Ack | Decoders | Ping
"""What concerns one viewer only, and ends at the gateway."""

ControlEvent = Annotated[SessionEvent | Question | ViewerEvent, Field(discriminator="type")]


class Hello(Message):
    """The first notice on a stream."""

    type: Literal["hello"] = "hello"
    protocol: int
    session: str
    watch: str
    """The watch id, which frames carry."""
    viewer: int
    steers: bool = True
    """Whether what this viewer says may change the session. If not, `session` is the watch id too."""
    encodes: tuple[VideoCodec, ...] = ()
    """Video that the server makes of what moves, for viewers that decode it (`Decoders`)."""


class Fall(Message):
    """Whether time goes on for a session's stones, whether all of them sleep for good, the session's balance, and
    whether there are edits to undo and to make again."""

    falling: bool
    asleep: bool = False
    exactness: Exactness = BALANCED
    pinned: bool = False
    can_undo: bool = False
    can_redo: bool = False


class Condition(Fall):
    """What a session is like besides its scene; `motions` are what each of its stones does, by its id."""

    motions: dict[str, StoneMotion] = Field(default_factory=dict)


class State(Condition):
    """The session's scene as it is now (with the live camera), whether time goes on for its stones (`falling`), whether
    all of them sleep for good (`asleep`), what each does by its id (`motions`: "paused", "falling" or "asleep"), the
    session's balance, and whether an Undo and a Redo have something to do: to a viewer that joins, and whenever it
    could not follow by a Change."""

    type: Literal["state"] = "state"
    revision: Revision
    scene: dict[str, Any]


class Change(Fall):
    """What is another since the revision that the viewer was told last: on every edit, and when stones fall asleep.

    `parts` are those of the scene, as `culet_protocol.parts` says; `motions` are those of all stones if one of them is
    another, and else null; the rest is as in State.
    """

    type: Literal["change"] = "change"
    revision: Revision
    since: Revision
    parts: dict[str, Any]
    motions: dict[str, StoneMotion] | None = None


class Snapshot(Message):
    """What a server would need, besides the last scene, to make the session again if it were lost: told to a viewer
    that joins, and once a second at most while it changes. Only the server knows what is in it."""

    type: Literal["snapshot"] = "snapshot"
    snapshot: dict[str, Any]


class Viewers(Message):
    """How many watch this session."""

    type: Literal["viewers"] = "viewers"
    count: int


class Problem(Message):
    """Something was refused or went wrong; the session lives on."""

    type: Literal["problem"] = "problem"
    code: str
    message: str
    field: str | None = None
    number: int | None = None
    """Of the viewer's message that was refused, if it was that: 1 is the first of the stream."""


class Engine(Message):
    """The render process is gone (`down`), or is back with the same scene (`up`)."""

    type: Literal["engine"] = "engine"
    status: Literal["down", "up"]


class Leaving(Message):
    """The server is about to be stopped. This session goes on until nobody watches any more, or the time is up."""

    type: Literal["leaving"] = "leaving"
    seconds: float


class Pong(Message):
    """The answer to a Ping."""

    type: Literal["pong"] = "pong"
    time: float


class Picked(Message):
    """The answer to a Pick: the id of the stone that is there, or null."""

    type: Literal["picked"] = "picked"
    number: int
    stone: str | None


class Outlined(Message):
    """The answer to an Outline: x and y of each corner of the stone's outline in turn, as a Pick has them.

    Without corners there is no such stone, or it is not all in front of the camera. A stone that is not convex has the
    outline of its hull.
    """

    type: Literal["outlined"] = "outlined"
    stone: str
    step: int
    points: tuple[float, ...]


class Reached(Message):
    """The answer to a Reach: the step that a frame's header has from then on, or a later one."""

    type: Literal["reached"] = "reached"
    number: int
    step: int


Answer = Picked | Outlined | Reached
"""What a Question is answered by."""

AnyNotice = (
    Hello | State | Change | Snapshot | Viewers | Problem | Engine | Leaving | Pong | Picked | Outlined | Reached
)
Notice = Annotated[AnyNotice, Field(discriminator="type")]

control_event: TypeAdapter[SessionEvent | Question | ViewerEvent] = TypeAdapter(ControlEvent)
session_event: TypeAdapter[SessionEvent] = TypeAdapter(Annotated[SessionEvent, Field(discriminator="type")])
answer: TypeAdapter[Answer] = TypeAdapter(Annotated[Answer, Field(discriminator="type")])
notice: TypeAdapter[AnyNotice] = TypeAdapter(Notice)

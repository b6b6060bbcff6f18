"""GET /api/turntable.webp and .zip: a preset from all around, as an animation or as pictures."""

from __future__ import annotations

import asyncio
import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple

from fastapi import APIRouter, Query, Request, Response
from PIL import Image
from pydantic import Field, ValidationInfo, field_validator

from culet.gateway.answers.departure import while_waited_for
from culet.gateway.answers.entity_tag import entity_tag, names
from culet.gateway.answers.picture_response import PictureResponse, picture_answers
from culet.gateway.answers.problems import answers
from culet.gateway.answers.quality import MISSED, TARGET, quality_headers
from culet.gateway.identity.client_address import client_of
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.routes.stills import FRESHNESS, Height, StillQuery, Width
from culet.gateway.state import Gateway
from culet.scene import Scene
from culet.scene.turntable import around
from culet_protocol.engine import Render

router = APIRouter(tags=["pictures"])

MOST_FRAMES = 360
MOST_PIXELS = 2**24
"""Of all frames together. While one is made, the gateway holds its frames as PNG, some 1.5 bytes a pixel, and
in the end as 4 bytes a pixel."""
DEFAULT_ERROR = 0.01
"""As the eye sees moving pictures, coarser than what a still is refined to."""
WEBP_QUALITY = 90
"""Without loss the file would be five times as large."""


class TurntableQuery(StillQuery):
    """A preset, the few things of it that are often changed, and how it is turned."""

    frames: Annotated[
        int,
        Field(
            ge=2,
            le=MOST_FRAMES,
            validate_default=True,  # so many may be too many of the size asked for
            description="In one turn; frames x width x height is at most 16.8 million.",
        ),
    ] = 36
    seconds: Annotated[float, Field(ge=0.1, le=600, description="That a turn takes, in the animation.")] = 6.0
    width: Width = 480
    height: Height = 360

    @field_validator("frames")
    @classmethod
    def _within_limits(cls, frames: int, given: ValidationInfo) -> int:
        """Width and height are checked before."""
        width, height = given.data.get("width", 1), given.data.get("height", 1)
        if frames * width * height > MOST_PIXELS:
            raise ValueError(
                f"expected at most {MOST_PIXELS} pixels in all frames together, got {frames} of {width} x {height}"
            )
        return frames


class TurntableFormat(NamedTuple):
    """What a turntable is put into."""

    media_type: str
    packed: Callable[[Sequence[bytes | memoryview], float], bytes]
    """Of frames as PNG, and the seconds that they take."""


def _animated(frames: Sequence[bytes | memoryview], seconds: float) -> bytes:
    """One WebP that goes on and on. A frame lasts a whole number of milliseconds, so some last one more."""
    ends = [round(1000 * seconds * (number + 1) / len(frames)) for number in range(len(frames))]
    durations = [max(1, end - before) for before, end in zip([0, *ends], ends, strict=False)]
    first, *others = (Image.open(io.BytesIO(frame)) for frame in frames)
    file = io.BytesIO()
    first.save(file, "WEBP", save_all=True, append_images=others, duration=durations, loop=0, quality=WEBP_QUALITY)
    return file.getvalue()


def _zipped(frames: Sequence[bytes | memoryview], _seconds: float) -> bytes:
    """The frames as 000.png, 001.png and so on."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:  # PNG is compressed
        for number, frame in enumerate(frames):
            entry = zipfile.ZipInfo(f"{number:03}.png")  # of 1980: the same turntable is the same file
            archive.writestr(entry, bytes(frame))
    return file.getvalue()


KINDS: Mapping[str, TurntableFormat] = MappingProxyType(
    {"webp": TurntableFormat("image/webp", _animated), "zip": TurntableFormat("application/zip", _zipped)}
)
"""By the ending of the address."""


def _offer(ending: str, kind: TurntableFormat) -> None:
    """Make GET /api/turntable.ENDING a route."""

    async def turntable(http: Request, query: Annotated[TurntableQuery, Query()], gateway: ThisGateway) -> Response:
        scene = query.scene()
        asked = f"turntable {ending} {query.model_dump_json()}"
        headers = {"ETag": (tag := entity_tag(scene, asked)), "Cache-Control": FRESHNESS}
        if names(http.headers.get("If-None-Match"), tag):
            return Response(status_code=304, headers=headers)
        client = client_of(http.scope)
        with gateway.stills.place(client), ExitStack() as place:
            place.enter_context(gateway.turntables.place(client))
            data, quality = await while_waited_for(http, _made(gateway, scene, query, kind, client, place))
        answer = PictureResponse(data, media_type=kind.media_type, headers=quality)
        if answer.headers.get(TARGET) != MISSED:  # as of a still
            answer.headers.update(headers)
        return answer

    router.add_api_route(
        f"/api/turntable.{ending}",
        turntable,
        methods=["GET"],
        name=f"turntable_{ending}",
        summary=f"Turntable as {ending.upper()}",
        description="A preset from all around, "
        + ("as an animated WebP" if ending == "webp" else "as a ZIP of PNGs, 000.png and so on")
        + f". Without `samples` and `error`, the error is {DEFAULT_ERROR}. All frames together may take as long as one "
        "still. The headers say what the least of the frames has reached.",
        response_class=type(f"{ending.capitalize()}TurntableResponse", (Response,), {"media_type": kind.media_type}),
        responses={
            **picture_answers(kind.media_type, headers=("ETag", "Cache-Control", "Vary")),
            304: {"description": "The turntable is as it was."},
            **answers(401, 404, 422, 429, 503),
        },
    )


for _ending, _kind in KINDS.items():
    _offer(_ending, _kind)


async def _made(
    gateway: Gateway, scene: Scene, query: TurntableQuery, kind: TurntableFormat, client: str, place: ExitStack
) -> tuple[bytes, dict[str, str]]:
    """Frame by frame, each a still like any other, so that those of others take their turns in between.

    The place is held as long as the frames are: a thread that packs them cannot be given up.
    """
    error = DEFAULT_ERROR if query.samples is None and query.error is None else query.error
    frames: list[bytes | memoryview] = []
    reached: list[Mapping[str, Any]] = []
    for view in around(scene, query.frames):
        message = Render(
            scene=view.model_dump(mode="json"), width=query.width, height=query.height, samples=query.samples,
            error=error, format="png", client=client, part=1 / query.frames,
        )  # fmt: skip
        result, data = await gateway.uploads.request(message, patient=True)
        frames.append(bytes(data))
        reached.append(result)
    packing = asyncio.create_task(asyncio.to_thread(kind.packed, frames, query.seconds))
    held = place.pop_all()
    packing.add_done_callback(lambda _: held.close())
    return await asyncio.shield(packing), quality_headers(_least(reached))


def _least(reached: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What all frames have reached at least."""
    errors, met = [each["error"] for each in reached], [each["met"] for each in reached]
    return {
        "samples": min(each["samples"] for each in reached),
        "error": None if None in errors else max(errors),
        "met": None if None in met else all(met),
    }

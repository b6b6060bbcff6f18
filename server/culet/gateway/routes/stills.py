"""GET /api/render.png and its like, and POST /api/render: one picture for one answer."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import AfterValidator, BeforeValidator, Field

from culet.gateway.answers.departure import while_waited_for
from culet.gateway.answers.entity_tag import entity_tag, names
from culet.gateway.answers.picture_response import PictureResponse, picture_answers
from culet.gateway.answers.problems import answers
from culet.gateway.answers.quality import MISSED, TARGET, quality_headers
from culet.gateway.identity.client_address import client_of
from culet.gateway.routes.parts import ThisGateway
from culet.scene import Scene, preset
from culet.scene.fields import Model
from culet.scene.film import MOST_SAMPLES, STILL_ERROR, STILL_LEAST, STILL_SAMPLES, is_background
from culet.scene.patch import patched
from culet.scene.sky_seen import under
from culet.scene.stone import NamedMaterial
from culet_protocol.engine import Format, Render
from culet_protocol.sizes import STILL_SIZE

router = APIRouter(tags=["pictures"])

MEDIA_TYPES: dict[Format, str] = {
    "tga": "image/x-tga",
    "png": "image/png",
    "jpeg": "image/jpeg",
    "webp": "image/webp",
    "exr": "image/x-exr",
}
ENDINGS: dict[str, Format] = {"png": "png", "jpg": "jpeg", "webp": "webp", "tga": "tga", "exr": "exr"}
"""Of the addresses that answer with a picture of that format."""
DEFAULT_WIDTH, DEFAULT_HEIGHT = STILL_SIZE
FRESHNESS = "max-age=3600"
"""Of a preset's picture: for an hour a browser does not even ask whether the server has another one by now."""

Width = Annotated[int, Field(ge=1, le=8192, description="Pixels; width x height is at most 33.5 million.")]
Height = Annotated[int, Field(ge=1, le=8192, description="Pixels.")]
Samples = Annotated[
    int,
    Field(
        ge=1,
        le=MOST_SAMPLES,
        description="Per pixel, with an `error` at most. Without either a still is taken to an error of "
        f"{STILL_ERROR}, with {STILL_LEAST} to {STILL_SAMPLES} samples.",
    ),
]
Error = Annotated[
    float,
    Field(
        gt=0,
        le=1,
        description="Take samples until what is shown, from 0 to 1, is estimated to be off by this: root mean square "
        "over pixels and colours. From 0.004 on no difference is seen. The answer's headers say what was reached.",
    ),
]
Legend = Annotated[
    bool,
    Field(
        description="In the lower left corner what the colours of ASET or Ideal-Scope mean, and how far the camera is "
        "tilted, in the page's words: for scenes with such a sky or parallel rays, in formats for screens."
    ),
]
SurfaceKind = Literal["none", "matte", "mirror"]


def _with_hash(value: str) -> str:
    """A colour as a scene has it: in an address # begins something else."""
    return f"#{value}" if re.fullmatch("[0-9a-fA-F]{6}", value) else value


class StillQuery(Model):
    """A preset, and the few things of it that are often changed; for everything else there is POST /api/render."""

    preset: Annotated[str, Field(description="A name from /api/presets.")] = "default"
    width: Width = DEFAULT_WIDTH
    height: Height = DEFAULT_HEIGHT
    samples: Samples | None = None
    error: Error | None = None
    legend: Legend = False
    material: NamedMaterial | None = None
    floor: SurfaceKind | None = None
    walls: SurfaceKind | None = None
    environment: Literal["dark", "light", "studio"] | None = None
    background: (
        Annotated[
            str,
            BeforeValidator(_with_hash),
            AfterValidator(is_background),
            Field(
                json_schema_extra={"pattern": "^(backdrop|transparent|#?[0-9a-fA-F]{6})$"},
                description="Behind everything: `transparent` for nothing, with alpha (white in .jpg), or a colour "
                "such as `f4f1ea`; both take twice the work. Not given: as the preset has it.",
            ),
        ]
        | None
    ) = None

    def scene(self) -> Scene:
        """The preset's scene with the changes."""
        data: dict[str, Any] = preset(self.preset).model_dump(mode="json")
        if self.material is not None:
            for stone in data["stones"]:
                stone["material"] = self.material
        if self.background is not None:
            data["film"]["background"] = self.background
        if self.environment is not None:
            data["environment"] = {"kind": self.environment}
            if self.environment != "studio":
                scene = Scene.read(data)
                data = under(scene, scene.environment).model_dump(mode="json")
        for name, kind in (("floor", self.floor), ("walls", self.walls)):
            if kind is not None:
                data = patched(data, {name: {"kind": kind}})
        return Scene.read(data)


class StillRequest(Model):
    """A whole scene, rendered as it stands."""

    scene: Scene = Scene()
    width: Width = DEFAULT_WIDTH
    height: Height = DEFAULT_HEIGHT
    samples: Samples | None = None
    error: Error | None = None
    legend: Legend = False
    format: Annotated[Format, Field(description="EXR is linear radiance; the others are tone-mapped.")] = "tga"

    model_config = Model.model_config | {
        "json_schema_extra": {
            "examples": [
                {"scene": {"floor": {"kind": "matte"}}, "width": 320, "height": 180, "format": "png"},
            ]
        }
    }


def response_class_of(file_format: Format) -> type[Response]:
    """For OpenAPI: a response that holds a picture of that format."""
    return type(f"{file_format.capitalize()}Response", (Response,), {"media_type": MEDIA_TYPES[file_format]})


def _offer(ending: str, file_format: Format) -> None:
    """Make GET /api/render.ENDING a route."""

    async def render_preset(http: Request, query: Annotated[StillQuery, Query()], gateway: ThisGateway) -> Response:
        scene = query.scene()
        asked = f"{query.width}x{query.height} {file_format} {query.samples} {query.error} {query.legend}"
        headers = {"ETag": (tag := entity_tag(scene, asked)), "Cache-Control": FRESHNESS}
        if names(http.headers.get("If-None-Match"), tag):
            return Response(status_code=304, headers=headers)
        message = Render(
            scene=scene.model_dump(mode="json"), width=query.width, height=query.height, samples=query.samples,
            error=query.error, format=file_format, legend=query.legend, client=client_of(http.scope),
        )  # fmt: skip
        picture = await _picture(http, gateway, message)
        if picture.headers.get(TARGET) != MISSED:  # for want of time, which there may be more of next time
            picture.headers.update(headers)
        return picture

    router.add_api_route(
        f"/api/render.{ending}",
        render_preset,
        methods=["GET"],
        name=f"render_{ending}",
        summary=f"Render Preset as {ending.upper()}",
        description="A preset, rendered"
        + (" as linear radiance" if file_format == "exr" else "")
        + ". `If-None-Match` with the `ETag` of an earlier answer asks whether the picture would be another.",
        response_class=response_class_of(file_format),
        responses={
            **picture_answers(MEDIA_TYPES[file_format], headers=("ETag", "Cache-Control", "Vary")),
            304: {"description": "The picture is as it was."},
            **answers(401, 404, 422, 429, 503),
        },
    )


for _ending, _format in ENDINGS.items():
    _offer(_ending, _format)


@router.post(
    "/api/render",
    response_class=Response,
    responses={**picture_answers(*MEDIA_TYPES.values()), **answers(401, 413, 422, 429, 503)},
)
async def render(http: Request, request: StillRequest, gateway: ThisGateway) -> Response:
    """Render a scene in the format asked for."""
    message = Render(
        scene=request.scene.model_dump(mode="json"), width=request.width, height=request.height,
        samples=request.samples, error=request.error, format=request.format, legend=request.legend,
        client=client_of(http.scope),
    )  # fmt: skip
    return await _picture(http, gateway, message)


async def _picture(http: Request, gateway: ThisGateway, message: Render) -> Response:
    with gateway.stills.place(message.client):
        result, data = await while_waited_for(http, gateway.uploads.request(message, patient=True))
    return PictureResponse(data, media_type=MEDIA_TYPES[message.format], headers=quality_headers(result))

"""GET /api/render.png and its like, and POST /api/render: one picture for one answer."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import Field

from culet.gateway.client_address import client_of
from culet.gateway.departure import while_waited_for
from culet.gateway.entity_tag import entity_tag, names
from culet.gateway.parts import ThisGateway
from culet.gateway.picture_response import PictureResponse, picture_answers
from culet.gateway.problems import answers
from culet.scene import Scene, preset
from culet.scene.fields import Model
from culet.scene.patch import patched
from culet.scene.sky_seen import under
from culet.scene.stone import MaterialName
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
Kind = Literal["none", "matte", "mirror"]


class StillQuery(Model):
    """A preset, and the few things of it that are often changed; for everything else there is POST /api/render."""

    preset: Annotated[str, Field(description="A name from /api/presets.")] = "default"
    width: Width = DEFAULT_WIDTH
    height: Height = DEFAULT_HEIGHT
    samples: Annotated[int, Field(ge=1, le=65536, description="Per pixel; the preset's if not given.")] | None = None
    material: MaterialName | None = None
    floor: Kind | None = None
    walls: Kind | None = None
    environment: Literal["dark", "light", "studio"] | None = None

    def scene(self) -> Scene:
        """The preset's scene with the changes."""
        data: dict[str, Any] = preset(self.preset).model_dump(mode="json")
        if self.samples is not None:
            data["sampling"]["samples_per_pixel"] = self.samples
        if self.material is not None:
            for stone in data["stones"]:
                stone["material"] = self.material
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
        tag = entity_tag(scene, query.width, query.height, file_format)
        headers = {"ETag": tag, "Cache-Control": FRESHNESS}
        if names(http.headers.get("If-None-Match"), tag):
            return Response(status_code=304, headers=headers)
        picture = await _picture(http, gateway, scene, query.width, query.height, file_format)
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
            **answers(404, 422, 429, 503),
        },
    )


for _ending, _format in ENDINGS.items():
    _offer(_ending, _format)


@router.post(
    "/api/render",
    response_class=Response,
    responses={**picture_answers(*MEDIA_TYPES.values()), **answers(413, 422, 429, 503)},
)
async def render(http: Request, request: StillRequest, gateway: ThisGateway) -> Response:
    """Render a scene in the format asked for."""
    return await _picture(http, gateway, request.scene, request.width, request.height, request.format)


async def _picture(
    http: Request, gateway: ThisGateway, scene: Scene, width: int, height: int, file_format: Format
) -> Response:
    client = client_of(http.scope)
    message = Render(scene=scene.model_dump(mode="json"), width=width, height=height, format=file_format, client=client)
    with gateway.stills.place(client):
        _, data = await while_waited_for(http, gateway.uploads.request(message, patient=True))
    return PictureResponse(data, media_type=MEDIA_TYPES[file_format])

"""One ray of a scene or of a session, told from the eye to all lights."""

from __future__ import annotations

from typing import Annotated, Self

from fastapi import APIRouter, Query, Request, Response
from pydantic import ConfigDict, Field, model_validator

from culet.gateway.answers.problems import answers
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.routes.stone_routes import answered
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.state import Gateway
from culet.paths.answer import MOST_WAVELENGTHS, WAVELENGTHS, Path
from culet.scene import Scene
from culet.scene.fields import Model, Vector
from culet_protocol.engine import TracePath

router = APIRouter(tags=["rays"])

PictureSide = Annotated[int, Field(ge=1, le=8192)]
Place = Annotated[int, Field(ge=0, lt=8192)]
Wavelength = Annotated[float, Field(ge=WAVELENGTHS[0], le=WAVELENGTHS[1])]
Wavelengths = Annotated[
    tuple[Wavelength, ...],
    Field(
        max_length=MOST_WAVELENGTHS,
        description="nm, followed in place of the scene's own; the value is then their mean.",
    ),
]


class PixelQuery(Model):
    """A pixel, from the picture's upper left corner, of a picture of that size."""

    x: Place
    y: Place
    width: PictureSide
    height: PictureSide


class RayFields(Model):
    """From a place of the world."""

    origin: Vector
    direction: Vector = Field(description="Of any length but 0.")


class PathOf(Model):
    """A pixel or a ray."""

    pixel: PixelQuery | None = Field(None, description="Of a picture; either this or a ray.")
    ray: RayFields | None = Field(None, description="As the eye would look; either this or a pixel.")
    wavelengths: Wavelengths = ()

    model_config = Model.model_config | ConfigDict(
        json_schema_extra={"examples": [{"pixel": {"x": 320, "y": 180, "width": 640, "height": 360}}]}
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.pixel is None) == (self.ray is None):
            raise ValueError("expected either a pixel or a ray, got both or neither")
        return self

    def message(self, **where: object) -> TracePath:
        """For the engine."""
        pixel, ray = self.pixel, self.ray
        asked = {
            "pixel": pixel and (pixel.x, pixel.y, pixel.width, pixel.height),
            "ray": ray and (ray.origin, ray.direction),
        }
        return TracePath.model_validate({**asked, "wavelengths": self.wavelengths, **where})


class PathRequest(PathOf):
    """Of a scene."""

    scene: Scene = Scene()

    model_config = Model.model_config | ConfigDict(
        json_schema_extra={"examples": [{"pixel": {"x": 320, "y": 180, "width": 640, "height": 360}}]}
    )


@router.post("/api/path", response_model=Path, responses=answers(401, 413, 422, 429, 503))
async def path(http: Request, request: PathRequest, gateway: ThisGateway) -> Response:
    """Tell all that becomes of the light of one pixel, or of one ray, of a scene: each facet and each end, and what it
    adds."""
    return await _told(http, gateway, request.message(scene=request.scene.model_dump(mode="json")))


@router.get("/api/sessions/{session_id}/path", response_model=Path, responses=answers(404, 422, 429, 503))
async def path_of_pixel(
    http: Request, session_id: str, query: Annotated[PixelQuery, Query()], gateway: ThisGateway
) -> Response:
    """The same of a pixel of what a session shows."""
    await gateway.sessions.settle(session_id)
    session = gateway.sessions.get(session_id)
    return await _told(http, gateway, PathOf(pixel=query).message(session=session.id), session)


@router.post("/api/sessions/{session_id}/path", response_model=Path, responses=answers(404, 413, 422, 429, 503))
async def path_of_session(http: Request, session_id: str, request: PathOf, gateway: ThisGateway) -> Response:
    """The same of a pixel, or a ray, through what a session shows."""
    await gateway.sessions.settle(session_id)
    session = gateway.sessions.get(session_id)
    return await _told(http, gateway, request.message(session=session.id), session)


async def _told(http: Request, gateway: Gateway, message: TracePath, session: SessionRecord | None = None) -> Response:
    _, told = await answered(http, gateway, message, session)
    return Response(bytes(told), media_type="application/json")  # as the engine wrote it: it may have a megabyte

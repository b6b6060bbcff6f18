"""POST /api/meshes and POST /api/skies: what scenes may then name by the id of the answer."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request

from culet.gateway.form import ENVELOPE_BYTES, read_form
from culet.gateway.parts import ThisGateway
from culet.gateway.problems import answers
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads import MESH, SKY, Kind
from culet.scene.fields import Model
from culet_protocol.engine import DescribedMesh, DescribedSky

router = APIRouter(tags=["uploads"])

MESHES_PATH, SKIES_PATH = "/api/meshes", "/api/skies"

_FORM: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": {"type": "string", "contentMediaType": "application/octet-stream"}},
                }
            }
        },
    }
}


def body_limits(settings: GatewaySettings) -> dict[str, int]:
    """The largest body of each path here, in bytes."""
    return dict.fromkeys((MESHES_PATH, SKIES_PATH), settings.max_upload_bytes + ENVELOPE_BYTES)


class MeshAnswer(Model):
    """An accepted mesh; `stones[0].mesh` of a scene takes the id."""

    id: str
    description: DescribedMesh


class SkyAnswer(Model):
    """An accepted sky; `environment.image` of a scene takes the id."""

    id: str
    description: DescribedSky


@router.post(MESHES_PATH, status_code=201, responses=answers(401, 413, 422, 429, 503), openapi_extra=_FORM)
async def upload_mesh(request: Request, gateway: ThisGateway) -> MeshAnswer:
    """Upload a mesh as the form field `file`, .obj, .off, .stl, .ply or .glb, or a cutter's design, .asc and .gem of
    GemCad or .gcs of Gem Cut Studio. The answer says what was found in it."""
    name, described = await _taken(MESH, request, gateway)
    return MeshAnswer(id=name, description=DescribedMesh.model_validate(described))


@router.post(SKIES_PATH, status_code=201, responses=answers(401, 413, 422, 429, 503), openapi_extra=_FORM)
async def upload_sky(request: Request, gateway: ThisGateway) -> SkyAnswer:
    """Upload an equirectangular picture of a sky as the form field `file`: .exr or .hdr (linear) or .png (sRGB, unless
    it says otherwise). The answer says what was found in it."""
    name, described = await _taken(SKY, request, gateway)
    return SkyAnswer(id=name, description=DescribedSky.model_validate(described))


async def _taken(kind: Kind, request: Request, gateway: ThisGateway) -> tuple[str, dict[str, Any]]:
    content_type = request.headers.get("content-type")
    file = await read_form(request.stream(), content_type, gateway.settings.max_upload_bytes)
    return await gateway.uploads.put(kind, file)

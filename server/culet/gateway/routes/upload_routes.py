"""POST /api/sessions/{id}/meshes and .../skies: what the session's scenes may then name by the id of the answer. And
POST /api/meshes and /api/skies, for scenes of any session of this server, and of stills."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request

from culet.gateway.admission.upload_paths import MESHES_PATH, SESSION_MESHES_PATH, SESSION_SKIES_PATH, SKIES_PATH
from culet.gateway.answers.problems import answers
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.settings import GatewaySettings
from culet.gateway.state import Gateway
from culet.gateway.uploads.form import ENVELOPE_BYTES, read_form
from culet.gateway.uploads.uploads import MESH, SKY, UploadKind
from culet.scene.fields import Model
from culet_protocol.engine import DescribedMesh, DescribedSky

router = APIRouter(tags=["uploads"])

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


def largest_form(settings: GatewaySettings) -> int:
    """Bytes of the largest body that these paths take."""
    return settings.max_upload_bytes + ENVELOPE_BYTES


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


@router.post(
    SESSION_MESHES_PATH, status_code=201, responses=answers(401, 403, 404, 413, 422, 429, 503), openapi_extra=_FORM
)
async def upload_mesh_of_session(session_id: str, request: Request, gateway: ThisGateway) -> MeshAnswer:
    """As `/api/meshes`, to the server that has the session: of several behind one proxy only that knows the mesh."""
    await _take_for(session_id, gateway)
    name, described = await _taken(MESH, request, gateway)
    return MeshAnswer(id=name, description=DescribedMesh.model_validate(described))


@router.post(
    SESSION_SKIES_PATH, status_code=201, responses=answers(401, 403, 404, 413, 422, 429, 503), openapi_extra=_FORM
)
async def upload_sky_of_session(session_id: str, request: Request, gateway: ThisGateway) -> SkyAnswer:
    """As `/api/skies`, to the server that has the session: of several behind one proxy only that knows the sky."""
    await _take_for(session_id, gateway)
    name, described = await _taken(SKY, request, gateway)
    return SkyAnswer(id=name, description=DescribedSky.model_validate(described))


async def _take_for(session_id: str, gateway: Gateway) -> None:
    """Raises as `Sessions.takes_files`, once it is known what sessions there are."""
    await gateway.sessions.settle(session_id)
    gateway.sessions.takes_files(session_id)


async def _taken(kind: UploadKind, request: Request, gateway: ThisGateway) -> tuple[str, dict[str, Any]]:
    content_type = request.headers.get("content-type")
    file = await read_form(request.stream(), content_type, gateway.settings.max_upload_bytes)
    return await gateway.uploads.put(kind, file)

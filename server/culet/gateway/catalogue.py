"""What there is to choose from: presets, materials, cuts; and uploads, which add to it."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request

from culet.gateway.form import read_limited, uploaded_file
from culet.gateway.parts import ThisGateway
from culet.gateway.problems import answers
from culet.optics.dispersion import RGB_NANOMETRES, channel_indices
from culet.scene import PRESETS, Scene
from culet.scene.model import BrilliantCut, Model

router = APIRouter(tags=["catalogue"])

MESHES_PATH = "/api/meshes"
MATERIALS = {
    "diamond": "Diamond as measured: F. Peter, Z. Phys. 15, 358 (1923).",
    "classic": "The report's indices, which exaggerate the fire.",
}
CUTS = {"brilliant": "A round brilliant by its proportions."}


class Preset(Model):
    """A named scene."""

    name: str
    summary: str
    scene: Scene


class Presets(Model):
    """All presets."""

    presets: tuple[Preset, ...]


class Material(Model):
    """A named material."""

    name: str
    summary: str
    indices: tuple[float, float, float]


class Materials(Model):
    """All named materials; `indices` are refractive indices at `nanometres`."""

    nanometres: tuple[float, float, float]
    materials: tuple[Material, ...]


class Cut(Model):
    """A named cut; `proportions` is the JSON schema of what it can be told."""

    name: str
    summary: str
    proportions: dict[str, Any]


class Cuts(Model):
    """All cuts."""

    cuts: tuple[Cut, ...]


class MeshAnswer(Model):
    """An accepted upload; `stones[0].mesh` in a scene takes the id."""

    id: str
    description: dict[str, Any]


@router.get("/api/presets")
async def presets() -> Presets:
    """Scenes to begin with."""
    return Presets(
        presets=tuple(Preset(name=name, summary=summary, scene=scene) for name, (summary, scene) in PRESETS.items())
    )


@router.get("/api/materials")
async def materials() -> Materials:
    """Materials that a stone can name."""
    return Materials(
        nanometres=RGB_NANOMETRES,
        materials=tuple(
            Material(name=name, summary=summary, indices=channel_indices(name)) for name, summary in MATERIALS.items()
        ),
    )


@router.get("/api/cuts")
async def cuts() -> Cuts:
    """Cuts that a stone can have, with their proportions, limits and defaults."""
    proportions = BrilliantCut.model_json_schema()["properties"]
    return Cuts(cuts=tuple(Cut(name=name, summary=summary, proportions=proportions) for name, summary in CUTS.items()))


@router.post(
    MESHES_PATH,
    status_code=201,
    responses=answers(413, 422, 429, 503),
    openapi_extra={
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
    },
)
async def upload_mesh(request: Request, gateway: ThisGateway) -> MeshAnswer:
    """Upload a mesh as the form field `file`: .obj, .off, .stl, .ply or .glb. The answer says what was found in it."""
    limit = gateway.settings.max_mesh_bytes
    body = await read_limited(request.stream(), limit)
    file = uploaded_file(body, request.headers.get("content-type"), limit)
    mesh, description = await gateway.meshes.put(gateway.link, file)
    return MeshAnswer(id=mesh, description=description)

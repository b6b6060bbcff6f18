"""What there is to choose from: presets, materials, cuts, skies."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from culet.optics.dispersion import RGB_NANOMETRES, channel_indices
from culet.scene import PRESETS, Scene
from culet.scene.model import BrilliantCut, Model

router = APIRouter(tags=["catalogue"])

MATERIALS = {
    "diamond": "Diamond as measured: F. Peter, Z. Phys. 15, 358 (1923).",
    "classic": "The report's indices, which exaggerate the fire.",
}
CUTS = {"brilliant": "A round brilliant by its proportions."}
SKIES = {
    "light-box": "A photographer's light box: bright above, softer at the sides, dark below.",
    "ring-lights": "Three thin bright rings, as around a lens: much fire.",
    "aset": "The Angular Spectrum Evaluation Tool's colours by elevation: green, red, blue.",
}
"""Made by the renderer, which the gateway does not load; a test compares the names."""


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


class Sky(Model):
    """A named panorama; `environment.image` of a scene takes the name."""

    name: str
    summary: str


class Skies(Model):
    """All named panoramas."""

    skies: tuple[Sky, ...]


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


@router.get("/api/skies")
async def skies() -> Skies:
    """Panoramas of the studio; POST adds others."""
    return Skies(skies=tuple(Sky(name=name, summary=summary) for name, summary in SKIES.items()))
